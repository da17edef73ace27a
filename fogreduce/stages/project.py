"""Stage 3, project: rates about the gyros' axes to rates about x, y, z (eq. 2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.alignment import axis_rates_from_gyro_rates

NAME = "project"


def project(facts: RunFacts, gyro_rates: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rates Omega [deg/s], (3, N), from M [deg/s], (n, N); NaN where a gyro did not answer.

    Only for a unit of three gyros or more.
    """
    assert facts.projection is not None
    return axis_rates_from_gyro_rates(gyro_rates, facts.projection)
