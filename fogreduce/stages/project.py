"""Stage 3, project: rates about the gyros' axes to rates about x, y, z (eq. 2)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND
from fogreduce.estimate.every_record import EveryRecord, Geometries
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.alignment import axis_rates_from_gyro_rates

NAME = "project"


def project(facts: RunFacts, gyro_rates: NDArray[np.float64]) -> NDArray[np.float64]:
    """Rates Omega [deg/s], (3, N), from M [deg/s], (n, N); NaN where a gyro did not answer.

    Only for a unit of three gyros or more.
    """
    assert facts.projection is not None
    return axis_rates_from_gyro_rates(gyro_rates, facts.projection)


class Projection:
    """Projects the blocks of a run, in order.

    Parameters
    ----------
    facts : RunFacts
    complete_records : bool
        Whether only records in which every gyro answered give x, y, z, by the record's H. Else those of three
        gyros or more do, by generalised least squares (`fogreduce.estimate.every_record`).
    """

    def __init__(self, facts: RunFacts, complete_records: bool) -> None:
        self._facts = facts
        self._every = None if complete_records else EveryRecord(Geometries(facts.axes, facts.white_noise))

    def block(
        self, gyro_rates: NDArray[np.float64], gyro_flag: NDArray[np.uint8], time_us: NDArray[np.int64]
    ) -> NDArray[np.float64]:
        """Rates Omega [deg/s], (3, N), of the next block: M (n, N) [deg/s], flags (n, N), stamps (N,)."""
        if self._every is None:
            return project(self._facts, gyro_rates)
        segment = self._facts.profile.segment_at(time_us / MICROSECONDS_PER_SECOND)
        return self._every.project(gyro_rates, gyro_flag == 0, segment)
