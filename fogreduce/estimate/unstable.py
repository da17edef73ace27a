"""Intervals in which a gyro is unstable: its scatter, or its level, leaves what it is over the whole run.

They are found and reported, never removed.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_WINDOW_S = 10.0  # scatter and level are judged over windows of this length, at least
_LEAST_BINS = 3
_CERTAIN = 6.0  # standard deviations by which a window's scatter must exceed the threshold's chance


@dataclass(frozen=True)
class Unstable:
    """An interval in which one gyro is unstable.

    Attributes
    ----------
    gyro : int
        Index, from 0.
    start_s, stop_s : float
        The interval [s] from the run's start.
    noise_ratio : float
        Scatter of single samples in it over its median over the run.
    """

    gyro: int
    start_s: float
    stop_s: float
    noise_ratio: float


def unstable_intervals(
    time_s: Array, count: Array, scatter: Array, threshold: float, min_duration_s: float
) -> list[Unstable]:
    """Intervals of raised scatter.

    Parameters
    ----------
    time_s : (m,) array
        Middles of the bins [s].
    count, scatter : (n, m) arrays
        Usable records of each bin, and their standard deviation about the bin's mean.
    threshold : float
        Scatter relative to its median over the run from which on a gyro is unstable.
    min_duration_s : float
        Shortest interval that counts [s].

    Returns
    -------
    list of Unstable
        In order of gyro and time. Edges are good to half a window: 5 s, or a bin and a half
        where bins are longer.
    """
    found: list[Unstable] = []
    if time_s.size < 2 * _LEAST_BINS:
        return found
    period = float(np.median(np.diff(time_s)))
    if not period > 0:
        return found  # stamps that do not run on: there is no time for an interval to lie in
    window = max(_LEAST_BINS, round(_WINDOW_S / period)) | 1
    for gyro in range(len(scatter)):
        there = np.isfinite(scatter[gyro]) & (count[gyro] > 1)
        if not there.any():
            continue
        typical = float(np.median(scatter[gyro][there]))
        if typical == 0:
            continue
        freedom = _windowed(np.where(there, count[gyro] - 1, 0.0), window)
        squares = _windowed(np.where(there, (count[gyro] - 1) * scatter[gyro] ** 2, 0.0), window)
        ratio = np.sqrt(np.divide(squares, freedom, out=np.zeros_like(squares), where=freedom > 0)) / typical
        # By chance alone a ratio scatters by 1 / sqrt(2 freedom).
        chance = 1 + _CERTAIN / np.sqrt(2 * np.maximum(freedom, 1))
        for first, last in _runs(ratio > np.maximum(threshold, chance), window):
            start, stop = time_s[first] - period / 2, time_s[last] + period / 2
            if stop - start < min_duration_s:
                continue
            inside = slice(first, last + 1)
            whole = (count[gyro] - 1)[inside][there[inside]]
            level = np.sqrt((whole * scatter[gyro][inside][there[inside]] ** 2).sum() / whole.sum())
            found.append(Unstable(gyro, float(max(start, 0.0)), float(stop), float(level / typical)))
    return found


def _windowed(values: Array, window: int) -> Array:
    """Sum over a centred window, cut off at the ends."""
    sums = np.concatenate(([0.0], np.cumsum(values)))
    index = np.arange(values.size)
    half = window // 2
    return sums[np.minimum(index + half + 1, values.size)] - sums[np.maximum(index - half, 0)]


def _runs(flags: NDArray[np.bool_], gap: int) -> list[tuple[int, int]]:
    """First and last index of each stretch of True, stretches less than `gap` apart taken as one."""
    index = np.flatnonzero(flags)
    if index.size == 0:
        return []
    cuts = np.flatnonzero(np.diff(index) > gap)
    firsts = index[np.concatenate(([0], cuts + 1))]
    lasts = index[np.concatenate((cuts, [index.size - 1]))]
    return list(zip(firsts.tolist(), lasts.tolist(), strict=True))
