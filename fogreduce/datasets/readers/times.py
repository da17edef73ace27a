"""Time columns: from whatever a laboratory's clock counts in to whole microseconds since the run's start."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import UTC, datetime
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.errors import BadInput
from fogreduce.units import GPS_EPOCH_US, gps_leap_seconds, microseconds_since_1970

Integers = NDArray[np.int64]

#: Microseconds that one number of a time column's unit stands for.
MICROSECONDS = {"s": 1e6, "ms": 1e3, "us": 1.0, "ns": 1e-3}
#: Microseconds that fit 64 bits with room for differences.
_LARGEST_US = 4e18
FIRST = "first"


class Clock:
    """Turns values of a time column into stamps.

    Parameters
    ----------
    capture : mapping
        The `capture` block of run.yaml, validated plain data.
    start_us : int
        The run's start, microseconds since 1970-01-01T00:00:00Z.

    Raises
    ------
    BadInput
        By `stamps_us`: a time that is no number, or so large that it cannot be one of this unit.
    """

    def __init__(self, capture: Mapping[str, Any], start_us: int) -> None:
        time = capture.get("time") or {}
        self.unit: str = time.get("unit", "s")
        self._tick_us = float(time.get("tick_s") or 0.0) * 1e6
        self._start_us = start_us
        self._epoch: str = time.get("epoch", "run")
        zero = capture.get("time_zero")
        self._first = zero == FIRST
        self._zero: float | int | None = None
        if isinstance(zero, str) and not self._first:
            self._zero_instant_us: int | None = _instant_us(zero)
        else:
            self._zero_instant_us = None
            self._zero = None if self._first else zero

    def stamps_us(self, values: NDArray[Any]) -> Integers:
        """Stamps [us] since the run's start of consecutive values (N,); those that are none: `NO_STAMP`."""
        if values.dtype.kind in "MOUS":
            return self._of_instants(values)
        if values.size and self._first and self._zero is None:
            self._zero = values[0].item()
        zero = self._zero or 0
        if values.dtype.kind in "iu" and isinstance(zero, int):
            # Whole numbers stay exact: nanoseconds since 1970 do not fit a double.
            counted = values.astype(np.int64) - zero
            if self.unit == "ns":
                stamps = _rounded_quotient(counted, 1000)
            elif self.unit == "ticks":
                return self._shifted(_whole(counted.astype(np.float64) * self._tick_us))
            else:
                stamps = counted * int(MICROSECONDS[self.unit])
            return self._shifted(stamps)
        per = self._tick_us if self.unit == "ticks" else MICROSECONDS[self.unit]
        return self._shifted(_whole((values.astype(np.float64) - zero) * per))

    def _shifted(self, stamps: Integers) -> Integers:
        """From the column's epoch to the run's start; a stated zero is the run's start itself."""
        if self._epoch == "run" or self._zero is not None or stamps.size == 0:
            return stamps
        offset = self._start_us
        if self._epoch == "gps":
            offset -= GPS_EPOCH_US - gps_leap_seconds(self._start_us) * 1_000_000
        there = stamps != NO_STAMP
        shifted: Integers = np.where(there, stamps - offset, NO_STAMP)
        return shifted

    def _of_instants(self, values: NDArray[Any]) -> Integers:
        """Of dates with times: text (ISO 8601) or a format's own instants, both UTC."""
        if values.dtype.kind != "M":
            values = _parsed(values)
        since_1970 = values.astype("datetime64[us]").astype(np.int64)
        missing = np.isnat(values)
        if self._first and self._zero_instant_us is None and values.size and not missing[0]:
            self._zero_instant_us = int(since_1970[0])
        zero = self._start_us if self._zero_instant_us is None else self._zero_instant_us
        stamps: Integers = np.where(missing, NO_STAMP, since_1970 - zero)
        return stamps


#: Stands for a time that is not there or no time; no clock shows it.
NO_STAMP = int(np.iinfo(np.int64).min)


def _whole(microseconds: NDArray[np.float64]) -> Integers:
    good = np.abs(microseconds) <= _LARGEST_US  # false for NaN
    whole: Integers = np.rint(np.where(good, microseconds, 0.0)).astype(np.int64)
    return np.where(good, whole, NO_STAMP)


def _rounded_quotient(values: Integers, divisor: int) -> Integers:
    return (values + divisor // 2) // divisor


def _parsed(texts: NDArray[Any]) -> NDArray[np.datetime64]:
    """ISO 8601 texts as instants in UTC; NaT where a text is none. A text without a zone is UTC."""
    from pandas import to_datetime

    found = to_datetime(texts, format="ISO8601", utc=True, errors="coerce")
    parsed: NDArray[np.datetime64] = found.tz_localize(None).to_numpy().astype("datetime64[us]")
    return parsed


def _instant_us(text: str) -> int:
    """An instant as `time_zero` states it, in microseconds since 1970; UTC where no zone is given."""
    try:
        instant = datetime.fromisoformat(text)
    except ValueError:
        expected = "a number in the time column's unit, an instant (ISO 8601) or the word first"
        raise BadInput.at("run.yaml", "capture.time_zero", found=text, expected=expected) from None
    return microseconds_since_1970(instant if instant.tzinfo else instant.replace(tzinfo=UTC))
