"""Average run lengths of CUSUM detectors: the theory that delays and false alarms are held against.

A one-sided CUSUM ``S <- max(0, S + g)`` of independent gains g alarms where S > h. Its average run length
from S = 0 is that of a Markov chain on a grid of S (Brook and Evans, Biometrika 59 (1972) 539): the time
between false alarms while nothing has changed, the delay after a change. For a level g is ``u - k``, u
unit normal; for a scatter it is the log likelihood ratio of a chi-square. Of all detectors with the same
false alarms the CUSUM with k of half the shift has the shortest worst delay (Moustakides, Annals of
Statistics 14 (1986) 1379).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import lru_cache, partial

import numpy as np
from numpy.typing import NDArray
from scipy.special import chdtr, ndtr

Array = NDArray[np.float64]

#: Probability that a gain is at most this.
Distribution = Callable[[Array], Array]

_STATES = 160
_LARGEST_LIMIT = 40.0


def run_length(limit: float, gain: Distribution) -> float:
    """Samples until a one-sided CUSUM alarms, on average, from S = 0."""
    width = 2 * limit / (2 * _STATES - 1)
    state = np.arange(_STATES) * width
    to = state[None, :] - state[:, None]
    moves = gain(to + width / 2) - gain(to - width / 2)
    moves[:, 0] = gain(to[:, 0] + width / 2)
    try:
        lengths = np.linalg.solve(np.eye(_STATES) - moves, np.ones(_STATES))
    except np.linalg.LinAlgError:  # no way to the limit that double precision knows of
        return math.inf
    return float(lengths[0])


def level_run_length(limit: float, allowance: float, mean: float) -> float:
    """Of a one-sided CUSUM of level: samples of unit variance and that mean."""
    return run_length(limit, partial(_normal, shift=mean - allowance))


def two_sided_run_length(limit: float, allowance: float, mean: float) -> float:
    """The same in both directions: ``1 / L = 1 / L+ + 1 / L-``."""
    rate = sum(1.0 / level_run_length(limit, allowance, sign * mean) for sign in (1.0, -1.0))
    return 1.0 / rate if rate > 0 else math.inf


def scatter_run_length(limit: float, freedom: float, wanted: float, actual: float) -> float:
    """Of a CUSUM that looks for `wanted` times the usual variance, where it is `actual` times that."""
    return run_length(limit, partial(_chi_square, freedom=freedom, wanted=wanted, actual=actual))


@lru_cache(maxsize=256)
def level_limit(samples: float, allowance: float) -> float:
    """The limit h at which a two-sided CUSUM of level alarms falsely once in so many samples."""
    return _limit(samples, lambda limit: two_sided_run_length(limit, allowance, 0.0))


@lru_cache(maxsize=256)
def scatter_limit(samples: float, freedom: float, wanted: float) -> float:
    """The limit h at which a CUSUM of scatter alarms falsely once in so many samples."""
    return _limit(samples, lambda limit: scatter_run_length(limit, freedom, wanted, 1.0))


def scatter_gain(ratio: Array, freedom: Array, wanted: float) -> Array:
    """Log likelihood ratio (m,) of sample variances, `ratio` (m,) times the usual one, of `freedom` (m,).

    `wanted` times the usual variance is held against the usual one.
    """
    found: Array = freedom / 2 * (ratio * (1 - 1 / wanted) - math.log(wanted))
    return found


def _limit(samples: float, length: Callable[[float], float]) -> float:
    low, high = 1e-3, _LARGEST_LIMIT
    for _ in range(40):
        middle = (low + high) / 2
        found = length(middle)
        # Beyond what the chain resolves the equations are singular: longer than was asked for.
        if not 0 < found <= samples:
            high = middle
        else:
            low = middle
    return (low + high) / 2


def _normal(to: Array, shift: float) -> Array:
    found: Array = ndtr(to - shift)
    return found


def _chi_square(to: Array, freedom: float, wanted: float, actual: float) -> Array:
    slope = (1 - 1 / wanted) / 2 * actual  # of the gain in the chi-square
    chi = (to + freedom / 2 * math.log(wanted)) / slope
    below: Array = chdtr(freedom, np.maximum(chi, 0.0))
    return below if slope > 0 else 1.0 - below
