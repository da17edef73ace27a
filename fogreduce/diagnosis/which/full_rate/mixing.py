"""Lines that no effect of the catalogue makes: two that mix."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.which.full_rate.line_evidence import leading, sizes_log

Array = NDArray[np.float64]

_TONES = 14  # the strongest lines that are tried in pairs
_BEYOND = 3.0  # ln evidence that a second line and a mixture must bring beside the strongest line alone
_HARMONIC = 3.0  # lines of the spectrum within which one frequency is a multiple of another


@dataclass(frozen=True)
class Mixture:
    """Two lines with their sum, their difference or both.

    Attributes
    ----------
    log_b : float
        Ln evidence over that of noise alone, the look-elsewhere in it.
    gain : float
        Gain in ln likelihood.
    product : float
        Ln evidence of the sum and the difference, the two lines given.
    index : int
        The stronger line's place in the spectrum.
    hz : tuple of float
        Frequencies of the two, their sum and their difference.
    """

    log_b: float
    gain: float
    product: float
    index: int
    hz: tuple[float, ...]


def mixed(
    lines: Sequence[NDArray[np.complex128]], hz: Array, free: NDArray[np.bool_], count: float
) -> Mixture | None:
    """The best mixture, of phases that are the same in every run or others in each; None without one.

    Parameters
    ----------
    lines : (L,) arrays
        Amplitudes of one gyro in each run, of unit variance in each quadrature.
    hz : (L,) array
    free : (L,) array of bool
        Which lines may be looked at.
    count : float
        Lines that are independent.
    """
    power = np.sum(np.abs(lines) ** 2, axis=0)
    kinds: list[tuple[list[Array], Array]] = [([np.asarray(one) for one in lines], power)]
    if len(lines) > 1:
        together = np.abs(np.sum(lines, axis=0)) / np.sqrt(len(lines))
        kinds.append(([together], together))
    found = [_mixed(parts, strength, hz, free, count) for parts, strength in kinds]
    return max((one for one in found if one is not None), key=lambda one: one.log_b, default=None)


def _mixed(
    parts: Sequence[NDArray[Any]], strength: Array, hz: Array, free: NDArray[np.bool_], count: float
) -> Mixture | None:
    """The best mixture of lines whose phases are one in all `parts`, or in each another."""

    def moduli(index: NDArray[np.intp]) -> Array:
        return np.abs(np.stack([part[index] for part in parts], axis=-1))

    peaks: list[int] = []
    for k in leading(strength, free)[::-1].tolist():
        if strength[k] > 0.0 and all(abs(k - other) > 4 for other in peaks):
            peaks.append(k)
        if len(peaks) == _TONES:
            break
    offset = hz[0] / (hz[1] - hz[0])
    rank = np.array(
        [
            (a, b)
            for a in range(len(peaks))
            for b in range(a + 1, len(peaks))
            if not _harmonic(peaks[a] + offset, peaks[b] + offset)
        ]
    )
    if not rank.size:
        return None
    pairs = np.array(peaks)[rank]
    own, own_gain = sizes_log(moduli(np.array(peaks)))
    mixes = []
    for at in (pairs.sum(axis=1) + offset, np.abs(pairs[:, 0] - pairs[:, 1]) - offset):
        near = np.rint(at).astype(int)[:, None] + np.arange(-2, 3)
        inside = np.clip(near, 0, len(hz) - 1)
        mean, gain = sizes_log(moduli(inside))
        # not where one of the two lines themselves stands, nor one that is a cause already
        apart = np.all(np.abs(near[:, :, None] - pairs[:, None, :]) > 8, axis=2) & free[inside]
        mean = np.where((near >= 0) & (near < len(hz)) & apart, mean, -np.inf)
        at_best = mean.argmax(axis=1)[:, None]
        mixes.append((mean.max(axis=1) - np.log(3.0), np.take_along_axis(gain, at_best, 1)[:, 0]))
    (plus, plus_gain), (minus, minus_gain) = mixes
    either = np.logaddexp(np.logaddexp(plus, minus), plus + minus) - np.log(3.0)
    logs = own[rank].sum(axis=1) + either
    best = int(np.argmax(logs))
    log_b = float(np.logaddexp.reduce(logs) - 2.0 * np.log(count) - np.log(2.0))
    if log_b < float(own.max() - np.log(count)) + _BEYOND:
        return None
    whole = float(own_gain[rank[best]].sum() + max(plus_gain[best], minus_gain[best]))
    one, other = hz[pairs[best]].tolist()
    product = float(either[best] - np.log(len(pairs)))
    return Mixture(log_b, whole, product, int(pairs[best, 0]), (one, other, one + other, abs(one - other)))


def _harmonic(one: float, other: float) -> bool:
    """Whether one place in the spectrum is a multiple of the other: a line that is no sine has such."""
    low, high = sorted((one, other))
    order = round(high / low)
    return abs(high - order * low) < _HARMONIC * order
