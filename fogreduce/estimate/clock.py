"""What time stamps show of the clock that made them: its rate, its jitter, its resolution, its faults."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND

#: A stamp further than this from where its pulse number puts it, beside its neighbours, is wrong.
STAMP_TOLERANCE_S = 0.05
STAMP_TOLERANCE_PULSES = 8


@dataclass
class StampClock:
    """Sums over a record's stamps and numbers.

    Parameters
    ----------
    stated_rate_hz : float
        As run.yaml has it.

    Attributes
    ----------
    records : int
        Records seen, those with wrong stamps left out.
    doubled : int
        Records with the stamp of the one before.
    steps_back : list of (int, float)
        Record from which on the clock was set back, and by how much [s].
    resolution_us : int
        All stamps are multiples of it, seen from the first.
    largest_jitter_s : float
        Largest distance of a stamp from even ones [s].
    """

    stated_rate_hz: float
    records: int = 0
    doubled: int = 0
    steps_back: list[tuple[int, float]] = field(default_factory=list)
    resolution_us: int = 0
    largest_jitter_s: float = 0.0
    _first: tuple[int, int] | None = None
    _sums: NDArray[np.float64] = field(default_factory=lambda: np.zeros(5))
    _off_squares: float = 0.0

    def add(
        self,
        number: NDArray[np.int64],
        time_us: NDArray[np.int64],
        off_s: NDArray[np.float64],
        resolution_us: int,
    ) -> None:
        """Add records: numbers, stamps [us], how far these are from even ones [s], resolution [us]."""
        self.resolution_us = math.gcd(self.resolution_us, resolution_us)
        if number.size == 0:
            return
        if self._first is None:
            self._first = int(number[0]), int(time_us[0])
        x = (number - self._first[0]).astype(np.float64)
        # of the time what the stated rate leaves: small, so that no digits are lost
        y = (time_us - self._first[1]) / MICROSECONDS_PER_SECOND - x / self.stated_rate_hz
        self._sums += np.array([x.size, x.sum(), y.sum(), x @ x, x @ y])
        self._off_squares += float(off_s @ off_s)
        self.largest_jitter_s = max(self.largest_jitter_s, float(np.abs(off_s).max()))
        self.records += int(number.size)

    @property
    def rate_hz(self) -> float:
        """Rate by the stamps [Hz]; NaN where there are too few."""
        n, x, y, xx, xy = self._sums.tolist()
        spread = n * xx - x * x
        if n < 2 or spread <= 0:
            return math.nan
        interval = 1 / self.stated_rate_hz + (n * xy - x * y) / spread
        return 1 / interval if interval > 0 else math.nan

    @property
    def rate_ppm(self) -> float:
        """By how much the rate by the stamps exceeds the stated one [ppm]; the drift of the clock."""
        return (self.rate_hz / self.stated_rate_hz - 1) * 1e6

    @property
    def jitter_s(self) -> float:
        """Root mean square distance of stamps from even ones [s]."""
        return math.sqrt(self._off_squares / self.records) if self.records else math.nan
