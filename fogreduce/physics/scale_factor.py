"""Scale factor and bias of a gyro: raw readings <-> rate (the paper's eq. 1, capture contract, step 6).

Raw readings are volts, or whatever a unit puts out (`fogreduce.physics.raw_quantity`): "raw unit" below.
Sign convention: `polarity` (+1 or -1) is the sign that turns a gyro's raw reading into the calibrated one;
a positive rate about the input axis gives positive calibrated readings when C is positive.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def raw_from_rate(rate: Array, scale_factor: Array, bias: Array, polarity: Array) -> Array:
    """Raw readings that gyros put out: ``v = polarity (C M + B)``.

    Parameters
    ----------
    rate : (n, N) array
        Rate about each gyro's input axis, M [deg/s].
    scale_factor, bias, polarity : (n,) arrays
        C [raw unit/(deg/s)], B [raw unit], +1 or -1.

    Returns
    -------
    (n, N) array
        Raw readings v [raw unit].
    """
    raw = rate * scale_factor[:, None]
    raw += bias[:, None]
    raw *= polarity[:, None]
    return raw


def rate_from_raw(raw: Array, scale_factor: Array, bias: Array, polarity: Array) -> Array:
    """Rate about each gyro's input axis: ``M = (polarity v - B) / C`` (eq. 1). Inverse of `raw_from_rate`.

    Parameters
    ----------
    raw : (n, N) array
        Raw readings v [raw unit]; NaN where a gyro did not answer.
    scale_factor, bias, polarity : (n,) arrays
        C [raw unit/(deg/s)], B [raw unit], +1 or -1.

    Returns
    -------
    (n, N) array
        M [deg/s].
    """
    rate = raw * polarity[:, None]
    rate -= bias[:, None]
    rate /= scale_factor[:, None]
    return rate
