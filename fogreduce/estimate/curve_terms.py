"""What is published of a mean curve, as weights of its coefficients theta = (a, p, q, e).

Drift by the paper's offset rule, plain integral and mean rate are linear in theta, so that their errors
follow from its covariance exactly.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.mean_curve import integral_terms

Array = NDArray[np.float64]


def drift_terms(start_s: float, stop_s: float, rate_rad_s: float) -> Array:
    """(4,): the accumulated error over a segment is these times theta.

    Integral of ``p cos(ct) + q sin(ct) + e t`` over the segment, less the same at its start times the
    duration; a, the offset, does not count.
    """
    duration = stop_s - start_s
    whole = plain_terms(start_s, stop_s, rate_rad_s)
    phase = rate_rad_s * start_s
    at_start = np.array([1.0, math.cos(phase), math.sin(phase), start_s])
    terms: Array = whole - duration * at_start
    terms[0] = 0.0
    return terms


def plain_terms(start_s: float, stop_s: float, rate_rad_s: float) -> Array:
    """(4,): the plain integral of the curve over a segment is these times theta."""
    terms: Array = integral_terms(np.array([start_s, stop_s]), rate_rad_s) @ np.array([-1.0, 1.0])
    return terms


def mean_rate_terms(start_s: float, stop_s: float, rate_rad_s: float) -> Array:
    """(4,): the mean of the curve from start to stop [s] is these times theta."""
    return plain_terms(start_s, stop_s, rate_rad_s) / (stop_s - start_s)
