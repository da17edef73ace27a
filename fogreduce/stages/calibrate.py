"""Stage 2, calibrate: raw readings to rates about the gyros' input axes (eq. 1)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.scale_factor import rate_from_raw

NAME = "calibrate"


def calibrate(facts: RunFacts, raw: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rates M [deg/s], (n, N), from raw readings [raw unit], (n, N); NaN where a gyro did not answer."""
    return rate_from_raw(raw, facts.scale_factor, facts.bias, facts.polarity)
