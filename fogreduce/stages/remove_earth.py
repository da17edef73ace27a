"""Stage 4, remove Earth's rate from the rates about x, y, z (eq. 3 to 6)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.earth_rate import remove_earth_rate
from fogreduce.stages.setup import TableAngle

NAME = "remove_earth"


def remove_earth(
    facts: RunFacts, angle: TableAngle, time_s: NDArray[np.float64], axis_rates: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Rates with Earth's part taken away [deg/s], (3, N), from Omega (3, N) at times [s] (N,)."""
    return remove_earth_rate(axis_rates, facts.earth, angle.at(time_s))
