"""Gyro input axes <-> unit frame x, y, z (the paper's eq. 2, capture contract, steps 5).

H (3 x n) takes gyro rates to the unit frame; G (n x 3), its pseudo-inverse, holds the directions of
the input axes in the unit frame, one a row. `frame_signs` is the sign with which each projected axis
reads a positive rotation: the axes read ``Omega = frame_signs * w``.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def gyro_axes(projection: Array) -> Array:
    """Directions of the gyro axes, G (n x 3) = pseudo-inverse of H (3 x n)."""
    return np.linalg.pinv(projection).astype(np.float64)


def gyro_rates_from_axis_rates(axis_rates: Array, axes: Array) -> Array:
    """What each gyro reads: ``M = G Omega``.

    Parameters
    ----------
    axis_rates : (3, N) array
        Omega [deg/s], frame signs already in it.
    axes : (n, 3) array
        G, directions of the input axes in the unit frame.

    Returns
    -------
    (n, N) array
        M [deg/s].
    """
    return axes @ axis_rates


def axis_rates_from_gyro_rates(gyro_rates: Array, projection: Array) -> Array:
    """Rates x, y, z: ``Omega = H M`` (eq. 2), the least-squares inverse of `gyro_rates_from_axis_rates`.

    A record in which a gyro is NaN gives NaN on all three axes.

    Parameters
    ----------
    gyro_rates : (n, N) array
        M [deg/s].
    projection : (3, n) array
        H.

    Returns
    -------
    (3, N) array
        Omega [deg/s].
    """
    return projection @ gyro_rates


def axis_rates_from_unit_rate(unit_rate: Array, frame_signs: Array) -> Array:
    """What the projected axes read of the unit's rotation: ``Omega = frame_signs * w`` (its own inverse).

    Parameters
    ----------
    unit_rate : (3, N) array
        w [deg/s], right-handed about x, y, z of the unit frame.
    frame_signs : (3,) array of +1 or -1
    """
    return frame_signs[:, None] * unit_rate
