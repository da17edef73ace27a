"""What time stamps say by themselves: unit and epoch, rate, length, and where they begin."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND

#: Seconds since 1970 and since 1980-01-06 of this century so far; the two overlap before 2015.
_UNIX_S = (1.2e9, 2.5e9)
_GPS_S = (6e8, 1.55e9)
_SCALE = {"s": 1.0, "ms": 1e3, "us": 1e6, "ns": 1e9}
_SLOWEST_HZ, _FASTEST_HZ = 0.01, 10_000.0


def time_keys(first: Any, second: Any, unit: str | None, name: str) -> tuple[dict[str, str], list[str]]:
    """Keys of `capture.time` for a column, and why.

    Parameters
    ----------
    first, second : values of the column
    unit : str or None
        The unit that the column's name states.
    name : str
        The column's name.
    """
    if isinstance(first, str | bytes | np.datetime64):
        return {"unit": "iso8601"}, ["dates with times"]
    value, why = float(first), [f"unit {unit} by its name"] if unit else []
    if unit == "ticks":
        return {"unit": "ticks"}, why
    units = [unit] if unit in _SCALE else list(_SCALE)
    for one in units:
        seconds = value / _SCALE[one]
        if "gps" in name.lower() and _GPS_S[0] <= seconds <= _GPS_S[1]:
            return {"unit": one, "epoch": "gps"}, [*why, "GPS seconds by name and size"]
        if _UNIX_S[0] <= seconds <= _UNIX_S[1]:
            return {"unit": one, "epoch": "unix"}, [*why, f"{one} since 1970 by their size"]
    if unit is None:
        step = float(second) - value
        fitting = [one for one in _SCALE if step > 0 and 1.0 <= _SCALE[one] / step <= _FASTEST_HZ]
        unit = fitting[0] if fitting else "s"
        why = [f"unit {unit} by the interval of {step:g}"]
    return {"unit": unit}, why


@dataclass
class Intervals:
    """Stamps [us] gathered in one pass: first, last, how many, and a sample of intervals."""

    first: int | None = None
    last: int = 0
    count: int = 0
    steps: NDArray[np.int64] | None = None

    def add(self, time_us: NDArray[np.int64]) -> None:
        """Stamps that follow those before."""
        if time_us.size == 0:
            return
        if self.first is None:
            self.first, self.steps = int(time_us[0]), np.diff(time_us)
        self.last, self.count = int(time_us[-1]), self.count + time_us.size

    def rate_hz(self) -> float | None:
        """The sample rate; None where the stamps show none."""
        if self.first is None or self.steps is None or self.count < 2:
            return None
        span = (self.last - self.first) / (self.count - 1)
        middle = float(np.median(self.steps))
        good = self.steps[np.abs(self.steps - middle) < 0.25 * middle]
        interval = float(good.mean()) if good.size else span
        if span > 0 and (middle <= 0 or abs(span - interval) < 0.01 * interval):
            interval = span  # of the whole record: less rounding in it
        if interval <= 0:
            return None
        rate = MICROSECONDS_PER_SECOND / interval
        short = float(f"{rate:.6g}")
        rate = short if abs(short - rate) * self.count < 0.5 * rate else float(f"{rate:.9g}")
        return rate if _SLOWEST_HZ <= rate <= _FASTEST_HZ else None


def least_step(values: NDArray[Any]) -> float:
    """The least step between readings (n, N): what one unit of their last digit or count stands for."""
    if values.dtype.kind in "iub":
        return 1.0
    steps = []
    for row in values:
        distinct = np.unique(row[np.isfinite(row)])
        gaps = np.diff(distinct)
        gaps = gaps[gaps > 1e-12 * np.abs(distinct[1:])]
        if gaps.size:
            steps.append(float(gaps.min()))
    return float(f"{min(steps):.3g}") if steps else 1e-9


def as_mapping(time: Mapping[str, Any], tick_s: float | None) -> dict[str, Any]:
    """`capture.time` with the tick's length, where it counts ticks."""
    return {**time, "tick_s": tick_s} if time.get("unit") == "ticks" and tick_s else dict(time)
