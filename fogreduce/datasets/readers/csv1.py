"""Captures of format `csv-1`: a header line ``time_s,gyro1_V,...,gyroN_V``, then a record a line.

Readings in another unit than volts have its name in place of V: ``gyro1_deg_s``. An empty field is
"no answer". Records are not numbered. A table like any other (`fogreduce.datasets.readers.table`),
its columns known beforehand.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from fogreduce.datasets.readers.table import TableReader, look
from fogreduce.errors import BadInput
from fogreduce.metadata.capture import Text
from fogreduce.physics.raw_quantity import RAW_UNITS, RawUnitName, suffix_of

FORMAT = "csv-1"
_TEXT: dict[str, Any] = {"missing": []}


class CsvReader(TableReader):
    """A CSV capture, read in blocks."""

    exact = True

    def __init__(self, path: Path, capture: Mapping[str, Any], start_us: int) -> None:
        n, unit = read_columns(path)
        columns = {"time": 1, "gyros": list(range(2, n + 2))}
        super().__init__(path, {**capture, "columns": columns, "text": _TEXT}, start_us)
        self.facts = replace(self.facts, raw_unit=unit)


def read_columns(path: Path) -> tuple[int, RawUnitName]:
    """Number of gyros and unit of readings from the header line; BadInput where it is not one of `csv-1`."""
    names, lines = look(path, Text.model_validate(_TEXT))
    for unit in RAW_UNITS:
        if len(names) > 1 and names == column_names(len(names) - 1, unit):
            return len(names) - 1, unit
    place = f"line {lines.header}" if lines.header else ""
    raise BadInput.at(path, place, found=",".join(names)[:80], expected="time_s,gyro1_V,...,gyroN_V")


def column_names(n: int, unit: RawUnitName) -> list[str]:
    """The header line's names, for n gyros read in a unit."""
    return ["time_s", *(f"gyro{i}_{suffix_of(unit)}" for i in range(1, n + 1))]
