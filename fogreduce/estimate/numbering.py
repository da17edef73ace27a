"""Numbers for the records of a format that numbers none: in order, with holes where the stamps show them.

Records are worked on in pieces of a fixed size with their neighbours in view, so that results do not depend
on the blocks in which a reader hands them on. A step of the clock back (set anew, or wrapped) is taken out of
the stamps that follow, so that it is one interval long: records in order are good, whatever the clock did.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND
from fogreduce.datasets.block import RawBlock
from fogreduce.estimate.clock import STAMP_TOLERANCE_PULSES, STAMP_TOLERANCE_S, StampClock
from fogreduce.estimate.lead import median_of_nine, window_order

Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]

_PIECE = 16384
_NEIGHBOURS = 4096  # records in view on each side of a piece
_AROUND = 5  # records on each side of a step back that must lie on their side of it
_FIRST = 64  # records whose stamps tell where the record starts
_FEW = 0.05  # where more stamps or readings repeat, both the same do not mean the same record


@dataclass
class _Part:
    """Records that follow one another: stamps as they stand and without steps back, readings' digests."""

    stamp_us: Integers
    time_us: Integers
    digest: Integers

    def __len__(self) -> int:
        return int(self.stamp_us.size)

    def __getitem__(self, part: slice) -> _Part:
        return _Part(self.stamp_us[part], self.time_us[part], self.digest[part])

    def __add__(self, other: _Part) -> _Part:
        pairs = zip(vars(self).values(), vars(other).values(), strict=True)
        return _Part(*(np.concatenate(pair) for pair in pairs))


def _nothing() -> _Part:
    return _Part(*(np.empty(0, np.int64) for _ in range(3)))


@dataclass
class Numbering:
    """Numbers records block by block.

    Parameters
    ----------
    clock : StampClock
        Gathers what the stamps show of their clock.
    """

    clock: StampClock
    _behind: _Part = field(default_factory=_nothing)
    _behind_number: Integers = field(default_factory=lambda: np.empty(0, np.int64))
    _taken_out_us: int = 0
    _done: int = 0

    def blocks(self, raw: Iterator[RawBlock]) -> Iterator[tuple[RawBlock, Flags]]:
        """The same blocks with pulse numbers and mended stamps, and which stamps cannot be right."""
        waiting: list[RawBlock] = []
        ahead, done = _nothing(), _nothing()
        number, bad = np.empty(0, np.int64), np.empty(0, bool)
        more = True
        while more or waiting:
            block = next(raw, None) if more else None
            more = block is not None
            if block is not None:
                waiting.append(block)
                ahead += _Part(block.time_us, block.time_us, _digest(block))
            while len(ahead) >= _PIECE + _NEIGHBOURS or (not more and len(ahead)):
                piece, of_piece, bad_of_piece = self._number(ahead)
                ahead, done = ahead[len(piece) :], done + piece
                number, bad = np.concatenate((number, of_piece)), np.concatenate((bad, bad_of_piece))
            while waiting and waiting[0].time_us.size <= number.size:
                first = waiting.pop(0)
                size = first.time_us.size
                yield replace(first, time_us=done.time_us[:size], pulse=number[:size]), bad[:size]
                done, number, bad = done[size:], number[size:], bad[size:]

    def _number(self, ahead: _Part) -> tuple[_Part, Integers, Flags]:
        """The next piece of what lies ahead: its records, their numbers, and which stamps are wrong."""
        window = self._behind + ahead[: _PIECE + _NEIGHBOURS]
        first, size = len(self._behind), min(_PIECE, len(ahead))
        piece = slice(first, first + size)
        source = _sent_before(window)
        is_first = source < 0
        self._take_out_steps_back(window, first, size, is_first)
        resolution_us = int(np.gcd.reduce(np.diff(window.time_us))) if len(window) > 1 else 0
        rate = self.clock.stated_rate_hz
        to_samples = rate / MICROSECONDS_PER_SECOND
        place = (window.time_us[is_first] - window.time_us[0]) * to_samples
        order = window_order(place, resolution_us * to_samples)
        number = np.empty(len(window), np.int64)
        number[is_first] = order.number
        number[~is_first] = number[source[~is_first]]
        number += self._anchor(number, window, order.interval)
        wrong = np.zeros(len(window), bool)
        wrong[is_first] = _wrong_stamps(order.off, max(STAMP_TOLERANCE_PULSES, STAMP_TOLERANCE_S * rate))
        off = np.zeros(len(window))
        off[is_first] = order.off
        good = piece.start + np.flatnonzero((is_first & ~wrong)[piece])
        self.clock.add(number[good], window.time_us[good], off[good] * order.interval / rate, resolution_us)
        self.clock.doubled += _doubled(window, is_first, piece)
        self._behind = window[max(0, piece.stop - _NEIGHBOURS) : piece.stop]
        self._behind_number = number[max(0, piece.stop - _NEIGHBOURS) : piece.stop]
        self._done += size
        return window[piece], number[piece], wrong[piece]

    def _anchor(self, number: Integers, window: _Part, interval: float) -> int:
        """What makes a window's numbers those of the run."""
        behind = self._behind_number
        if behind.size == 0:
            return _first_number(number, window.time_us, self.clock.stated_rate_hz, interval)
        shift = int(np.median(behind[-9:] - number[: behind.size][-9:]))
        following = number[behind.size :] + shift
        if (
            np.isin(following, behind).any()
            and not np.isin(number[behind.size :], number[: behind.size]).any()
        ):
            shift += int(behind.max()) + 1 - int(following.min())
        return shift

    def _take_out_steps_back(self, window: _Part, first: int, size: int, is_first: Flags) -> None:
        """Move the stamps that follow a step back, in place; remember what was taken out of this piece's."""
        window.time_us[first:] += self._taken_out_us
        index = np.flatnonzero(is_first)
        time = window.time_us[index]
        step = np.diff(time)
        rate = self.clock.stated_rate_hz
        least = MICROSECONDS_PER_SECOND * max(STAMP_TOLERANCE_S, STAMP_TOLERANCE_PULSES / rate)
        usual = int(np.median(step[step > 0])) if (step > 0).any() else round(MICROSECONDS_PER_SECOND / rate)
        for k in (np.flatnonzero(step < -least) + 1).tolist():
            before, after = time[max(k - _AROUND, 0) : k], time[k : k + _AROUND]
            back = int(time[k - 1] - time[k])
            if min(before.size, after.size) < 3 or np.median(after) > np.median(before) - least or back <= 0:
                continue  # single stamps that are wrong
            moved = back + usual
            time[k:] += moved
            at = int(index[k])
            if at < first:
                continue
            window.time_us[at:] += moved
            if at < first + size:
                self._taken_out_us += moved
                self.clock.steps_back.append(
                    (self.clock.records + at - first, moved / MICROSECONDS_PER_SECOND)
                )


