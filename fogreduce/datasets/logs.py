"""Logs beside a capture: temperatures and the table's encoder (capture contract)."""

from __future__ import annotations

import csv
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fogreduce.errors import BadInput

Array = NDArray[np.float64]

TEMPERATURE_COLUMNS = ("time_s", "electronics_degC", "sensor_degC")
TABLE_COLUMNS = ("time_s", "angle_deg")

#: Temperatures beyond these are a fault of the log, not of the laboratory [degC].
COLDEST_DEGC, HOTTEST_DEGC = -273.15, 500.0


@dataclass(frozen=True)
class TemperatureLog:
    """Temperatures about once a second: time since the run's start [s] and degrees Celsius, each (k,)."""

    time_s: Array
    electronics_degC: Array
    sensor_degC: Array

    def sensor_at(self, time_s: Array) -> Array:
        """Sensor temperature [degC], linear between rows; before the first and after the last it holds."""
        return np.interp(time_s, self.time_s, self.sensor_degC)


@dataclass(frozen=True)
class TableLog:
    """The table's encoder: time since the run's start [s], angle turned about the axis [deg], (k,)."""

    time_s: Array
    angle_deg: Array

    def angle_at(self, time_s: Array) -> Array:
        """Angle alpha [rad] at times [s], linear between rows, held at the ends, zero at the first row."""
        return np.radians(np.interp(time_s, self.time_s, self.angle_deg - self.angle_deg[0]))


def read_temperature(path: Path) -> TemperatureLog:
    """Read and check ``temperature.csv``; BadInput with the line at fault."""
    columns = _read(path, TEMPERATURE_COLUMNS)
    for name, values in zip(TEMPERATURE_COLUMNS[1:], columns[1:], strict=True):
        wrong = (values < COLDEST_DEGC) | (values > HOTTEST_DEGC)
        if wrong.any():
            row = int(np.argmax(wrong))
            raise BadInput.at(
                path,
                f"line {row + 2}",
                found=f"{name} {values[row]}",
                expected=f"{COLDEST_DEGC} to {HOTTEST_DEGC} degC",
            )
    return TemperatureLog(*columns)


def read_table_log(path: Path) -> TableLog:
    """Read and check ``table.csv``; BadInput with the line at fault. Angles are continuous (not wrapped)."""
    return TableLog(*_read(path, TABLE_COLUMNS))


def _read(path: Path, columns: tuple[str, ...]) -> list[Array]:
    """Columns of finite numbers under one header line, time increasing."""
    try:
        with path.open(encoding="utf-8", newline="") as file:
            lines = csv.reader(file)
            header = next(lines, None)
            if header is None:
                raise BadInput.at(path, "", found="an empty file", expected=",".join(columns))
            if tuple(header) != columns:
                raise BadInput.at(path, "line 1", found=",".join(header)[:80], expected=",".join(columns))
            rows = [_row(path, number, fields, len(columns)) for number, fields in enumerate(lines, start=2)]
    except OSError as error:
        raise BadInput.at(path, "", found=error.strerror, expected="a readable CSV file") from None
    except UnicodeDecodeError:
        raise BadInput.at(path, "", found="bytes that are not UTF-8", expected="text") from None
    if not rows:
        raise BadInput.at(path, "line 2", found="no rows", expected="at least one")
    table = np.array(rows)
    steps = np.diff(table[:, 0])
    if (steps <= 0).any():
        row = int(np.argmax(steps <= 0)) + 1
        raise BadInput.at(
            path,
            f"line {row + 2}",
            found=f"time_s {table[row, 0]} after {table[row - 1, 0]}",
            expected="increasing times",
        )
    return [np.ascontiguousarray(column) for column in table.T]


def _row(path: Path, number: int, fields: list[str], width: int) -> list[float]:
    try:
        values = [float(field) for field in fields]
    except ValueError:
        values = []
    if len(values) != width or not all(map(math.isfinite, values)):
        raise BadInput.at(
            path, f"line {number}", found=",".join(fields)[:80], expected=f"{width} finite numbers"
        )
    return values
