"""Captures of format `csv-1`: a header line ``time_s,gyro1_V,...,gyroN_V``, then a record a line.

Readings in another unit than volts have its name in place of V: ``gyro1_deg_s``.
An empty field is "no answer". Records are not numbered: a record's pulse number is its time times the
sample rate, rounded, so that a lost line leaves a hole as a lost record does; but where a time is far ahead
of those around it the pulse number goes by these, so that the stamp is found to be wrong.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND
from fogreduce.datasets.block import RawBlock
from fogreduce.datasets.readers.facts import CaptureFacts
from fogreduce.errors import BadInput
from fogreduce.estimate.outliers import isolated
from fogreduce.physics.raw_quantity import RAW_UNITS, RawUnitName, suffix_of

FORMAT = "csv-1"
_COUNT_BYTES = 1 << 20
_APART_PULSES, _APART_S = 8, 0.05  # as `fogreduce.estimate.sequence` tells a wrong stamp
_LATEST_S = 1e9  # thirty years; beyond it a time stamp is surely not seconds since the start


def read_columns(path: Path) -> tuple[int, RawUnitName]:
    """Number of gyros and unit of readings from the header line; BadInput where it is not one of `csv-1`."""
    try:
        with path.open("rb") as file:
            line = file.readline(1 << 16).decode("utf-8")
    except OSError as error:
        raise BadInput.at(path, "", found=error.strerror, expected="a readable CSV file") from None
    except UnicodeDecodeError:
        raise BadInput.at(path, "line 1", found="bytes that are not UTF-8", expected="text") from None
    if not line:
        raise BadInput.at(path, "", found="an empty file", expected=f"a {FORMAT} capture")
    names = line.rstrip("\r\n").split(",")
    for unit in RAW_UNITS:
        if len(names) > 1 and names == column_names(len(names) - 1, unit):
            return len(names) - 1, unit
    raise BadInput.at(path, "line 1", found=line.strip()[:80], expected="time_s,gyro1_V,...,gyroN_V")


def column_names(n: int, unit: RawUnitName) -> list[str]:
    """The header line's names, for n gyros read in a unit."""
    return ["time_s", *(f"gyro{i}_{suffix_of(unit)}" for i in range(1, n + 1))]


class CsvReader:
    """A CSV capture, read in blocks; attributes as those of `FogcapReader`."""

    def __init__(self, path: Path, sample_rate_hz: float) -> None:
        self.path = path
        n, raw_unit = read_columns(path)
        self.facts = CaptureFacts(n, raw_unit=raw_unit)
        self.n_records, self.torn_bytes, commas = self._count_lines()
        self._rate = sample_rate_hz
        if self.n_records == 0:
            raise BadInput.at(path, "line 2", found="no record", expected="at least one record")
        if commas != (self.n_records + 1) * self.facts.n_gyros:
            self._blame(0)  # a line cut short, which would else read as gyros that did not answer

    def _count_lines(self) -> tuple[int, int, int]:
        """Records; bytes of a torn last line (too few fields and no line end); commas of the rest."""
        lines, commas, last = 0, 0, b""
        with self.path.open("rb") as file:
            while chunk := file.read(_COUNT_BYTES):
                lines += chunk.count(b"\n")
                commas += chunk.count(b",")
                last = (last + chunk).rsplit(b"\n", 1)[-1][-4096:]
        if not last:
            return lines - 1, 0, commas
        if last.count(b",") < self.facts.n_gyros:
            return lines - 1, len(last), commas - last.count(b",")
        return lines, 0, commas

    def place(self, record: int) -> str:
        """The record's line in the file."""
        return f"line {record + 2}"

    def blocks(self, size: int) -> Iterator[RawBlock]:
        """The records in file order, `size` at a time."""
        from pandas import read_csv  # costs a third of a second: only who reads CSV pays
        from pandas.errors import ParserError

        start = 0
        try:
            frames = read_csv(
                self.path,
                dtype=np.float64,
                chunksize=size,
                nrows=self.n_records,
                keep_default_na=False,
                na_values=[""],
                skip_blank_lines=False,
                encoding="utf-8",
                index_col=False,
            )
            for frame in frames:
                values = frame.to_numpy().T
                time_s = values[0]
                bad = ~(np.abs(time_s) <= _LATEST_S) | np.isinf(values).any(axis=0)
                if bad.any():
                    self._blame(start + int(np.argmax(bad)))
                time_us = np.rint(time_s * MICROSECONDS_PER_SECOND).astype(np.int64)
                yield RawBlock(
                    start=start,
                    time_us=time_us,
                    pulse=self._pulses(time_s),
                    counts=None,
                    values=np.ascontiguousarray(values[1:]),
                )
                start += time_us.size
        except (ValueError, ParserError):
            self._blame(start)
            raise

    def _pulses(self, time_s: NDArray[np.float64]) -> NDArray[np.int64]:
        """Pulse numbers: a time ahead of all around it is a wrong stamp, not a later pulse."""
        pulse: NDArray[np.int64] = np.rint(time_s * self._rate).astype(np.int64)
        index = np.arange(pulse.size)
        lead = pulse - index  # steps down at repeated lines and up at lost ones
        wrong = np.flatnonzero(isolated(lead, max(_APART_PULSES, _APART_S * self._rate)))
        for k in wrong.tolist():
            # One behind is left as it is: it came late, or repeats a pulse.
            pulse[k] = min(pulse[k], k + int(np.median(lead[max(k - 4, 0) : k + 5])))
        return pulse

    def _blame(self, start: int) -> None:
        """Name the first line from record `start` on that is not a record."""
        n = self.facts.n_gyros
        with self.path.open(encoding="utf-8", errors="replace", newline="") as file:
            for number, fields in enumerate(csv.reader(file), start=1):
                if number < start + 2 or number > self.n_records + 1:
                    continue
                if len(fields) != n + 1 or not _is_time(fields[0]) or not all(map(_is_field, fields[1:])):
                    raise BadInput.at(
                        self.path,
                        f"line {number}",
                        found=",".join(fields)[:80] or "an empty line",
                        expected=f"a time and {n} readings (finite numbers, or empty for no answer)",
                    )


def _is_time(text: str) -> bool:
    return bool(text) and _is_field(text) and abs(float(text)) <= _LATEST_S


def _is_field(text: str) -> bool:
    try:
        return text == "" or math.isfinite(float(text))
    except ValueError:
        return False
