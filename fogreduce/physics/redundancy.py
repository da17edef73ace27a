"""Redundant gyros: parity, and the geometry that is left when some do not answer.

Gyros read ``M = G Omega + e``, G (n x 3) with a row for each input axis. What does not depend on the motion
is the parity ``p = V M`` (n - 3 numbers a record), the rows of V an orthonormal basis of all v with
``v G = 0``. With four gyros there is one: a failure of any of them shows in the same number, so that parity
detects it and cannot say which gyro it is.

Source: Potter and Suman, Thresholdless redundancy management with arrays of skewed instruments, AGARDograph
224 (1977); Sturza, Navigation system integrity monitoring using redundant measurements, Navigation 35 (1988).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Condition of three axes beyond which they lie in a plane as far as a unit's calibration can tell.
FLATTEST = 1e3


def projection(axes: Array, white: Sequence[float] | Array | None = None) -> Array:
    """H (3, n), a left inverse of the axes G (n, 3).

    Without `white` the pseudo-inverse, which the record's contract has; with the gyros' white noise, the one
    that makes x, y, z quietest: ``(G' W G)^-1 G' W``, W = 1 / noise^2 (generalised least squares).
    """
    if white is None:
        return np.linalg.pinv(axes).astype(np.float64)
    weight = axes.T / np.asarray(white, float) ** 2
    found: Array = np.linalg.solve(weight @ axes, weight)
    return found


def parity_vectors(axes: Array) -> Array:
    """V (n - 3, n): orthonormal rows with ``V G = 0``, the first number of each not negative.

    Parameters
    ----------
    axes : (n, 3) array
        G, n >= 3, not all in a plane.
    """
    left, _, _ = np.linalg.svd(axes, full_matrices=True)
    rows: Array = left[:, 3:].T
    return rows * np.where(rows[:, :1] < 0, -1.0, 1.0)


def spans_space(axes: Array) -> bool:
    """Whether the axes (k, 3) determine x, y and z."""
    return len(axes) >= 3 and bool(np.linalg.cond(axes) < FLATTEST)


def variance_trace(axes: Array) -> float:
    """Sum of the variances of x, y and z for gyros of noise 1: trace of ``(G' G)^-1``; inf in a plane."""
    return float(np.trace(np.linalg.inv(axes.T @ axes))) if spans_space(axes) else float("inf")
