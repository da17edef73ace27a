"""Equivalent degrees of freedom of Allan variances by type of noise, and the limits that follow.

Greenhall and Riley, "Uncertainty of stability variances based on finite differences" (PTTI 2003, eq. 13), as
NIST SP 1065 section 5.4 has it. Their approximations by tables save terms of the sum; here it is summed
whole, at most a few hundred lags an averaging time being enough, since what is summed is smooth in the lag.

alpha is the exponent of the rate's spectral density: +2 quantization (white phase), +1 flicker of phase, 0
angle random walk, -1 bias instability, -2 rate random walk.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Kind = Literal["overlapping", "modified", "total"]

_FINEST = 128  # lags an averaging time in the sum
_PUBLISHED_MOST = 100  # terms of their sum up to which Greenhall and Riley filter (Jmax)
_FINEST_FLICKER_PHASE = 2048  # the same where the sum is peaked at whole averaging times
#: Total variance: alpha -> b, c in ``b T / tau - c`` degrees of freedom, a in the bias ``1 - a tau / T``
#: (SP 1065, sections 5.4.3 and 5.2.11, tables 7 and 2).
_TOTAL_FROM = (
    8  # intervals; below, its formula counts too many, and it hardly differs from the overlapping one
)
_TOTAL = {0: (1.50, 0.0, 0.0), -1: (1.17, 0.22, 1.0 / (3.0 * math.log(2.0))), -2: (0.93, 0.36, 0.75)}


def generalised_covariance(lag: Array, alpha: int) -> Array:
    """Generalised covariance of a process of exponent `alpha` - 4 at any lags, up to a factor.

    Greenhall's s_w: ``-|t|`` for alpha 2, ``t^2 ln|t|`` for 1, ``|t|^3`` for 0 and so on to -2.
    """
    t = np.abs(lag)
    power = 3 - alpha
    sign = -1.0 if alpha in (2, -1, -2) else 1.0
    if power % 2:
        return sign * t**power
    return sign * t**power * np.log(np.where(t > 0, t, 1.0))


def _filtered(t: Array, factor: float, alpha: int) -> Array:
    """Averaged over 1 / `factor` of an averaging time (s_x); infinity = not averaged."""
    if math.isinf(factor):
        return generalised_covariance(t, alpha + 2)
    inner, *outer = (generalised_covariance(t + k / factor, alpha) for k in (0, -1, 1))
    return factor**2 * (2.0 * inner - outer[0] - outer[1])


def _covariance(t: Array, factor: float, alpha: int) -> Array:
    """Covariance of second differences of phase at lags in averaging times (s_z, d = 2)."""
    at = [_filtered(t + k, factor, alpha) for k in (-2, -1, 0, 1, 2)]
    return 6.0 * at[2] - 4.0 * (at[1] + at[3]) + at[0] + at[4]


@lru_cache(maxsize=8)
def second_difference_correlation(alpha: int) -> float:
    """Correlation of a second difference of phase with the one an averaging time later, alpha 0 to -2."""
    at = _covariance(np.array([0.0, 1.0]), math.inf, alpha)
    return float(at[1] / at[0])


@lru_cache(maxsize=4096)
def _finite_differences(alpha: int, m: int, size: int, *, smoothed: bool, filtered: bool) -> float:
    windows = size - (3 * m if smoothed else 2 * m) + (2 if smoothed else 1)
    if windows < 1:
        return 0.0
    if alpha == 2 and not smoothed:
        # White phase: differences correlate at lags of m and 2 m alone, by -2/3 and 1/6.
        shared = [max(0.0, 1.0 - k * m / windows) for k in (1, 2)]
        return windows / (1.0 + 8.0 / 9.0 * shared[0] + shared[1] / 18.0)
    stride = min(m, _FINEST_FLICKER_PHASE if alpha == 1 and not smoothed else _FINEST)
    many = windows * stride / m  # windows at that stride
    if smoothed:
        factor = 1.0
    elif alpha == 1 or (filtered and 3 * m <= _PUBLISHED_MOST):
        factor = float(stride)
    else:
        factor = math.inf
    j = np.arange(min(math.ceil(many), 3 * stride + 1))
    squares = _covariance(j / stride, factor, alpha) ** 2
    weights = 2.0 * (1.0 - j / many)
    weights[0] = 1.0
    return many * float(squares[0]) / float(weights @ squares)


def degrees_of_freedom(kind: Kind, alpha: int, factor: int, size: int, *, filtered: bool = False) -> float:
    """Equivalent degrees of freedom of an Allan variance of a series without gaps.

    Parameters
    ----------
    kind : {"overlapping", "modified", "total"}
    alpha : int
        Type of noise, 2 to -2.
    factor : int
        Averaging time in intervals.
    size : int
        Number of rates.
    filtered : bool
        Greenhall and Riley take each phase as averaged over one interval where 3 m <= 100, which gives their
        published numbers. A rate that is the mean over its interval, white noise a sample among them, has
        phases that are not averaged: the default. It matters below m = 10 only (white noise, m = 1: 667, not
        782).
    """
    if kind == "total" and alpha in _TOTAL and factor >= _TOTAL_FROM:
        b, c, _ = _TOTAL[alpha]
        return max(1.0, b * size / factor - c)
    smoothed = kind == "modified" and factor > 1  # at one interval there is nothing to average over
    return _finite_differences(alpha, factor, size, smoothed=smoothed, filtered=filtered)


def total_bias(alpha: int, factor: int, size: int) -> float:
    """Expected total variance over the Allan variance: ``1 - a tau / T``."""
    return 1.0 - _TOTAL.get(alpha, (0.0, 0.0, 0.0))[2] * factor / size


def limits(freedom: Array, level: float) -> tuple[Array, Array]:
    """Factors of an estimated deviation that give its lower and upper limits, by chi-squared.

    Parameters
    ----------
    freedom : (...) array
        Equivalent degrees of freedom; NaN or 0 gives NaN.
    level : float
        Probability that the true deviation lies between, for instance 0.95; as much lies on either side.
    """
    from scipy.special import chdtri

    good = np.where(freedom > 0, freedom, np.nan)
    tail = (1.0 - level) / 2.0
    return np.sqrt(good / chdtri(good, tail)), np.sqrt(good / chdtri(good, 1.0 - tail))
