"""The order of a capture's records: lost, repeated and late ones, and stamps that cannot be right.

Pulse numbers count from 0; a lost record leaves a hole. A number that occurs again counts once, the first
time; one that comes late, into a hole, is used and flagged. State grows with faults, not with the record.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND
from fogreduce.datasets.flags import RecordFlag
from fogreduce.estimate.clock import STAMP_TOLERANCE_PULSES, STAMP_TOLERANCE_S, StampClock
from fogreduce.estimate.lead import median_of_nine
from fogreduce.estimate.outliers import isolated

Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]

#: A clock that runs fast or slow moves stamps by so much of the time between two records.
_CLOCK_RATE = 0.01
#: Of the profile's length: a clock so much fast stamps the last records after its end.
_BEYOND = 1e-3


@dataclass
class SequenceCheck:
    """Judges the order of records block by block.

    Parameters
    ----------
    sample_rate_hz : float
    n_expected : int
        Records of a whole capture; a later pulse lies beyond the profile.
    end_us : float
        The profile's end [us].
    numbered : bool
        Whether the format numbers its records: then stamps are held against the numbers.
    """

    sample_rate_hz: float
    n_expected: int
    end_us: float = np.inf
    numbered: bool = True
    highest: int = -1
    distinct: int = 0
    _late_us: float = 0.0
    _late_pulse: int = 0
    _apart_us: float = 0.0
    _latest_us: int | None = None
    _hole_start: Integers = field(default_factory=lambda: np.empty(0, np.int64))
    _hole_stop: Integers = field(default_factory=lambda: np.empty(0, np.int64))
    _filled: Integers = field(default_factory=lambda: np.empty(0, np.int64))

    def __post_init__(self) -> None:
        self.clock = StampClock(self.sample_rate_hz)
        self._tolerance_us = MICROSECONDS_PER_SECOND * max(
            STAMP_TOLERANCE_S, STAMP_TOLERANCE_PULSES / self.sample_rate_hz
        )

    def flags(self, time_us: Integers, pulse: Integers, wrong: Flags | None = None) -> NDArray[np.uint8]:
        """Flags of the next block's records.

        Parameters
        ----------
        time_us, pulse : (N,) arrays
            Stamps [us] and pulse numbers.
        wrong : (N,) array of bool or None
            Which stamps cannot be right, where that is known; None: they are held against the numbers.
        """
        flags = np.zeros(pulse.size, np.uint8)
        if wrong is None:
            wrong = self._wrong_stamps(time_us, pulse)
        flags[wrong] = RecordFlag.BAD_STAMP
        outside = self._outside(time_us, pulse)
        if outside.any():
            flags[outside & ~wrong] |= np.uint8(RecordFlag.BEYOND_PROFILE)
        good = ~wrong & (pulse >= 0)
        if good.all() and pulse[0] == self.highest + 1 and bool((np.diff(pulse) == 1).all()):
            self.highest = int(pulse[-1])
            self._count(pulse)
        else:
            self._order(pulse, good, flags)
        if good.any():
            self._latest_us = max(int(time_us[good].max()), self._latest_us or 0)
        return flags

    def _outside(self, time_us: Integers, pulse: Integers) -> Flags:
        """Which records lie before the profile's start or after its end, by number or clearly by stamp."""
        late = time_us >= self.end_us * (1 + _BEYOND) + self._tolerance_us
        early = (time_us < -self._tolerance_us) | (pulse < 0)
        by_number = pulse >= self.n_expected
        if not self.numbered:  # numbers go by the rate of the stamps, which need not be the stated one
            by_number &= time_us >= self.end_us
            late = time_us >= self.end_us + self._tolerance_us
        outside: Flags = by_number | late | early
        return outside

    def _wrong_stamps(self, time_us: Integers, pulse: Integers) -> Flags:
        """Stamps that disagree with the pulse numbers: alone among their neighbours, or for good."""
        interval_us = MICROSECONDS_PER_SECOND / self.sample_rate_hz
        late_us = time_us - pulse * interval_us
        wrong = np.zeros(pulse.size, bool)
        steady = np.ptp(late_us) <= self._tolerance_us
        allowed_us = self._tolerance_us + _CLOCK_RATE * interval_us * abs(int(pulse[0]) - self._late_pulse)
        if not (steady and not self._apart_us and abs(late_us[0] - self._late_us) <= allowed_us):
            is_isolated = isolated(late_us, self._tolerance_us)
            calm = np.where(is_isolated, median_of_nine(late_us), late_us)
            steps = np.diff(calm, prepend=self._late_us)
            passed = np.abs(np.diff(pulse, prepend=self._late_pulse)) * interval_us
            jumps = np.where(np.abs(steps) > self._tolerance_us + _CLOCK_RATE * passed, steps, 0.0)
            apart_us = self._apart_us + np.cumsum(jumps)
            wrong = is_isolated | (np.abs(apart_us) > self._tolerance_us)
            self._apart_us = float(apart_us[-1]) if abs(apart_us[-1]) > self._tolerance_us else 0.0
            late_us = calm
        self._late_us, self._late_pulse = float(late_us[-1]), int(pulse[-1])
        self._note_clock(time_us, pulse, late_us, ~wrong)
        return wrong

    def _note_clock(
        self, time_us: Integers, pulse: Integers, late_us: NDArray[np.float64], good: Flags
    ) -> None:
        """What a block's good stamps show of their clock; jitter about a straight line."""
        if not good.all():
            time_us, pulse, late_us = time_us[good], pulse[good], late_us[good]
        if pulse.size == 0:
            return
        x = pulse - pulse.mean()
        left = late_us - late_us.mean()
        spread = float(x @ x)
        off_us = left - x * (float(x @ left) / spread) if spread else left
        self.clock.add(pulse, time_us, off_us / MICROSECONDS_PER_SECOND, 0)

    def _count(self, pulse: Integers) -> None:
        self.distinct += int(np.count_nonzero(pulse < self.n_expected))

    def _order(self, pulse: Integers, good: NDArray[np.bool_], flags: NDArray[np.uint8]) -> None:
        index = np.flatnonzero(good)
        if index.size == 0:
            return
        numbers = pulse[index]
        before = np.maximum.accumulate(np.concatenate(([self.highest], numbers[:-1])))
        ahead = numbers > before
        jumps = ahead & (numbers > before + 1)
        self._hole_start = np.concatenate((self._hole_start, before[jumps] + 1))
        self._hole_stop = np.concatenate((self._hole_stop, numbers[jumps]))
        self.highest = int(max(self.highest, numbers.max()))
        late = np.flatnonzero(~ahead)
        first = self._first_in_a_hole(numbers[late])
        flags[index[late[first]]] |= np.uint8(RecordFlag.OUT_OF_ORDER)
        flags[index[late[~first]]] |= np.uint8(RecordFlag.REPEATED)
        self._filled = np.union1d(self._filled, numbers[late[first]])
        self._count(np.concatenate((numbers[ahead], numbers[late[first]])))

    def _first_in_a_hole(self, numbers: Integers) -> NDArray[np.bool_]:
        """Which of these late pulse numbers fill a hole for the first time."""
        first = np.zeros(numbers.size, bool)
        if numbers.size and self._hole_start.size:
            hole = np.searchsorted(self._hole_start, numbers, side="right") - 1
            inside = (hole >= 0) & (numbers < self._hole_stop[hole])
            once = np.zeros(numbers.size, bool)
            once[np.unique(numbers, return_index=True)[1]] = True
            first = inside & once & ~np.isin(numbers, self._filled)
        return first

    def lost(self) -> int:
        """Pulses of the profile that no record answers, those after the record's end included."""
        if self.numbered:
            return self.n_expected - self.distinct
        return sum(pulses for _, pulses in self.holes())

    def holes(self) -> list[tuple[int, int]]:
        """Holes as (first pulse lost, number of pulses), without those filled late, then the missing end."""
        found = []
        for start, stop in zip(self._hole_start.tolist(), self._hole_stop.tolist(), strict=True):
            edges = [start - 1, *self._filled[(self._filled >= start) & (self._filled < stop)].tolist(), stop]
            for low, high in pairwise(edges):
                if high - low > 1:
                    found.append((low + 1, high - low - 1))
        if (missing := self._missing_end()) > 0:
            found.append((self.highest + 1, missing))
        return found

    def _missing_end(self) -> int:
        """Pulses from the last record to the profile's end; where stamps tell them, beyond their scatter."""
        if self.numbered or self._latest_us is None:
            return self.n_expected - self.highest - 1
        rate = self.clock.rate_hz if self.clock.rate_hz > 0 else self.sample_rate_hz
        missing = round((self.end_us - self._latest_us) / MICROSECONDS_PER_SECOND * rate) - 1
        return missing if missing > 2 * self.clock.largest_jitter_s * rate else 0
