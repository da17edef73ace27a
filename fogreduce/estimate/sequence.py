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
from fogreduce.estimate.outliers import isolated

Integers = NDArray[np.int64]

#: A stamp further than this from where its pulse number puts it, beside its neighbours, is wrong.
STAMP_TOLERANCE_S = 0.05
STAMP_TOLERANCE_PULSES = 8


@dataclass
class SequenceCheck:
    """Judges the order of records block by block.

    Parameters
    ----------
    sample_rate_hz : float
    n_expected : int
        Records of a whole capture; a later pulse lies beyond the profile.
    """

    sample_rate_hz: float
    n_expected: int
    highest: int = -1
    distinct: int = 0
    _hole_start: Integers = field(default_factory=lambda: np.empty(0, np.int64))
    _hole_stop: Integers = field(default_factory=lambda: np.empty(0, np.int64))
    _filled: Integers = field(default_factory=lambda: np.empty(0, np.int64))

    def flags(self, time_us: Integers, pulse: Integers) -> NDArray[np.uint8]:
        """Flags of the next block's records: stamps [us] (N,), pulse numbers (N,)."""
        flags = self._bad_stamps(time_us, pulse)
        good = flags == 0
        if int(pulse.max()) >= self.n_expected:
            flags[(pulse >= self.n_expected) & good] |= np.uint8(RecordFlag.BEYOND_PROFILE)
        if good.all() and pulse[0] == self.highest + 1 and bool((np.diff(pulse) == 1).all()):
            self.highest = int(pulse[-1])
            self._count(pulse)
        else:
            self._order(pulse, good, flags)
        return flags

    def _bad_stamps(self, time_us: Integers, pulse: Integers) -> NDArray[np.uint8]:
        flags = np.zeros(pulse.size, np.uint8)
        late_us = time_us - pulse * (MICROSECONDS_PER_SECOND / self.sample_rate_hz)
        tolerance = MICROSECONDS_PER_SECOND * max(
            STAMP_TOLERANCE_S, STAMP_TOLERANCE_PULSES / self.sample_rate_hz
        )
        if late_us.size > 1 and np.ptp(late_us) > tolerance:
            flags[isolated(late_us, tolerance)] = RecordFlag.BAD_STAMP
        return flags

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
        return self.n_expected - self.distinct

    def holes(self) -> list[tuple[int, int]]:
        """Holes as (first pulse lost, number of pulses), without those filled late, then the missing end."""
        found = []
        for start, stop in zip(self._hole_start.tolist(), self._hole_stop.tolist(), strict=True):
            edges = [start - 1, *self._filled[(self._filled >= start) & (self._filled < stop)].tolist(), stop]
            for low, high in pairwise(edges):
                if high - low > 1:
                    found.append((low + 1, high - low - 1))
        if self.highest + 1 < self.n_expected:
            found.append((self.highest + 1, self.n_expected - self.highest - 1))
        return found
