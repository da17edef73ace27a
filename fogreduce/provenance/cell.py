"""One cell of a table, by name: ``[run:]drift.csv:x@2:drift_deg_h``, and the uncertainty that stands with it.

The row is named by its first field; where several rows share it, ``@`` and the segment says which
(``x@2``, ``x@all``), or ``#`` and its place among them (``gyro1#3``).
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from fogreduce.errors import BadInput

_CELL = re.compile(
    r"(?:(?P<run>[^:]+):)?(?P<table>[A-Za-z0-9_]+\.csv):"
    r"(?P<row>[^:@#]+)(?:@(?P<segment>[^:@#]+))?(?:#(?P<nth>[1-9][0-9]*))?:(?P<column>[^:]+)"
)
#: Rows that a fault names; the rest are counted.
_ROWS = 12
#: Columns whose error stands under another name.
_ERROR_OF = {
    "accumulated_error_deg": "accumulated_deg",
    "final_angle_deg": "accumulated_deg",
    "integral_less_commanded_deg": "integral_deg",
    "measured_deg_s": "difference_deg_s",
}


@dataclass(frozen=True)
class CellName:
    """The name of a cell, taken apart."""

    run: str | None
    table: str
    row: str
    segment: str | None
    nth: int | None
    column: str

    @classmethod
    def parse(cls, text: str) -> CellName:
        """From the command line."""
        match = _CELL.fullmatch(text)
        if match is None:
            expected = "[run:]table.csv:row[@segment]:column, for instance drift.csv:x:drift_deg_h"
            raise BadInput.at("CELL", "", found=text, expected=expected)
        parts = match.groupdict()
        nth = parts.pop("nth")
        return cls(**parts, nth=int(nth) if nth else None)


@dataclass(frozen=True)
class Cell:
    """A cell that was found.

    Attributes
    ----------
    name : str
        ``table.csv:row:column``, naming this cell alone.
    line : int
        Of the table, the header being line 1.
    value : str
        As it stands there.
    uncertainty : dict
        Column -> value, of the standard errors that stand beside it.
    """

    name: str
    table: str
    column: str
    line: int
    value: str
    uncertainty: dict[str, str]


def find_cell(results: Path, name: CellName) -> Cell:
    """The cell in a run's results; BadInput where there is none, or more than one."""
    path = results / "tables" / name.table
    header, rows = read_table(path)
    if name.column not in header:
        raise BadInput.at(path, "", found=f"no column {name.column}", expected=f"one of {', '.join(header)}")
    fitting = [
        k
        for k, row in enumerate(rows)
        if row[0] == name.row and name.segment in (None, _segment(header, row))
    ]
    if name.nth is not None:
        fitting = fitting[name.nth - 1 : name.nth]
    if len(fitting) != 1:
        candidates = _some_rows(row_names(header, rows))
        asked = name.row + (f"@{name.segment}" if name.segment else "") + (f"#{name.nth}" if name.nth else "")
        raise BadInput.at(path, "", found=f"{len(fitting)} rows {asked}", expected=f"one row of {candidates}")
    return cell_at(name.table, header, rows, fitting[0], name.column)


def _some_rows(names: Sequence[str]) -> str:
    """Rows to choose from: those over all segments first, then as many of the others as a line takes."""
    ordered = sorted(names, key=lambda name: not name.endswith("@all"))
    more = f" and {len(names) - _ROWS} more" if len(names) > _ROWS else ""
    return ", ".join(ordered[:_ROWS]) + more or "none: the table is empty"


def cell_at(table: str, header: list[str], rows: list[list[str]], row: int, column: str) -> Cell:
    """The cell of a row [0-based] and column."""
    fields = dict(zip(header, rows[row], strict=True))
    errors = {name: fields[name] for name in error_columns(column, header)}
    full = f"{table}:{row_names(header, rows)[row]}:{column}"
    return Cell(full, table, column, row + 2, fields[column], errors)


def read_table(path: Path) -> tuple[list[str], list[list[str]]]:
    """Header and rows of a table."""
    try:
        with path.open(encoding="utf-8", newline="") as file:
            header, *rows = list(csv.reader(file, strict=True)) or [[]]
    except FileNotFoundError:
        there = ", ".join(sorted(item.name for item in path.parent.glob("*.csv")))
        raise BadInput.at(path, "", found="no such table", expected=f"one of {there}") from None
    except (csv.Error, UnicodeDecodeError) as error:
        raise BadInput.at(path, "", found=str(error), expected="a CSV table in UTF-8") from None
    for number, row in enumerate(rows, 2):
        if len(row) != len(header):
            expected = f"{len(header)}, as its header"
            raise BadInput.at(path, f"line {number}", found=f"{len(row)} fields", expected=expected)
    return header, rows


def row_names(header: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    """A name for each row that no other has: as short as may be."""
    short = [row[0] for row in rows]
    long = [f"{row[0]}@{segment}" if (segment := _segment(header, row)) else row[0] for row in rows]
    names = []
    for k, row in enumerate(rows):
        if short.count(short[k]) == 1:
            names.append(short[k])
        elif long.count(long[k]) == 1:
            names.append(long[k])
        else:
            names.append(f"{row[0]}#{short[: k + 1].count(row[0])}")
    return names


def _segment(header: Sequence[str], row: Sequence[str]) -> str | None:
    return row[list(header).index("segment")] if "segment" in header[1:] else None


def error_columns(column: str, header: Sequence[str]) -> list[str]:
    """The columns that hold a column's standard errors: ``a_V`` -> ``a_err_V``, ``a_err_coloured_V``."""
    if "_err_" in column:
        return []
    parts = _ERROR_OF.get(column, column).split("_")
    found = []
    for k in range(1, len(parts)):
        stem, unit = "_".join(parts[:k]), "_".join(parts[k:])
        # An error column may name its kind: a_err_coloured_V, a_err_stated_V.
        pattern = re.compile(rf"{re.escape(stem)}_err_(?:[a-z]+_)?{re.escape(unit)}")
        found += [name for name in header if pattern.fullmatch(name) and name not in found]
    return found


def standard_uncertainty(column: str, fields: Mapping[str, str]) -> float | None:
    """The standard uncertainty by which a cell, or an error beside it, is measured; None where there is none.

    It is the error of white noise where the table has that, else the largest error beside the cell. Not the
    smallest: where what is stated cannot act, the stated part is zero but for rounding, and measures nothing.

    Parameters
    ----------
    column : str
        Of the cell.
    fields : mapping
        The row, by column.
    """
    header = list(fields)
    if "_err_" in column:
        stem, _, rest = column.partition("_err_")
        plain = f"{stem}_err_{rest.partition('_')[2]}"
        names = [plain if plain in fields else column]
    else:
        found = error_columns(column, header)
        parts = _ERROR_OF.get(column, column).split("_")
        plains = [f"{'_'.join(parts[:k])}_err_{'_'.join(parts[k:])}" for k in range(1, len(parts))]
        names = [name for name in found if name in plains] or found
    try:
        sizes = [float(fields[name]) for name in names if fields[name]]
    except ValueError:
        return None
    return max((size for size in sizes if size > 0.0), default=None)
