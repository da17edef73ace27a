"""The tables of a run read back, for who shows them: all columns, rows whole and of one version."""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from fogreduce.errors import BadInput
from fogreduce.physics.raw_quantity import RawUnit
from fogreduce.stages import encoder, look
from fogreduce.stages.budget import BUDGET_COLUMNS
from fogreduce.stages.drift import DRIFT_COLUMNS, RULE_COLUMNS
from fogreduce.stages.rates import RATES_COLUMNS
from fogreduce.stages.tables import RATE_FIT_COLUMNS, gyro_fit_columns

#: Table -> its columns, which may depend on the unit of raw readings; a later version may have more.
COLUMNS: Mapping[str, Callable[[RawUnit], Sequence[str]]] = {
    "quality": lambda _: ("what", "count", "version_id"),
    "encoder": lambda _: encoder.COLUMNS,
    "warnings": lambda _: look.COLUMNS,
    "gyro_fit": gyro_fit_columns,
    "rate_fit": lambda _: RATE_FIT_COLUMNS,
    "unstable": lambda _: ("gyro", "start_s", "stop_s", "noise_ratio", "version_id"),
    "drift": lambda _: DRIFT_COLUMNS,
    "rates": lambda _: RATES_COLUMNS,
    "drift_by_records": lambda _: RULE_COLUMNS,
    "budget": lambda _: BUDGET_COLUMNS,
}
#: Tables that have a row of every run.
_NEVER_EMPTY = ("quality", "gyro_fit")
#: Tables that results of earlier versions do not have.
_MAY_BE_ABSENT = ("rates", "warnings", "drift_by_records", "budget")
#: Columns that hold a number in every row.
_NUMBERS = ("duration_s", "nominal_deg")

Row = dict[str, str]


def read_rows(results: Path, name: str, version_id: str, raw_unit: RawUnit) -> list[Row]:
    """Rows of a table, as text by column.

    Parameters
    ----------
    results : Path
        The run's results folder.
    name : str
        A key of `COLUMNS`.
    version_id : str
        The manifest's.
    raw_unit : RawUnit
        Of the run's raw readings.

    Raises
    ------
    BadInput
        The table is not there, lacks a column or a row, or is of another version.
    """
    path = results / "tables" / f"{name}.csv"
    try:
        with path.open(encoding="utf-8", newline="") as file:
            lines = list(csv.reader(file))
    except FileNotFoundError:
        if name in _MAY_BE_ABSENT:
            return []
        raise BadInput.at(path, "", found="no such file", expected="a table of the reduction") from None
    except (OSError, ValueError, csv.Error) as error:
        raise BadInput.at(path, "", found=error, expected="a table of the reduction") from None
    header = lines[0] if lines else []
    if missing := [column for column in COLUMNS[name](raw_unit) if column not in header]:
        raise BadInput.at(path, "line 1", found=",".join(header)[:80], expected=f"the column {missing[0]}")
    if len(lines) < 2 and name in _NEVER_EMPTY:
        raise BadInput.at(path, "line 2", found="no row", expected="at least one")
    rows = []
    for number, line in enumerate(lines[1:], 2):
        if len(line) != len(header):
            expected = f"{len(header)}, as its header"
            raise BadInput.at(path, f"line {number}", found=f"{len(line)} fields", expected=expected)
        row = dict(zip(header, line, strict=True))
        if (found := row["version_id"]) != version_id:
            expected = f"{version_id}, as the manifest has it"
            raise BadInput.at(path, "version_id", found=found, expected=expected)
        for column in _NUMBERS:
            if column in row and not _is_number(row[column]):
                raise BadInput.at(path, f"line {number}", found=row[column], expected=f"{column}, a number")
        rows.append(row)
    return rows


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
