"""Scale factor and bias of a gyro: volts <-> rate (the paper's eq. 1, capture contract, step 6).

Sign convention: `polarity` (+1 or -1) is the sign that turns a gyro's raw volts into calibrated volts;
a positive rate about the input axis gives positive calibrated volts when C is positive.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def volts_from_rate(rate: Array, scale_factor: Array, bias: Array, polarity: Array) -> Array:
    """Raw volts that gyros put out: ``v = polarity (C M + B)``.

    Parameters
    ----------
    rate : (n, N) array
        Rate about each gyro's input axis, M [deg/s].
    scale_factor, bias, polarity : (n,) arrays
        C [V/(deg/s)], B [V], +1 or -1.

    Returns
    -------
    (n, N) array
        Raw volts v [V].
    """
    volts = rate * scale_factor[:, None]
    volts += bias[:, None]
    volts *= polarity[:, None]
    return volts


def rate_from_volts(volts: Array, scale_factor: Array, bias: Array, polarity: Array) -> Array:
    """Rate about each gyro's input axis: ``M = (polarity v - B) / C`` (eq. 1). Inverse of `volts_from_rate`.

    Parameters
    ----------
    volts : (n, N) array
        Raw volts v [V]; NaN where a gyro did not answer.
    scale_factor, bias, polarity : (n,) arrays
        C [V/(deg/s)], B [V], +1 or -1.

    Returns
    -------
    (n, N) array
        M [deg/s].
    """
    rate = volts * polarity[:, None]
    rate -= bias[:, None]
    rate /= scale_factor[:, None]
    return rate
