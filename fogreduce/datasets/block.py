"""Blocks of records: what a reader yields and what the stages hand on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class RawBlock:
    """Consecutive records of a capture, in file order, as they stand there.

    Attributes
    ----------
    start : int
        Index in the file of the first record.
    time_us : (N,) int64
        Time stamps [us] since the run's start.
    pulse : (N,) int64 or None
        Number of the stimulus pulse; None for a format that numbers no records.
    counts : (n, N) int32 or None
        Counts; -2147483648 = no answer. None for a format that holds readings in the capture's unit.
    values : (n, N) float64 or None
        Readings in the capture's unit, NaN = no answer. None for a format that holds counts.
    """

    start: int
    time_us: NDArray[np.int64]
    pulse: NDArray[np.int64] | None
    counts: NDArray[np.int32] | None
    values: Floats | None


@dataclass(frozen=True)
class Block:
    """Consecutive records with their flags: what ingest hands on.

    Attributes
    ----------
    start, time_us, pulse, counts :
        As in `RawBlock`.
    flag : (N,) uint8
        `RecordFlag` of each record.
    gyro_flag : (n, N) uint8
        `GyroFlag` of each sample.
    raw : (n, N) float64
        Readings in the raw unit in use [V, count, deg/s, deg/h or rad/s]; NaN where a gyro did not answer.
        A spurious value stands as it is, flagged.
    """

    start: int
    time_us: NDArray[np.int64]
    pulse: NDArray[np.int64]
    flag: NDArray[np.uint8]
    gyro_flag: NDArray[np.uint8]
    counts: NDArray[np.int32] | None
    raw: Floats
