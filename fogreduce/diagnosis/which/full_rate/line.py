"""A line: its numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.which.full_rate.line_candidates import Candidate, moved_log, shown_log
from fogreduce.diagnosis.which.full_rate.line_spectra import Spectra
from fogreduce.effects.gyro_names import gyro_name

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: How far the mean frequency is from that at a run's ends where a steady drift departs from a steady line by
#: as much as an effect may from its shape, in a spectrum's resolution: phases ``pi k t^2`` are that share
#: about their mean, ``pi k T^2 / (6 sqrt(5))`` root mean square.
_DRIFTS = 0.5 * priors.DEPARTURE * 6.0 * np.sqrt(5.0) / np.pi


@dataclass(frozen=True)
class Line:
    """A line found.

    Attributes
    ----------
    channels : tuple of str
        One gyro, or ``table``: a motion.
    runs : tuple of str
        Those of its sample rate; ``*`` where all are of one.
    hz, hz_std, deg_h, std : float
    axis : tuple of float or None
        Of a motion.
    log_b : float
        Ln evidence over that of noise alone, the look-elsewhere of all frequencies in it.
    gain : float
        Gain in ln likelihood.
    share : float
        Prior share of the effect's name.
    degrees : int
        Numbers that were free.
    taken : bool
        Whether the odds are for it, and it was taken out of the samples.
    catalogued : bool
        Whether the catalogue has its like: not two lines and their mixture.
    by_run : mapping
        Run id -> (amplitude [deg/h], its standard deviation).
    """

    channels: tuple[str, ...]
    runs: tuple[str, ...]
    hz: float
    hz_std: float
    deg_h: float
    std: float
    axis: tuple[float, ...] | None
    log_b: float
    gain: float
    share: float
    degrees: int
    taken: bool
    catalogued: bool = True
    by_run: dict[str, tuple[float, float]] = field(default_factory=dict)

    def of(self, run_ids: Sequence[str]) -> Line | None:
        """The line as some runs alone show it; None where they have it not."""
        here = [self.by_run[run] for run in run_ids if run in self.by_run]
        if not here:
            return None
        weights = np.array([std**-2.0 for _, std in here])
        squares = float(weights @ np.array([size**2 for size, _ in here])) / float(weights.sum())
        share = float(weights.sum()) / sum(std**-2.0 for _, std in self.by_run.values())
        std = float(weights.sum() ** -0.5)
        return replace(self, deg_h=float(np.sqrt(squares)), std=std, gain=self.gain * share)


def measured(spectra: Spectra, one: Candidate, hz: float, size: Complex) -> tuple[Line, float, float]:
    """Numbers of a line with amplitudes (R, gyros) [deg/h]; ln evidence and gain by these."""
    std, axis, share = spectra.error(one.index), None, 1.0 / spectra.n
    heard = np.ones(len(spectra.facts), bool) if one.gyro < 0 else spectra.awake[:, one.gyro]
    if one.gyro < 0:
        size, error, axis = _along(spectra, size, std)
        share = 1.0
        logs, tops = moved_log(spectra, np.abs(size / error)[None])
    else:
        size, error = size[heard, 0], std[heard, one.gyro]
        logs, tops = shown_log((size / error)[None], spectra.weights[heard])
    weight = error**-2.0
    squares = float(weight @ (np.abs(size) ** 2 - 2.0 * error**2)) / float(weight.sum())
    whole = float(weight.sum() ** -0.5)
    runs = [facts.run_id for facts, there in zip(spectra.facts, heard, strict=True) if there]
    line = Line(
        channels=("table",) if one.gyro < 0 else (gyro_name(one.gyro),),
        runs=("*",),
        hz=hz,
        hz_std=frequency_std(spectra.duration_s, one.gain),
        deg_h=float(np.sqrt(max(squares, 0.05 * whole**2))),
        std=whole,
        axis=axis,
        log_b=one.log_b,
        gain=one.gain,
        share=share,
        degrees=max(2 * len(runs), 2),
        taken=False,
        by_run={run: (float(abs(z)), float(s)) for run, z, s in zip(runs, size, error, strict=True)},
    )
    return line, float(logs[0]) - np.log(2.0 * spectra.count(max(one.gyro, 0))), float(tops[0])


def _along(spectra: Spectra, size: Complex, std: Array) -> tuple[Complex, Array, tuple[float, ...]]:
    """Amplitudes (R,) of a motion along its axis, their standard deviations, and the axis."""
    seen = spectra.facts[0].axes * spectra.facts[0].frame_signs  # (n, 3)
    noise = np.sqrt(np.mean(std**2, axis=0))
    rates = np.linalg.lstsq(seen / noise[:, None], (size / noise).T, rcond=None)[0]  # (3, R)
    _, vectors = np.linalg.eigh(np.real(rates @ rates.conj().T))
    axis = vectors[:, -1]
    axis = axis * np.sign(axis[np.argmax(np.abs(axis))])
    strength = (seen @ axis / std) @ spectra.apart  # (R, n)
    error = np.sum(strength**2, axis=1) ** -0.5
    along = np.sum(strength * ((size / std) @ spectra.apart), axis=1) * error**2
    given = [round(float(v), 6) for v in axis.tolist()] if len(axis) == 3 else [1.0, 0.0, 0.0]
    return along, error, tuple(given)


def frequency_std(duration_s: float, gain: float) -> float:
    """Of a line's frequency: Cramer and Rao's bound ``sqrt(12) / (2 pi S T)``, and what a drifting line
    adds.
    """
    bound = np.sqrt(12.0) / (2.0 * np.pi * np.sqrt(max(2.0 * gain, 1.0)))
    return float(np.hypot(bound, _DRIFTS) / duration_s)
