"""Type of noise at an averaging time, by the lag-1 autocorrelation of means over it.

Riley and Greenhall, "Power law noise identification using the lag 1 autocorrelation" (EFTF 2004; SP 1065,
section 5.5.6): of fractionally integrated noise of order delta it is ``delta / (1 - delta)``; means that
correlate more are differenced first. Differences of means are second differences of phase, whose correlation
is known for each type of noise: these numbers stand in for the rule of fractional noise, by which flicker
lies between flicker and random walk.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fogreduce.characterise.allan_freedom import second_difference_correlation
from fogreduce.estimate.allan_variance import Series

Array = NDArray[np.float64]

_FEWEST_MEANS = 30  # with fewer, the type is that of the last averaging time that had them
_STARTS = 4  # series of means that begin a quarter of an averaging time apart
_PLENTY = 3000  # means that need no others beside them
_STATIONARY = 0.25  # largest delta that is not differenced away
_SURE = 3.0  # standard deviations by which another type must be nearer


def noise_types(series: Series, factors: list[int]) -> list[int]:
    """Exponent alpha, 2 to -2, of the rate's density at each of rising averaging times, in intervals.

    The type changes from one averaging time to the next only where the correlation says so beyond its
    scatter: a wrong type makes wrong limits, and long averaging times have few means to tell it by.
    """
    found: list[int] = []
    for factor in factors:
        means = series.values.size // factor
        alpha = _alpha(series, factor) if means >= _FEWEST_MEANS else None
        if found and (alpha is None or abs(alpha - found[-1]) < 0.5 + _SURE / math.sqrt(means)):
            found.append(found[-1])
        else:
            found.append(0 if alpha is None else int(np.clip(round(alpha), -2, 2)))
    return found


def _alpha(series: Series, m: int) -> float | None:
    """Alpha by means over m intervals, as a real number; None where too few neighbours are there."""
    starts = _STARTS if series.values.size < _PLENTY * m else 1
    rows = [_means(series, m, offset) for offset in sorted({k * m // starts for k in range(starts)})]
    correlation = _lag_one(rows)
    if correlation is None:
        return None
    delta = correlation / (1.0 + correlation)
    if delta < _STATIONARY:
        return -2.0 * delta
    of_differences = _lag_one([np.diff(row) for row in rows])
    if of_differences is None:
        return None
    types = np.array([0, -1, -2])
    by_type = [second_difference_correlation(int(alpha)) for alpha in types]
    return float(np.interp(of_differences, by_type, types))


def _means(series: Series, m: int, offset: int) -> Array:
    """Means over neighbouring m intervals; NaN where fewer than half are there."""
    if series.there is None:
        return np.diff(series.phase[offset::m]) / m
    counts, sums = np.diff(series.counts[offset::m]), np.diff(series.phase[offset::m])
    means: Array = np.where(2 * counts >= m, sums / np.maximum(counts, 1), np.nan)
    return means


def _lag_one(rows: list[Array]) -> float | None:
    """Autocorrelation at lag 1 of several series of one process, NaN left out."""
    products = squares = 0.0
    for row in rows:
        there = np.isfinite(row)
        pairs = np.count_nonzero(there[1:] & there[:-1])
        if pairs < _FEWEST_MEANS // 2:
            continue
        values = np.count_nonzero(there)
        left = np.where(there, row, 0.0)
        left = np.where(there, left - left.sum() / values, 0.0)
        products += float(left[1:] @ left[:-1]) / pairs
        squares += float(left @ left) / values
    return products / squares if squares > 0 else None
