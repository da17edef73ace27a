"""Stage 2, calibrate: raw volts to rates about the gyros' input axes (eq. 1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.scale_factor import rate_from_volts

NAME = "calibrate"


def calibrate(facts: RunFacts, volts: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rates M [deg/s], (n, N), from raw volts [V], (n, N); NaN where a gyro did not answer."""
    return rate_from_volts(volts, facts.scale_factor, facts.bias, facts.polarity)
