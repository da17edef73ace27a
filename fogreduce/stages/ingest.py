"""Stage 1, ingest: records as they stand in the capture, each judged and flagged, none dropped."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MISSING_COUNT
from fogreduce.datasets.block import Block, RawBlock
from fogreduce.datasets.flags import UNUSABLE_RECORD, GyroFlag, RecordFlag, record_flags
from fogreduce.datasets.readers import Reader
from fogreduce.estimate.outliers import CONTEXT, OutlierSearch
from fogreduce.estimate.sample_interval import sample_interval_s
from fogreduce.estimate.sequence import SequenceCheck
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.quantization import raw_from_counts
from fogreduce.physics.raw_quantity import rate_from_increment

NAME = "ingest"

_PLACES = 20  # how many of each kind of fault are located in the report; the dataset's flags have them all
_FLOOR = 0.5  # of the stated white noise: no outlier search takes a gyro to be quieter

#: Record flags that repeat what a gyro's flag says.
_SAID_BY_GYROS = (RecordFlag.MISSING_GYRO, RecordFlag.SPURIOUS_GYRO)

Values = NDArray[Any]


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
        self._sequence = SequenceCheck(self.facts.sample_rate_hz, self.facts.n_expected)

    def blocks(self, reader: Reader, size: int) -> Iterator[Block]:
        """The capture's records with their flags, `size` at a time."""
        raw = map(self._in_use, reader.blocks(size))
        before: Values | None = None
        current = next(raw, None)
        values = None if current is None else self._prepared(current)
        search = None
        while current is not None and values is not None:
            search = search or OutlierSearch(self.threshold_sigma, self._floor(current.counts is not None))
            following = next(raw, None)
            following_values = None if following is None else self._prepared(following)
            after = None if following_values is None else following_values[0][:, :CONTEXT]
            filled, missing = values
            spurious = search.flags(before, filled, after)
            yield self._block(reader, current, missing, spurious)
            before = filled[:, -CONTEXT:]
            current, values = following, following_values

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
            self._interval_s = sample_interval_s(raw.pulse, raw.time_us, self.facts.sample_rate_hz)
        increment = raw.values
        if raw.counts is not None:
            increment = raw_from_counts(raw.counts, self.facts.capture_least_count)
        assert increment is not None
        return replace(raw, counts=None, values=rate_from_increment(increment, self._interval_s))

    def _prepared(self, raw: RawBlock) -> tuple[Values, NDArray[np.bool_] | None]:
        """Values with the missing ones filled from their neighbours, and which were missing (None: none)."""
        values: Values
        if raw.counts is not None:
            values, missing = raw.counts, raw.counts == MISSING_COUNT
        else:
            assert raw.values is not None
            values, missing = raw.values, np.isnan(raw.values)
        if not missing.any():
            return values, None
        return _filled(values, missing), missing

    def _floor(self, has_counts: bool) -> NDArray[np.float64]:
        """Least noise of each gyro, in counts or raw units."""
        quantum = self.facts.least_count
        floor = np.full(self.facts.n_gyros, quantum)
        if self.facts.white_noise is not None:
            stated = self.facts.white_noise / 60 * np.sqrt(self.facts.sample_rate_hz)
            floor = np.maximum(floor, _FLOOR * stated * np.abs(self.facts.scale_factor))
        return floor / quantum if has_counts else floor

    def _block(
        self,
        reader: Reader,
        raw: RawBlock,
        missing: NDArray[np.bool_] | None,
        spurious: NDArray[np.bool_],
    ) -> Block:
        gyro_flag = np.zeros(spurious.shape, np.uint8)
        if spurious.any():
            gyro_flag[spurious] = GyroFlag.SPURIOUS
        if missing is not None:
            gyro_flag[missing] = GyroFlag.MISSING
        flag = record_flags(self._sequence.flags(raw.time_us, raw.pulse), gyro_flag)
        self.records += raw.time_us.size
        if flag.any():
            self._note(reader, raw, flag, gyro_flag)
        if raw.counts is not None:
            values = raw_from_counts(raw.counts, self.facts.least_count)
        else:
            assert raw.values is not None
            values = raw.values
        return Block(raw.start, raw.time_us, raw.pulse, flag, gyro_flag, raw.counts, values)

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
                    "pulse": int(raw.pulse[index]),
                    "time_s": int(raw.time_us[index]) / 1e6,
                }
            )

    def report(self, reader: Reader) -> dict[str, object]:
        """Counts and places of all that is out of the ordinary (the first 20 places of each kind)."""
        kinds = [str(kind.name).lower() for kind in RecordFlag if kind not in _SAID_BY_GYROS]
        for gyro in range(self.facts.n_gyros):
            kinds += [f"{str(kind.name).lower()}_gyro{gyro + 1}" for kind in GyroFlag]
        holes = self._sequence.holes()
        return {
            "records": self.records,
            "expected": self.facts.n_expected,
            "lost": self._sequence.lost(),
            "torn_bytes": reader.torn_bytes,
            "torn_at": reader.place(reader.n_records) if reader.torn_bytes else None,
            "flagged": {kind: self._counts.get(kind, 0) for kind in kinds},
            "lost_places": [{"first_pulse": first, "pulses": pulses} for first, pulses in holes[:_PLACES]],
            "places": self._places,
        }


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
