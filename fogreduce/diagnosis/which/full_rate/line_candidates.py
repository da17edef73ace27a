"""The best line of each gyro and of a motion: where it stands in spectra, and its evidence."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.evidence import log_mean_exp
from fogreduce.diagnosis.which.full_rate.line_evidence import leading, sizes_log
from fogreduce.diagnosis.which.full_rate.line_spectra import Spectra

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

_LOCKED = 0.3  # prior share of lines that start anew with each run


@dataclass(frozen=True)
class Candidate:
    """The best line of one gyro, or of a motion (-1): its place in the spectrum and its evidence."""

    gyro: int
    index: int
    log_b: float
    gain: float

    def score(self, n: int) -> float:
        """Ln posterior odds beside any other causes."""
        return self.log_b + priors.A_LINE - (np.log(n) if self.gyro >= 0 else 0.0)


def best_lines(
    spectra: Spectra, gyros: set[int] | None = None, before: dict[int, Candidate] | None = None
) -> dict[int, Candidate]:
    """The best line of each gyro and of a motion; `before`: those known of gyros that did not change."""
    out = dict(before or {})
    for i in range(spectra.n) if gyros is None else sorted(gyros):
        out.pop(i, None)
        power = np.sum(np.abs(spectra.lines[:, i]) ** 2, axis=0)
        leaders = leading(power, spectra.free[i])
        leaders = leaders[(power[leaders] > 0.0) & spectra.free[i, leaders]]
        if leaders.size:
            out[i] = _of_gyro(spectra, i, leaders)
    out.pop(-1, None)
    if spectra.n > 1 and spectra.awake.all():
        power = np.sum(
            np.abs(np.einsum("nd,rnl->rdl", spectra.basis(spectra.apart), spectra.lines)) ** 2, axis=(0, 1)
        )
        free = np.logical_and.reduce(spectra.free)
        leaders = leading(power, free)
        leaders = leaders[(power[leaders] > 0.0) & free[leaders]]
        if leaders.size:
            out[-1] = _of_motion(spectra, leaders)
    return out


def _of_gyro(spectra: Spectra, i: int, leaders: NDArray[np.intp]) -> Candidate:
    logs, tops = gyro_logs(spectra, i, leaders)
    k = int(np.argmax(logs))
    # neighbours of a line in a spectrum of split lines say the same again
    log_sum = float(log_mean_exp(logs) + np.log(len(logs))) - np.log(2.0)
    return Candidate(i, int(leaders[k]), log_sum - np.log(spectra.count(i)), float(tops[k]))


def gyro_logs(spectra: Spectra, i: int, at: NDArray[np.intp]) -> tuple[Array, Array]:
    """Ln evidence and gain of lines of a gyro, of a phase in each run or of one for all."""
    heard = np.flatnonzero(spectra.awake[:, i])
    return shown_log(spectra.lines[heard[:, None], i, at[None, :]].T, spectra.weights[heard])


def shown_log(z: Complex, weights: Array) -> tuple[Array, Array]:
    """The same from their amplitudes (lines, R) over their noise."""
    free, top = sizes_log(np.abs(z), weights)
    if len(weights) < 2:
        return free, top
    together = np.abs(z @ weights)[:, None] / np.sqrt(np.sum(weights**2))
    locked, _ = sizes_log(together)
    return np.logaddexp(free + np.log(1.0 - _LOCKED), locked + np.log(_LOCKED)), top


def _of_motion(spectra: Spectra, leaders: NDArray[np.intp]) -> Candidate:
    logs, tops = motion_logs(spectra, leaders, spectra.apart)
    k = int(np.argmax(logs))
    log_sum = float(log_mean_exp(logs) + np.log(len(logs))) - np.log(2.0)
    count = min(spectra.count(i) for i in range(spectra.n))
    return Candidate(-1, int(leaders[k]), log_sum - np.log(count), float(tops[k]))


def motion_logs(spectra: Spectra, at: NDArray[np.intp], apart: Array) -> tuple[Array, Array]:
    """Ln evidence and gain of motions along one direction, of one phase for all gyros in a run."""
    # over noise that is one for all runs: a strong line's skirt is another in each
    floors = spectra.floors[:, :, at]
    lines = spectra.lines[:, :, at] * np.sqrt(floors / np.mean(floors, axis=0))
    y = np.einsum("lnd,rnl->lrd", spectra.basis(apart, at), lines)
    weighed = y * spectra.weights[None, :, None]
    cov = np.real(np.einsum("lrd,lre->lde", weighed, weighed.conj()))
    direction = np.linalg.eigh(cov)[1][:, :, -1]
    return moved_log(spectra, np.abs(np.einsum("lrd,ld->lr", y, direction)))


def moved_log(spectra: Spectra, moduli: Array) -> tuple[Array, Array]:
    """Ln evidence and gain of motions from their amplitudes (lines, R) along the direction chosen."""
    mean, top = sizes_log(moduli, spectra.weights)
    gain2 = np.maximum(np.sum(moduli**2, axis=1) - 2.0 * len(spectra.facts), 1.0)
    # the direction was chosen: the share of all directions that would have done as well
    if spectra.facts[0].axes.shape[1] == 3 and spectra.n > 2:
        mean = mean + np.log(np.minimum(2.0 / gain2, 1.0))
    return mean, top
