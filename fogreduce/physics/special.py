"""A few special functions in plain NumPy: importing SciPy's costs more than a second run's diagnosis does.

Each is held against SciPy's by a test.
"""

from __future__ import annotations

import math
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_EULER = 0.5772156649015329
_SERIES = 22  # terms of Ci's series: enough for arguments up to `_SERIES_TO`
_SERIES_TO = 6.0
_LARGE_I0 = 300.0  # from here on an expansion in 1 / x is exact to rounding
_FAR = -20.0  # below, the normal tail is an expansion in 1 / x^2


def cosine_integral(x: Array) -> Array:
    """Ci(x) for x > 0, any shape; large arguments cost SciPy's import."""
    if np.any(x > _SERIES_TO):
        from scipy.special import sici

        return np.asarray(sici(x)[1], np.float64)
    k = np.arange(1, _SERIES)
    terms = [0.0, *((-1.0) ** k / (2.0 * k * [float(math.factorial(2 * int(j))) for j in k])).tolist()]
    result: Array = _EULER + np.log(x) + np.polynomial.polynomial.polyval(x * x, terms)
    return result


def log_i0(x: Array) -> Array:
    """Ln of the modified Bessel function I0 for x >= 0, any shape."""
    near = np.log(np.i0(np.minimum(x, _LARGE_I0)))
    y = 1.0 / np.maximum(x, _LARGE_I0)
    series = np.log1p(y * (1 / 8 + y * (9 / 128 + y * (75 / 1024 + y * (3675 / 32768 + y * 59535 / 262144)))))
    far = np.maximum(x, _LARGE_I0) - 0.5 * np.log(2.0 * np.pi / y) + series
    return np.where(x < _LARGE_I0, near, far)


def log_normal_tail(x: float) -> float:
    """Ln of the probability that a normal deviate is below x, exact however small."""
    if x > _FAR:
        return math.log(0.5 * math.erfc(-x / math.sqrt(2.0)))
    y = 1.0 / (x * x)
    series = math.log1p(-y * (1.0 - 3.0 * y * (1.0 - 5.0 * y * (1.0 - 7.0 * y * (1.0 - 9.0 * y)))))
    return -0.5 * x * x - math.log(-x) - 0.5 * math.log(2.0 * math.pi) + series


def log_chi2_tail(q: float, k: int) -> float:
    """Ln of the probability that chi-squared of k degrees exceeds q > 0: a finite sum, all terms positive."""
    x = 0.5 * q
    if k % 2:
        # erfc(sqrt x) + exp(-x) sum of x^(j - 1/2) / Gamma(j + 1/2), j = 1 ... (k - 1) / 2
        logs = [math.log(2.0) + log_normal_tail(-math.sqrt(q))]
        halves: Any = range(1, (k - 1) // 2 + 1)
        logs += [-x + (j - 0.5) * math.log(x) - math.lgamma(j + 0.5) for j in halves]
    else:
        logs = [-x + j * math.log(x) - math.lgamma(j + 1.0) for j in range(k // 2)]
    top = max(logs)
    return min(top + math.log(sum(math.exp(one - top) for one in logs)), 0.0)


def normal_deviate(p: float) -> float:
    """The normal deviate below which the probability is p, 0 < p < 1."""
    return NormalDist().inv_cdf(p)
