"""How an Allan variance of few degrees of freedom is distributed, and the limits that follow.

An Allan variance of normal noise is a quadratic form: it is distributed as a sum of chi-squared deviates of
one degree of freedom each, weighted by the eigenvalues of the covariance of its second differences. A single
chi-squared of the same mean and variance stands in for it well where the averaging time is a small part of
the record; beyond that its tails are wrong (68 % limits that hold the truth in 71 %). There the sum itself is
taken, its Laplace transform inverted along Talbot's contour (Abate and Valko, Int. J. Numer. Meth. Eng. 60
(2004) 979: its singularities all lie on the negative axis).
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from fogreduce.characterise.allan_freedom import Kind, generalised_covariance, limits, total_bias

Array = NDArray[np.float64]

#: Probabilities of the limits.
LEVELS = (0.6826894921370859, 0.95)
#: Averaging times a record up to which the sum is taken, and the noise whose covariances are smooth.
_FEWEST_TIMES = 20  # beyond, the 68 % limits of a single chi-squared hold the truth in 69 %
_ALPHAS = (0, -1, -2)
#: Means over cells stand for the record: so many of them, and so many an averaging time at most.
_CELLS, _MOST = 128, 32
_NODES = 20  # of Talbot's contour: some ten digits
_SMALLEST, _LARGEST = 1e-9, 1e2  # quantiles looked for, over the mean
_STEPS = 30  # of bisection
_NEGLIGIBLE = 1e-5  # of the largest weight
_TAILS = tuple((1.0 - level) / 2.0 for level in LEVELS)


def relative_limits(kind: Kind, alpha: int, factor: int, size: int, freedom: float, share: float) -> Array:
    """Lower and upper limit at each of `LEVELS`, over the estimated deviation as its definition gives it.

    Parameters
    ----------
    kind : {"overlapping", "modified", "total"}
    alpha : int
        Type of noise.
    factor, size : int
        Averaging time and record in intervals.
    freedom : float
        Equivalent degrees of freedom, gaps counted.
    share : float
        Part of the degrees of freedom of a series without gaps that these are.

    Returns
    -------
    (4,) array
        Low and high at 68 %, low and high at 95 %; NaN where there is no freedom. The true deviation lies
        between with that probability, as much on either side.
    """
    if not freedom > 0:
        return np.full(4, np.nan)
    bias = total_bias(alpha, factor, size) if kind == "total" else 1.0
    if alpha in _ALPHAS and size < _FEWEST_TIMES * factor:
        cells = min(factor, _MOST, _CELLS * factor // size)
        ends = _limits_of_sum(_weights(kind, alpha, cells, round(size * cells / factor)), share)
    else:
        ends = np.array([part for level in LEVELS for part in limits(np.array(freedom), level)])
    return ends / np.sqrt(bias)


@lru_cache(maxsize=512)
def _weights(kind: Kind, alpha: int, m: int, size: int) -> tuple[float, ...]:
    """Of the chi-squared deviates, for m cells an averaging time and `size` a record; their sum is 1."""
    lags = np.arange(-size, size + 1, dtype=np.float64)
    phase = generalised_covariance(lags, alpha + 2)
    by_lag = np.zeros(2 * size + 1)
    by_lag[1:-1] = 2.0 * phase[1:-1] - phase[:-2] - phase[2:]
    at = np.arange(size)
    rates = by_lag[size + at[:, None] - at[None, :]]
    rows = _differences(kind, m, size)
    found = np.linalg.eigvalsh(rows @ rates @ rows.T)
    kept = found[found > _NEGLIGIBLE * found[-1]]
    return tuple((kept / kept.sum()).tolist())


def _differences(kind: Kind, m: int, size: int) -> Array:
    """(windows, size): the differences whose mean square the variance is, out of means over cells."""
    reach = m if kind == "total" else 0
    windows = size - 1 if kind == "total" else size - 2 * m + 1
    at = np.arange(windows)
    rows = np.zeros((windows, size + 2 * reach))
    for k in range(2 * m):
        rows[at, at + k + (kind == "total")] = 1.0 if k < m else -1.0
    if kind == "total":  # the record mirrored at both ends
        folded = rows[:, reach : reach + size].copy()
        folded[:, :reach] += rows[:, :reach][:, ::-1]
        folded[:, size - reach :] += rows[:, reach + size :][:, ::-1]
        return folded
    if kind == "modified":
        sums = np.cumsum(np.concatenate((np.zeros((1, size)), rows)), axis=0)
        averaged: Array = sums[m:] - sums[:-m]
        return averaged
    return rows


@lru_cache(maxsize=1024)
def _limits_of_sum(weights: tuple[float, ...], share: float) -> Array:
    """Four factors as of `relative_limits`; gaps leave `share` as many of each deviate, of the same mean."""
    wanted = np.array([1.0 - tail if upper else tail for tail in _TAILS for upper in (True, False)])
    low, high = np.full(wanted.size, _SMALLEST), np.full(wanted.size, _LARGEST)
    for _ in range(_STEPS):
        middle = np.sqrt(low * high)
        under = _probability(middle, np.array(weights) / share, share) < wanted
        low, high = np.where(under, middle, low), np.where(under, high, middle)
    found: Array = 1.0 / np.sqrt(high)
    return found


def _probability(values: Array, weights: Array, share: float) -> Array:
    """That a sum of chi-squared deviates of `share` degrees of freedom is below each value, (k,)."""
    turn = np.arange(1, _NODES) * np.pi / _NODES
    slope = 1.0 / np.tan(turn)
    at = np.concatenate(([0.4 * _NODES], 0.4 * _NODES * turn * (slope + 1j)))
    factor = np.exp(at) * np.concatenate(([0.5], 1.0 + 1j * turn * (1.0 + slope**2) - 1j * slope))
    s = at / values[:, None]
    transform = np.exp(-share / 2.0 * np.log1p(2.0 * weights[:, None, None] * s).sum(axis=0)) / s
    found: Array = 0.4 / values * np.real(transform @ factor)
    return found
