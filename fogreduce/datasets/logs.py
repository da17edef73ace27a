"""Logs beside a capture: temperatures and the table's encoder (capture contract)."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets.atomic import write_text
from fogreduce.datasets.readers.text import number_in
from fogreduce.errors import BadInput

Array = NDArray[np.float64]

#: Columns of a temperature log: one temperature is enough.
TEMPERATURE_COLUMNS = (
    ("time_s", "electronics_degC", "sensor_degC"),
    ("time_s", "sensor_degC"),
    ("time_s", "electronics_degC"),
)
TABLE_COLUMNS = (("time_s", "angle_deg"),)

#: Temperatures beyond these are a fault of the log, not of the laboratory [degC].
COLDEST_DEGC, HOTTEST_DEGC = -273.15, 500.0


@dataclass(frozen=True)
class TemperatureLog:
    """Temperatures about once a second: time since the run's start [s] and degrees Celsius, each (k,).

    Where one temperature was logged it stands for the sensors'; `electronics_degC` is None where that
    is not the electronics'.
    """

    time_s: Array
    electronics_degC: Array | None
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
    columns, lines = _read(path, TEMPERATURE_COLUMNS)
    time_s = columns.pop("time_s")
    for name, values in columns.items():
        wrong = (values < COLDEST_DEGC) | (values > HOTTEST_DEGC)
        if wrong.any():
            row = int(np.argmax(wrong))
            raise BadInput.at(
                path,
                f"line {lines[row]}",
                found=f"{name} {values[row]}",
                expected=f"{COLDEST_DEGC} to {HOTTEST_DEGC} degC",
            )
    electronics = columns.get("electronics_degC")
    sensor = columns.get("sensor_degC", electronics)
    assert sensor is not None
    return TemperatureLog(time_s, electronics, sensor)


def read_table_log(path: Path) -> TableLog:
    """Read and check ``table.csv``; BadInput with the line at fault. Angles are continuous (not wrapped)."""
    return TableLog(**_read(path, TABLE_COLUMNS)[0])


def write_log(path: Path, log: TemperatureLog | TableLog) -> None:
    """Write a log as a file of its own, every digit kept."""
    columns = {name: values.tolist() for name, values in vars(log).items() if values is not None}
    rows = zip(*columns.values(), strict=True)
    write_text(path, ",".join(columns) + "\n" + "".join(",".join(map(repr, row)) + "\n" for row in rows))


def _read(path: Path, layouts: tuple[tuple[str, ...], ...]) -> tuple[dict[str, Array], list[int]]:
    """Columns of finite numbers by name, time increasing, under one header line; and the lines of the rows.

    What spreadsheets do is accepted: a byte order mark, any line end, quotes, spaces, blank lines.
    """
    expected = " or ".join(map(",".join, layouts))
    rows: list[list[float]] = []
    numbers: list[int] = []
    try:
        with path.open(encoding="utf-8-sig") as file:
            lines = csv.reader(file, skipinitialspace=True)
            header = next(lines, None)
            if header is None:
                raise BadInput.at(path, "", found="an empty file", expected=expected)
            names = tuple(name.strip() for name in header)
            if names not in layouts:
                raise BadInput.at(path, "line 1", found=",".join(header)[:80], expected=expected)
            for fields in lines:
                if any(field.strip() for field in fields):
                    rows.append(_row(path, lines.line_num, fields, len(names)))
                    numbers.append(lines.line_num)
    except OSError as error:
        raise BadInput.at(path, "", found=error.strerror, expected="a readable CSV file") from None
    except UnicodeDecodeError:
        raise BadInput.at(path, "", found="bytes that are not UTF-8", expected="text") from None
    except csv.Error as error:
        raise BadInput.at(path, f"line {lines.line_num}", found=str(error), expected="CSV") from None
    if not rows:
        raise BadInput.at(path, "line 2", found="no rows", expected="at least one")
    table = np.array(rows)
    steps = np.diff(table[:, 0])
    if (steps <= 0).any():
        row = int(np.argmax(steps <= 0)) + 1
        raise BadInput.at(
            path,
            f"line {numbers[row]}",
            found=f"time_s {table[row, 0]} after {table[row - 1, 0]}",
            expected="increasing times",
        )
    return {name: np.ascontiguousarray(column) for name, column in zip(names, table.T, strict=True)}, numbers


def _row(path: Path, number: int, fields: list[str], width: int) -> list[float]:
    values = [number_in(field) for field in fields]
    if len(values) != width or None in values:
        raise BadInput.at(
            path, f"line {number}", found=",".join(fields)[:80], expected=f"{width} finite numbers"
        )
    return [value for value in values if value is not None]
