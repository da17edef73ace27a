"""What all formats that hold columns share: which column is what, stamps, gaps, and logs inside a capture.

A format is a small class beside this one: it lists its columns and yields them in chunks.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND
from fogreduce.datasets.block import RawBlock
from fogreduce.datasets.readers.facts import CaptureFacts
from fogreduce.datasets.readers.times import NO_STAMP, Clock
from fogreduce.errors import BadInput

Chunk = list[NDArray[Any]]

#: Columns named in a message.
_SHOWN = 12


class ColumnsReader:
    """A capture of columns; attributes and methods as those of `fogreduce.datasets.readers.Reader`.

    A format overrides `_open`, `_chunks` and, where its records have places, `place`.

    Parameters
    ----------
    path : Path
    capture : mapping
        The `capture` block of run.yaml, validated plain data.
    start_us : int
        The run's start, microseconds since 1970-01-01T00:00:00Z.

    Attributes
    ----------
    names : sequence of str
        The columns'.
    units : dict
        Units that the file states beside the names, by name.
    sample_rate_hz, first_us : float, int or None
        Sample rate and instant of the first record (microseconds since 1970), where the file states them.
    """

    def __init__(self, path: Path, capture: Mapping[str, Any], start_us: int) -> None:
        self.path = path
        self.capture = capture
        self.torn_bytes = 0
        self.n_records = 0
        self.sample_rate_hz: float | None = None
        self.units: dict[str, str] = {}
        self.first_us: int | None = None
        self._start_us = start_us
        self.names: Sequence[str] = self._open()
        if self.n_records == 0:
            raise BadInput.at(path, self.place(0), found="no record", expected="at least one record")
        columns = capture.get("columns") or {}
        self._gyros = [self._index(name, f"columns.gyros[{k}]") for k, name in enumerate(columns["gyros"])]
        time = columns.get("time")
        self._time = None if time is None else self._index(time, "columns.time")
        self.facts = CaptureFacts(len(self._gyros), sample_rate_hz=self.sample_rate_hz)

    # ------------------------------------------------------------------------------ what a format adds

    def _open(self) -> Sequence[str]:
        """Look into the file: the columns' names; sets `n_records`."""
        raise NotImplementedError

    def _chunks(self, columns: Sequence[int], size: int) -> Iterator[Chunk]:
        """The chosen columns, `size` records at a time."""
        raise NotImplementedError

    def place(self, record: int) -> str:
        """Where a record lies in the file, for a message."""
        return f"record {record + 1}"

    # ------------------------------------------------------------------------------------- what it has

    def blocks(self, size: int) -> Iterator[RawBlock]:
        """The records in file order, `size` at a time."""
        chosen = self._gyros if self._time is None else [*self._gyros, self._time]
        for start, time_us, values in self._stamped(chosen, size):
            # A capture without stamps says nothing of lost records: they are numbered as they come.
            pulse = np.arange(start, start + time_us.size) if self._time is None else None
            yield RawBlock(start, time_us, pulse, None, np.ascontiguousarray(values))

    def log_columns(self, names: Sequence[str], size: int) -> Iterator[tuple[NDArray[np.int64], Any]]:
        """Stamps [us] (N,) and the columns that serve as logs (k, N), named by their keys in `columns`."""
        columns = self.capture["columns"]
        chosen = [self._index(columns[name], f"columns.{name}") for name in names]
        chosen = chosen if self._time is None else [*chosen, self._time]
        for _, time_us, values in self._stamped(chosen, size):
            yield time_us, values

    def first_values(self, column: str | int, count: int) -> NDArray[Any]:
        """The first values of a column, as they stand there."""
        return next(iter(self._chunks([self._index(column, "columns")], count)))[0][:count]

    def _stamped(
        self, chosen: Sequence[int], size: int
    ) -> Iterator[tuple[int, NDArray[np.int64], NDArray[np.float64]]]:
        """First record, stamps, and the columns but the time, (k, N)."""
        clock = Clock(self.capture, self._start_us)
        start = 0
        for chunk in self._chunks(chosen, size):
            count = len(chunk[0])
            if self._time is None:
                rate = float(self.capture["sample_rate_hz"])
                time_us = np.rint(np.arange(start, start + count) * (MICROSECONDS_PER_SECOND / rate))
                time_us = time_us.astype(np.int64)
            else:
                chunk, times = chunk[:-1], chunk[-1]
                time_us = clock.stamps_us(times)
                self._check_stamps(start, times, time_us)
            yield start, time_us, self._numbers(start, chunk, chosen)
            start += count
        if start != self.n_records:
            expected = f"{self.n_records} records, as there were when it was opened"
            raise BadInput.at(self.path, "", found=f"{start} records", expected=expected)

    def _check_stamps(self, start: int, times: NDArray[Any], time_us: NDArray[np.int64]) -> None:
        wrong = time_us == NO_STAMP
        if wrong.any():
            k = int(np.argmax(wrong))
            raise BadInput.at(
                self.path,
                self.place(start + k),
                found=f"time {times[k]!s}"[:80],
                expected=self._record(),
            )

    def _numbers(self, start: int, chunk: Chunk, chosen: Sequence[int]) -> NDArray[np.float64]:
        """Columns as double precision numbers, (k, N); infinity is no reading."""
        values = np.empty((len(chunk), len(chunk[0])))
        for k, column in enumerate(chunk):
            if column.dtype.kind not in "fiub":
                name = self.names[chosen[k]]
                found = f"column {name} of type {column.dtype}"
                raise BadInput.at(self.path, "", found=found, expected="numbers")
            values[k] = column
        infinite = np.isinf(values).any(axis=0)
        if infinite.any():
            k = int(np.argmax(infinite))
            place = self.place(start + k)
            raise BadInput.at(self.path, place, found="infinity", expected=self._record())
        return values

    def _record(self) -> str:
        """What a record is, for a message."""
        readings = f"{len(self._gyros)} readings (finite numbers, or none for no answer)"
        if self._time is None:
            return readings
        unit = (self.capture.get("time") or {}).get("unit", "s")
        return f"a time [{unit}] and {readings}"

    def _index(self, column: str | int, key: str) -> int:
        """Where a column stands, by its name or by its number from 1."""
        names = list(self.names)
        if isinstance(column, int):
            if 1 <= column <= len(names):
                return column - 1
            expected = f"a number from 1 to {len(names)}"
        else:
            found = [k for k, name in enumerate(names) if name == column]
            if len(found) == 1:
                return found[0]
            shown = ", ".join(names[:_SHOWN]) + (", ..." if len(names) > _SHOWN else "")
            expected = (
                f"one of the columns {shown}" if not found else "its number, since the name stands twice"
            )
        run_yaml = self.path.parent / "run.yaml"
        raise BadInput.at(
            run_yaml, f"capture.{key}", found=column, expected=f"{expected} of {self.path.name}"
        )


def needs(module: str, extra: str, path: Path) -> Any:
    """A library that comes with an extra of the package; BadInput names the extra where it is not there."""
    try:
        return importlib.import_module(module)
    except ImportError:
        expected = f"the library {module}: pip install 'fogreduce[{extra}]'"
        raise BadInput.at(path, "", found=f"a file that needs {module}", expected=expected) from None