def _first_number(number: Integers, time_us: Integers, rate_hz: float, interval: float) -> int:
    """The number from which a record counts: 0 where its first stamps allow it."""
    place = time_us[:_FIRST] * (rate_hz / MICROSECONDS_PER_SECOND)
    lead = place / interval - number[:_FIRST] if interval > 0 else place - number[:_FIRST]
    scatter = float(np.ptp(lead))
    if lead.min() - 0.5 <= scatter and lead.max() + 0.5 >= -scatter:
        return -int(min(number[:_FIRST].min(), 0))
    return round(float(np.median(lead)))


def _wrong_stamps(off: NDArray[np.float64], tolerance: float) -> Flags:
    """Stamps far from those around them, by more than the scatter that is usual here."""
    if np.ptp(off) <= tolerance:
        return np.zeros(off.size, bool)
    calm = median_of_nine(off)
    for end in (slice(_AROUND - 1), slice(1 - _AROUND, None)):
        calm[end] = np.median(off[: 2 * _AROUND - 1] if end.start is None else off[1 - 2 * _AROUND :])
    wrong: Flags = np.abs(off - calm) > max(tolerance, float(np.ptp(calm)))
    return wrong


def _sent_before(window: _Part) -> Integers:
    """Index of the same record, stamp and readings, where it stood before; -1 where it did not."""
    source = np.full(len(window), -1, np.int64)
    not_later = np.count_nonzero(np.diff(window.stamp_us) <= 0)
    if not 0 < not_later <= max(3, _FEW * len(window)):
        return source
    keys = np.stack((window.stamp_us, window.digest), axis=1)
    _, where, inverse = np.unique(keys, axis=0, return_index=True, return_inverse=True)
    first = where[inverse.ravel()]
    again = first < np.arange(len(window))
    # Readings that hardly change do not tell records apart.
    if np.unique(window.digest).size > (1 - _FEW) * (len(window) - np.count_nonzero(again)):
        source[again] = first[again]
    return source


def _doubled(window: _Part, is_first: Flags, piece: slice) -> int:
    """Records of a piece whose stamp is that of the record before, though they are others."""
    index = np.flatnonzero(is_first)
    same = index[1:][np.diff(window.time_us[index]) == 0]
    return int(np.count_nonzero((same >= piece.start) & (same < piece.stop)))


def _digest(block: RawBlock) -> Integers:
    """A number that differs where readings do."""
    readings = block.counts if block.counts is not None else block.values
    assert readings is not None
    if readings.dtype == np.int32:
        bits = readings.astype(np.int64)
    else:
        bits = np.ascontiguousarray(readings, np.float64).view(np.int64)
    with np.errstate(over="ignore"):
        factors = 6364136223846793005 * np.arange(1, 2 * len(bits) + 1, 2, dtype=np.int64)  # Knuth's MMIX
        digest: Integers = (bits * factors[:, None]).sum(axis=0)
    return digest
