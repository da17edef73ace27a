"""Flags of records and samples, as CF flag variables: why a value is missing or left out."""

from __future__ import annotations

from enum import IntFlag

import numpy as np
from numpy.typing import NDArray

Bytes = NDArray[np.uint8]


class RecordFlag(IntFlag):
    """Why a record is out of the ordinary (variable ``flag``, one byte a record)."""

    MISSING_GYRO = 1
    SPURIOUS_GYRO = 2
    REPEATED = 4
    OUT_OF_ORDER = 8
    BAD_STAMP = 16
    BEYOND_PROFILE = 32
    CONSTANT_GYRO = 64
    ACCELERATING = 128


class GyroFlag(IntFlag):
    """Why one gyro's sample is out of the ordinary (variable ``gyro_flag``, one byte a gyro and record)."""

    MISSING = 1
    SPURIOUS = 2
    CONSTANT = 64


#: A record with one of these is left out of every estimate. One that came late is not: its stamp holds.
UNUSABLE_RECORD = (
    RecordFlag.REPEATED | RecordFlag.BAD_STAMP | RecordFlag.BEYOND_PROFILE | RecordFlag.ACCELERATING
)

#: A record with one of these is left out of estimates of x, y, z, which take all gyros.
UNUSABLE_AXES = (
    UNUSABLE_RECORD | RecordFlag.MISSING_GYRO | RecordFlag.SPURIOUS_GYRO | RecordFlag.CONSTANT_GYRO
)


def record_flags(records: Bytes, gyros: Bytes) -> Bytes:
    """The record's own flags (N,) with what its gyros' flags (n, N) say added."""
    if not gyros.any():
        return records
    any_gyro = np.bitwise_or.reduce(gyros, axis=0)
    return records | any_gyro  # the bits of a gyro mean the same in both


def cf_attributes(kind: type[IntFlag]) -> dict[str, object]:
    """CF attributes ``flag_masks`` and ``flag_meanings`` of a flag variable."""
    return {
        "flag_masks": np.array([int(flag) for flag in kind], np.uint8),
        "flag_meanings": " ".join(str(flag.name).lower() for flag in kind),
    }
