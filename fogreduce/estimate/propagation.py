"""Linear propagation of uncertainty (GUM, JCGM 100:2008): covariance, coverage factor, expanded uncertainty.

Everything that is published with an uncertainty is carried through here: y = f(x) has the covariance
J U J', J the derivatives of f at the estimates (GUM 5.2.2, in matrices GUM-S2 6.2).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Standard deviations of a normal quantity that cover 95 %.
NORMAL_95 = 1.959963984540054
#: Coefficients of Student's quantile in 1 / freedom (Abramowitz and Stegun 26.7.5), as polynomials of z.
_STUDENT = (
    (1 / 4, (1, 1)),
    (1 / 96, (3, 16, 5)),
    (1 / 384, (-15, 17, 19, 3)),
    (1 / 92160, (-945, -1920, 1482, 776, 79)),
)


def propagated(jacobian: Array, covariance: Array) -> Array:
    """Covariance of y = f(x): (m, m), from the derivatives (m, n) and the covariance of x (n, n)."""
    found: Array = jacobian @ covariance @ jacobian.T
    return found


def from_sources(departures: Array) -> Array:
    """Covariance (m, m) of values that independent sources at one standard deviation move by (sources, m)."""
    found: Array = departures.T @ departures
    return found


def standard_uncertainties(covariance: Array) -> Array:
    """Square roots of the diagonal (m,); rounding below zero counts as zero."""
    errors: Array = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    return errors


def correlations(covariance: Array) -> Array:
    """Correlation coefficients (m, m); NaN with a value that has no uncertainty."""
    errors = standard_uncertainties(covariance)
    scale = np.outer(errors, errors)
    found: Array = np.divide(covariance, scale, out=np.full(scale.shape, np.nan), where=scale > 0)
    return found


def student_95(freedom: float) -> float:
    """The 97.5 % quantile of Student's t, good to 0.2 % from three degrees of freedom on."""
    z = NORMAL_95
    terms = (
        factor * sum(c * z ** (2 * power + 1) for power, c in enumerate(of_z)) / freedom**order
        for order, (factor, of_z) in enumerate(_STUDENT, 1)
    )
    return z + math.fsum(terms)


def coverage_factor(variance: float, variance_of_variance: float) -> float:
    """By what a combined standard uncertainty is multiplied to cover 95 %.

    Where part of the variance comes from noise whose size is itself uncertain, the value has a scaled t
    distribution: with a variance of V whose own variance is W it has ``4 + 2 V^2 / W`` degrees of freedom and
    the standard deviation sqrt(V) (GUM-S1 6.4.9: that of t is ``s sqrt(n / (n - 2))``), so the factor stays
    between 1.96 and 2.00.
    """
    if not variance > 0 or not variance_of_variance > 0:
        return NORMAL_95
    freedom = 4.0 + 2.0 * variance**2 / variance_of_variance
    return student_95(freedom) * math.sqrt((freedom - 2.0) / freedom)
