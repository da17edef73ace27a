"""Covariance between overlapping Allan variances at several averaging times, by the noise that they are of.

An Allan variance is a mean of squares of second differences d of phase, so that of normal noise two of them
have the covariance ``mean over pairs of [2 C^2 + 4 mu mu' C] / (4 tau^2 tau'^2)``, C being the covariance of
a difference at one averaging time with one at the other (Isserlis), mu = R tau^2 what a rate ramp adds to
each. C is a sum of nine generalised covariances of phase at their lags (Greenhall 1997); it is smooth except
at whole averaging times, so that it is summed on lags that are dense there.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.characterise.allan_freedom import generalised_covariance

Array = NDArray[np.float64]

#: Terms of the Allan variance; each is given by its value at one interval.
TERMS = ("quantization", "white", "flicker", "walk", "ramp")
_ALPHA = {"white": 0, "flicker": -1, "walk": -2}
_SIGNS = np.array([1.0, -2.0, 1.0])
_COARSE = 8  # lags an averaging time
_REACH = 6  # averaging times beyond which differences do not correlate


@dataclass(frozen=True)
class _Pair:
    """Differences at two averaging times: C, of one of each term, at lags and at those of quantization.

    Attributes
    ----------
    weights, smooth : (L,), (3, L) arrays
        Of lags; C of white noise, flicker and walk.
    meeting_weights, quantization, others : (M,), (M,), (3, M) arrays
        The same at the lags at which phases coincide, where alone quantization correlates.
    """

    weights: Array
    smooth: Array
    meeting_weights: Array
    quantization: Array
    others: Array


def covariance(factors: tuple[int, ...], size: int, terms: Array) -> Array:
    """Covariance of overlapping Allan variances of a series without gaps.

    Parameters
    ----------
    factors : tuple of int
        Averaging times in intervals.
    size : int
        Number of rates.
    terms : (5,) array
        Allan variance at one interval of each of `TERMS`, none negative.
    """
    pairs = _pairs(factors, size)
    q, ramp = terms[0], terms[4]
    found = np.zeros((len(factors), len(factors)))
    for (i, j), pair in pairs.items():
        m, n = factors[i], factors[j]
        smooth, other = terms[1:4] @ pair.smooth, terms[1:4] @ pair.others
        quantized = q * pair.quantization
        squares = pair.weights @ smooth**2 + pair.meeting_weights @ (quantized**2 + 2.0 * quantized * other)
        shared = pair.weights @ smooth + pair.meeting_weights @ quantized
        means = 2.0 * ramp * float(m) ** 2 * float(n) ** 2  # of mu mu'
        found[i, j] = found[j, i] = (2.0 * squares + 4.0 * means * shared) / (4.0 * float(m * n) ** 2)
    return found


@lru_cache(maxsize=8)
def _pairs(factors: tuple[int, ...], size: int) -> dict[tuple[int, int], _Pair]:
    return {
        (i, j): _pair(m, n, size - 2 * m + 1, size - 2 * n + 1)
        for i, m in enumerate(factors)
        for j, n in enumerate(factors[: i + 1])
    }


def _pair(m: int, n: int, starts: int, others: int) -> _Pair:
    """`m` >= `n`; numbers of windows of each. The lag is where that of n begins less where that of m does."""
    lags = _lags(m, n, starts, others)
    shape = _scales()
    meeting = np.unique([a * m - b * n for a in range(3) for b in range(3)]).astype(float)
    quantization = np.zeros(meeting.size)
    for a, sign_a in enumerate(_SIGNS):
        for b, sign_b in enumerate(_SIGNS):
            quantization[np.searchsorted(meeting, a * m - b * n)] += sign_a * sign_b
    return _Pair(
        _spacing(lags) * _share(lags, starts, others),
        np.array([shape[term] * _difference(lags, m, n, alpha) for term, alpha in _ALPHA.items()]),
        _share(meeting, starts, others),
        quantization * shape["quantization"],
        np.array([shape[term] * _difference(meeting, m, n, alpha) for term, alpha in _ALPHA.items()]),
    )


@lru_cache(maxsize=1)
def _scales() -> dict[str, float]:
    """What makes each term's Allan variance 1 at one interval: half C at no lag."""
    one = np.zeros(1)
    scales = {term: 2.0 / float(_difference(one, 1, 1, alpha)[0]) for term, alpha in _ALPHA.items()}
    return {**scales, "quantization": 2.0 / 6.0}


def _spacing(lags: Array) -> Array:
    """How many whole lags each one stands for, by the trapezoidal rule."""
    steps = np.diff(lags)
    return (np.concatenate(([1.0], steps)) + np.concatenate((steps, [1.0]))) / 2.0


def _difference(lags: Array, m: int, n: int, alpha: int) -> Array:
    """C at lags, up to a factor."""
    found = np.zeros(lags.size)
    for a, sign_a in enumerate(_SIGNS):
        for b, sign_b in enumerate(_SIGNS):
            found += sign_a * sign_b * generalised_covariance(lags + (b * n - a * m), alpha + 2)
    return found


def _share(lags: Array, starts: int, others: int) -> Array:
    """Part of all pairs of windows that lie at each lag."""
    first = np.maximum(0.0, -lags)
    last = np.minimum(starts - 1.0, others - 1.0 - lags)
    share: Array = np.maximum(0.0, last - first + 1.0) / (float(starts) * others)
    return share


def _lags(m: int, n: int, starts: int, others: int) -> Array:
    """Whole lags that are enough to sum a smooth function of them by: every one, or dense where it bends."""
    low, high = max(-(starts - 1), -2 * n - _REACH * m), min(others - 1, (2 + _REACH) * m)
    step, fine = max(1, m // _COARSE), max(1, n // _COARSE)
    parts: list[Any] = [np.arange(low, high + 1, step), [high]]
    for a in range(3):
        parts.append(np.arange(a * m - 4 * n, a * m + 2 * n + 1, fine))
        parts.append([a * m - b * n for b in range(3)])
    lags = np.unique(np.concatenate(parts).astype(np.int64))
    return lags[(lags >= low) & (lags <= high)].astype(np.float64)
