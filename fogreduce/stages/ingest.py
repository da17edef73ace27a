"""Stage 1, ingest: records as they stand in the capture, each checked and flagged, none dropped."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import chain
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND, MISSING_COUNT
from fogreduce.datasets.block import Block, RawBlock
from fogreduce.datasets.flags import UNUSABLE_AXES, UNUSABLE_RECORD, GyroFlag, RecordFlag, record_flags
from fogreduce.datasets.readers import Reader
from fogreduce.errors import BadInput
from fogreduce.estimate.constant import ConstantSearch
from fogreduce.estimate.numbering import Numbering
from fogreduce.estimate.outliers import CONTEXT, OutlierSearch
from fogreduce.estimate.sample_interval import sample_interval_s
from fogreduce.estimate.sequence import SequenceCheck
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.noise import white_sigma
from fogreduce.physics.quantization import raw_from_counts
from fogreduce.physics.raw_quantity import rate_from_increment
from fogreduce.plausibility.epoch import epoch_in_words
from fogreduce.stages.settling import Settling

NAME = "ingest"

_PLACES = 20  # how many of each kind of fault are located in the report; the dataset's flags have them all
_FEWEST = 5  # usable records that a run must have: one more than the mean curve has coefficients
_FLOOR = 0.5  # of the stated white noise: no outlier search takes a gyro to be quieter

#: Record flags that repeat what a gyro's flag says.
_SAID_BY_GYROS = (RecordFlag.MISSING_GYRO, RecordFlag.SPURIOUS_GYRO, RecordFlag.CONSTANT_GYRO)
#: Kinds that stand at the end of the report and of the table, in which kinds are only ever added there.
_AT_THE_END = (RecordFlag.ACCELERATING, GyroFlag.CONSTANT)

Values = NDArray[Any]


@dataclass(frozen=True)
class _Prepared:
    """A block with pulse numbers, ready to be checked.

    `wrong_stamps`: which cannot be right, where they made the numbers. `filled`: counts or readings, those
    missing replaced by a neighbour. `missing`: None where all are there.
    """

    raw: RawBlock
    wrong_stamps: NDArray[np.bool_] | None
    filled: Values
    missing: NDArray[np.bool_] | None


@dataclass
class Ingest:
    """Judges a capture's records, block by block.

    Parameters
    ----------
    facts : RunFacts
    threshold_sigma : float
        For spurious counts, see `OutlierSearch`.
    """

    facts: RunFacts
    threshold_sigma: float
    records: int = 0
    _interval_s: float | None = None  # of angle increments
    _places: dict[str, list[dict[str, object]]] = field(default_factory=dict)
    _counts: dict[str, int] = field(default_factory=dict)

    def __post_init__(self) -> None:
        facts = self.facts
        self._settling = Settling(facts)
        self._constant = ConstantSearch(facts.n_gyros, facts.sample_rate_hz)
        self._usable = np.zeros(facts.n_gyros, np.int64)
        self._usable_by_axes = 0
        self._first_us: int | None = None
        self._sequence = self._sequence_check(numbered=True)

    def _sequence_check(self, *, numbered: bool) -> SequenceCheck:
        facts = self.facts
        end_us = facts.profile.end_s * MICROSECONDS_PER_SECOND
        return SequenceCheck(facts.sample_rate_hz, facts.n_expected, end_us, numbered)

    def blocks(self, reader: Reader, size: int) -> Iterator[Block]:
        """The capture's records with their flags, `size` at a time."""
        checked = ((self._in_use(raw), wrong) for raw, wrong in self._numbered(reader.blocks(size)))
        before: Values | None = None
        current = self._prepared(next(checked, None))
        search = None
        while current is not None:
            search = search or OutlierSearch(
                self.threshold_sigma, self._floor(current.raw.counts is not None)
            )
            following = self._prepared(next(checked, None))
            after = None if following is None else following.filled[:, :CONTEXT]
            spurious = search.flags(before, current.filled, after)
            constant = self._constant.flags(
                current.filled,
                None if following is None else following.filled,
                partial(self._segments, current, following),
            )
            yield self._block(reader, current, following, spurious, constant)
            before = current.filled[:, -CONTEXT:]
            current = following
        self._refuse_unusable(reader)

    def _numbered(self, raw: Iterator[RawBlock]) -> Iterator[tuple[RawBlock, NDArray[np.bool_] | None]]:
        """Blocks with pulse numbers; and which stamps cannot be right, where they made the numbers."""
        first = next(raw, None)
        if first is None:
            return
        if first.pulse is not None:
            yield first, None
            yield from ((block, None) for block in raw)
            return
        self._sequence = self._sequence_check(numbered=False)
        yield from Numbering(self._sequence.clock).blocks(chain((first,), raw))

    @property
    def least_count(self) -> float:
        """What one count stands for, or the least step of a reading, by the samples' interval [raw unit]."""
        if self._interval_s is None:
            return self.facts.least_count
        return self.facts.capture_least_count / self._interval_s

    def _in_use(self, raw: RawBlock) -> RawBlock:
        """Readings in the raw unit in use: angle increments become rates, by the first block's interval."""
        if not self.facts.is_increment:
            return raw
        if self._interval_s is None:
            assert raw.pulse is not None
            self._interval_s = sample_interval_s(raw.pulse, raw.time_us, self.facts.sample_rate_hz)
        increment = raw.values
        if raw.counts is not None:
            increment = raw_from_counts(raw.counts, self.facts.capture_least_count)
        assert increment is not None
        return replace(raw, counts=None, values=rate_from_increment(increment, self._interval_s))

    def _prepared(self, checked: tuple[RawBlock, NDArray[np.bool_] | None] | None) -> _Prepared | None:
        """A block with missing values filled from their neighbours."""
        if checked is None:
            return None
        raw, wrong = checked
        values = _captured(raw)
        missing = values == MISSING_COUNT if raw.counts is not None else np.isnan(values)
        if not missing.any():
            return _Prepared(raw, wrong, values, None)
        return _Prepared(raw, wrong, _filled(values, missing), missing)

    def _segments(self, current: _Prepared, following: _Prepared | None) -> NDArray[np.intp]:
        """Segment of the profile in which each record of two blocks lies."""
        times = [block.raw.time_us for block in (current, following) if block is not None]
        return self.facts.profile.segment_at(np.concatenate(times) / MICROSECONDS_PER_SECOND)

    def _readings(self, counts_or_readings: Values, raw: RawBlock) -> NDArray[np.float64]:
        """Values of a block in the raw unit in use."""
        if raw.counts is None:
            return counts_or_readings
        return raw_from_counts(counts_or_readings, self.facts.least_count)

    def _floor(self, has_counts: bool) -> NDArray[np.float64]:
        """Least noise of each gyro, in counts or raw units."""
        quantum = self.facts.least_count
        floor = np.full(self.facts.n_gyros, quantum)
        if self.facts.white_noise is not None:
            stated = white_sigma(self.facts.white_noise, self.facts.sample_rate_hz)
            floor = np.maximum(floor, _FLOOR * stated * np.abs(self.facts.scale_factor))
        return floor / quantum if has_counts else floor

    def _block(
        self,
        reader: Reader,
        current: _Prepared,
        following: _Prepared | None,
        spurious: NDArray[np.bool_],
        constant: NDArray[np.bool_] | None,
    ) -> Block:
        raw, missing = current.raw, current.missing
        assert raw.pulse is not None
        gyro_flag = np.zeros(spurious.shape, np.uint8)
        if constant is not None:
            gyro_flag[constant] = GyroFlag.CONSTANT
        if spurious.any():
            gyro_flag[spurious] = GyroFlag.SPURIOUS
        if missing is not None:
            gyro_flag[missing] = GyroFlag.MISSING
        flag = record_flags(self._sequence.flags(raw.time_us, raw.pulse, current.wrong_stamps), gyro_flag)
        values = self._readings(_captured(raw), raw)
        self._flag_accelerating(flag, current, following, values)
        self.records += raw.time_us.size
        if flag.any():
            self._note(reader, raw, flag, gyro_flag)
        usable = usable_gyros(flag, gyro_flag)
        self._usable += raw.time_us.size if usable is None else np.count_nonzero(usable, axis=1)
        self._usable_by_axes += raw.time_us.size - int(np.count_nonzero(flag & UNUSABLE_AXES))
        self._first_us = int(raw.time_us[0]) if self._first_us is None else self._first_us
        self._last_us = int(raw.time_us[-1])
        return Block(raw.start, raw.time_us, raw.pulse, flag, gyro_flag, raw.counts, values)

    def _flag_accelerating(
        self,
        flag: NDArray[np.uint8],
        current: _Prepared,
        following: _Prepared | None,
        values: NDArray[np.float64],
    ) -> None:
        """Flag the records after an edge of the profile in which the table still changes its rate."""
        if not self._settling.wanted(current.raw.time_us):
            return
        after = None
        if following is not None:
            after = following.raw.time_us, self._readings(following.filled, following.raw)
        filled = values if current.missing is None else self._readings(current.filled, current.raw)
        moving = self._settling.flags(current.raw.time_us, filled, after)
        if moving is not None:
            flag[moving & ((flag & UNUSABLE_RECORD) == 0)] |= np.uint8(RecordFlag.ACCELERATING)

    def _note(
        self, reader: Reader, raw: RawBlock, flag: NDArray[np.uint8], gyro_flag: NDArray[np.uint8]
    ) -> None:
        odd = np.flatnonzero(flag)
        for kind in RecordFlag:
            if kind not in _SAID_BY_GYROS:
                self._add(str(kind.name).lower(), odd[(flag[odd] & kind) != 0], reader, raw)
        for gyro, flags in enumerate(gyro_flag[:, odd]):
            for gyro_kind in GyroFlag:
                name = f"{str(gyro_kind.name).lower()}_gyro{gyro + 1}"
                self._add(name, odd[(flags & gyro_kind) != 0], reader, raw)

    def _add(self, name: str, found: NDArray[np.intp], reader: Reader, raw: RawBlock) -> None:
        if found.size == 0:
            return
        self._counts[name] = self._counts.get(name, 0) + int(found.size)
        places = self._places.setdefault(name, [])
        for index in found[: _PLACES - len(places)].tolist():
            record = raw.start + index
            places.append(
                {
                    "record": record,
                    "place": reader.place(record),
                    "pulse": int(raw.pulse[index]) if raw.pulse is not None else None,
                    "time_s": int(raw.time_us[index]) / 1e6,
                }
            )

    def _refuse_unusable(self, reader: Reader) -> None:
        """A record that leaves no estimate of any gyro is refused: no usable data is no health."""
        most = int(self._usable.max(initial=0))
        if most >= min(_FEWEST, self.facts.n_expected):
            return
        path, end_s = reader.path, self.facts.profile.end_s
        if self._first_us is None:
            raise BadInput.at(path, "", found="no record", expected="at least one")
        first_s, last_s = (us / MICROSECONDS_PER_SECOND for us in (self._first_us, self._last_us))
        bad, beyond = (self._counts.get(kind, 0) for kind in ("bad_stamp", "beyond_profile"))
        if max(bad, beyond) > self.records // 2:
            found = f"stamps from {first_s:.10g} to {last_s:.10g} s"
            if epoch := epoch_in_words(first_s, self.facts.start_us):
                found += f" ({epoch})"
            if bad > beyond:
                found += ", which disagree with the records' numbers"
            expected = f"0 to {end_s:g} s, as table.profile says"
            if not self._sequence.numbered:
                expected += "; capture.time_zero takes an epoch away"
            raise BadInput.at(path, "time stamps", found=found, expected=expected)
        kinds = [f"{count} {kind}" for kind, count in self._counts.items()]
        found = f"{most} usable of {self.records} records" + (f" ({', '.join(kinds)})" if kinds else "")
        raise BadInput.at(path, "", found=found, expected=f"at least {_FEWEST} usable records")

    def report(self, reader: Reader) -> dict[str, Any]:
        """Counts and places of all that is out of the ordinary (the first 20 places of each kind)."""
        record_kinds = [kind for kind in RecordFlag if kind not in _SAID_BY_GYROS]
        gyro_kinds = [(kind, gyro + 1) for gyro in range(self.facts.n_gyros) for kind in GyroFlag]
        kinds = [
            *(_name(kind) for kind in record_kinds if kind not in _AT_THE_END),
            *(f"{_name(kind)}_gyro{gyro}" for kind, gyro in gyro_kinds if kind not in _AT_THE_END),
            *(_name(kind) for kind in record_kinds if kind in _AT_THE_END),
            *(f"{_name(kind)}_gyro{gyro}" for kind, gyro in gyro_kinds if kind in _AT_THE_END),
        ]
        holes = self._sequence.holes()
        assert self._first_us is not None
        return {
            "records": self.records,
            "expected": self.facts.n_expected,
            "lost": self._sequence.lost(),
            "torn_bytes": reader.torn_bytes,
            "torn_at": reader.place(reader.n_records) if reader.torn_bytes else None,
            "flagged": {kind: self._counts.get(kind, 0) for kind in kinds},
            "lost_places": [{"first_pulse": first, "pulses": pulses} for first, pulses in holes[:_PLACES]],
            "places": self._places,
            "usable": {"gyros": self._usable.tolist(), "axes": self._usable_by_axes},
            "clock": self._clock(),
            "repeated_readings": [None if math.isnan(x) else x for x in self._constant.repeated.tolist()],
            "settling_s": {str(segment): found for segment, found in self._settling.found.items()},
        }

    def set_back_s(self, block: Block) -> NDArray[np.float64]:
        """By how much the clock had been set back at each record of a block [s], taken out of its stamps."""
        record = block.start + np.arange(block.time_us.size)
        back = np.zeros(record.size)
        for first, seconds in self._sequence.clock.steps_back:
            back[record >= first] += seconds
        return back

    def _clock(self) -> dict[str, object]:
        """What the stamps show of their clock."""
        clock = self._sequence.clock
        assert self._first_us is not None
        determined = not math.isnan(clock.rate_hz)
        return {
            "numbered_by": "capture" if self._sequence.numbered else "ingest",
            "first_s": self._first_us / MICROSECONDS_PER_SECOND,
            "last_s": self._last_us / MICROSECONDS_PER_SECOND,
            "stated_rate_hz": clock.stated_rate_hz,
            # stamps are whole microseconds: what is below them is rounding of the sums
            "rate_hz": float(f"{clock.rate_hz:.10g}") if determined else None,
            "rate_ppm": round(clock.rate_ppm, 3) + 0.0 if determined else None,
            "jitter_s": round(clock.jitter_s, 8) if determined else None,
            "largest_jitter_s": round(clock.largest_jitter_s, 8),
            "resolution_us": clock.resolution_us,
            "doubled_stamps": clock.doubled,
            "steps_back": [
                {"record": record, "seconds": seconds} for record, seconds in clock.steps_back[:_PLACES]
            ],
        }


def _name(kind: RecordFlag | GyroFlag) -> str:
    return str(kind.name).lower()


def _captured(raw: RawBlock) -> Values:
    """A block's counts or readings, whichever it holds."""
    values = raw.counts if raw.counts is not None else raw.values
    assert values is not None
    return values


def _filled(values: Values, missing: NDArray[np.bool_]) -> Values:
    """Missing values replaced by the one before (the first ones by the first that is there, or 0)."""
    filled = values.copy()
    for gyro in np.flatnonzero(missing.any(axis=1)):
        gaps, there = np.flatnonzero(missing[gyro]), np.flatnonzero(~missing[gyro])
        if there.size:
            before = np.maximum(np.searchsorted(there, gaps) - 1, 0)
            filled[gyro, gaps] = values[gyro, there[before]]
        else:
            filled[gyro] = 0
    return filled


def usable_gyros(flag: NDArray[np.uint8], gyro_flag: NDArray[np.uint8]) -> NDArray[np.bool_] | None:
    """Which samples of each gyro count in estimates, (n, N); None = all."""
    if not flag.any():
        return None
    return (gyro_flag == 0) & ((flag & UNUSABLE_RECORD) == 0)
