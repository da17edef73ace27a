"""A table of a run read back: all columns, rows whole and of one version."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

from fogreduce.errors import BadInput

#: Columns that hold a number in every row.
_NUMBERS = ("duration_s", "nominal_deg")

Row = dict[str, str]


def read_table(
    path: Path, columns: Sequence[str], version_id: str, *, never_empty: bool = False
) -> list[Row]:
    """Rows of a table, as text by column.

    Parameters
    ----------
    path : Path
    columns : sequence of str
        Those that it has; a later version may have more.
    version_id : str
        The manifest's.
    never_empty : bool
        Whether it has a row of every run.

    Raises
    ------
    BadInput
        The table is not there, lacks a column or a row, or is of another version.
    """
    try:
        with path.open(encoding="utf-8", newline="") as file:
            lines = list(csv.reader(file))
    except FileNotFoundError:
        raise BadInput.at(path, "", found="no such file", expected="a table of the reduction") from None
    except (OSError, ValueError, csv.Error) as error:
        raise BadInput.at(path, "", found=error, expected="a table of the reduction") from None
    header = lines[0] if lines else []
    if missing := [column for column in columns if column not in header]:
        raise BadInput.at(path, "line 1", found=",".join(header)[:80], expected=f"the column {missing[0]}")
    if len(lines) < 2 and never_empty:
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
