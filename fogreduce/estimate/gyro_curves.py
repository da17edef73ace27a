"""Mean curves of the rates that gyros read: from their raw readings, and as metadata let expect them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.curve_projection import CurveProjection
from fogreduce.estimate.uncertainty import axis_rates
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.alignment import gyro_rates_from_axis_rates
from fogreduce.physics.scale_factor import rate_from_raw

Array = NDArray[np.float64]


def rate_curve(facts: RunFacts, gyro: int, theta: Array) -> Array:
    """Theta of a gyro's rate [deg/s] from that of its raw readings, gyros counted from 0.

    Eq. 1 holds of the offset a; of p, q and e without the bias.
    """
    i = slice(gyro, gyro + 1)
    scale_factor, polarity = facts.scale_factor[i], facts.polarity[i]
    rate: Array = rate_from_raw(theta[None, :], scale_factor, np.zeros(1), polarity)[0]
    rate[0] = rate_from_raw(theta[None, :1], scale_factor, facts.bias[i], polarity)[0, 0]
    return rate


def expected_gyro_curves(facts: RunFacts, projection: CurveProjection) -> Array:
    """Theta of what each gyro should read of table and Earth over a segment, (n, 4) [deg/s]."""
    readings = gyro_rates_from_axis_rates(axis_rates(facts, projection.time_s), facts.axes)
    return readings @ projection.to_theta.T
