"""How a text file is written: encoding, delimiter, decimal mark, comments, header; from its first lines."""

from __future__ import annotations

import csv
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fogreduce.datasets.readers.table import opened
from fogreduce.datasets.readers.text import number_in
from fogreduce.guess.names import raw_unit_of, time_unit_of

_BYTES = 1 << 16
_DELIMITERS = (",", ";", "\t", "|", "whitespace")
_COMMENTS = ("#", "%")
_WORDS = ("NaN", "nan", "NAN", "NA", "N/A", "n/a", "null", "NULL", "None", "--", "-")


@dataclass(frozen=True)
class Layout:
    """Keys of `capture.text` that differ from their defaults, and units that stand in a line of their own."""

    keys: dict[str, Any]
    units: dict[str, str]


def layout_of(path: Path) -> Layout | None:
    """The layout of a text file; None where its lines are no records."""
    with opened(path) as file:
        data = file.read(_BYTES)
    encoding, text = _decoded(data)
    lines = text.splitlines()
    if len(data) == _BYTES:
        lines = lines[:-1]
    if text.count("\0") or len(lines) < 2:
        return None
    comment = next((c for c in _COMMENTS if any(line.startswith(c) for line in lines)), None)
    body = [(k, _without(line, comment)) for k, line in enumerate(lines)]
    body = [(k, line) for k, line in body if line.strip()]
    found = _best([line for _, line in body])
    if found is None:
        return None
    delimiter, decimal, width = found
    rows = [(k, _fields(line, delimiter)) for k, line in body]
    first = _first_record(rows, width, decimal)
    if first is None:
        return None
    keys: dict[str, Any] = {"delimiter": delimiter, "decimal": decimal, "encoding": encoding}
    if comment:
        keys["comment"] = comment
    header, below = _header(rows, first, width)
    keys["header"] = header is not None
    start = rows[first if header is None else header][0]
    if any(k < start for k, _ in rows):
        keys["skip_lines"] = start
    units: dict[str, str] = {}
    if header is not None and below:
        keys["skip_below_header"] = below
        units = dict(zip(rows[header][1], rows[header + 1][1], strict=False))
    words = {f for _, row in rows[first:] for f in row if f in _WORDS}
    keys["missing"] = (
        sorted({"NaN", "nan", "NA", "null", *words}) if words - {"NaN", "nan", "NA", "null"} else None
    )
    default = {"delimiter": ",", "decimal": ".", "encoding": "utf-8", "header": True, "missing": None}
    return Layout({k: v for k, v in keys.items() if default.get(k, ()) != v}, units)


def _decoded(data: bytes) -> tuple[str, str]:
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "utf-16", data.decode("utf-16", "ignore")
    try:
        return "utf-8", data[: data.rfind(b"\n") + 1 or None].decode("utf-8-sig")
    except UnicodeDecodeError:
        return "latin-1", data.decode("latin-1")


def _without(line: str, comment: str | None) -> str:
    return line.split(comment, 1)[0] if comment else line


def _fields(line: str, delimiter: str) -> list[str]:
    if delimiter == "whitespace":
        return line.split()
    return [
        field.strip() for field in next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [""])
    ]


def _best(lines: list[str]) -> tuple[str, str, int] | None:
    """Delimiter, decimal mark and number of fields that make most numbers of the lines' second half."""
    half = lines[len(lines) // 2 :]
    best: tuple[float, tuple[str, str, int]] | None = None
    for delimiter in _DELIMITERS:
        rows = [_fields(line, delimiter) for line in half]
        width = max(set(map(len, rows)), key=[len(row) for row in rows].count)
        for decimal in (".", ","):
            if decimal == delimiter:
                continue
            score = sum(_worth(field, decimal) for row in rows for field in row) / len(rows)
            if best is None or score > best[0]:
                best = score, (delimiter, decimal, width)
    return best[1] if best and best[0] > 0 else None


def _worth(field: str, decimal: str) -> int:
    """A number counts for a delimiter, text that looks like several fields in one against it."""
    if not field or field in _WORDS:
        return 0
    if number_in(field, decimal) is not None:
        return 2
    return -3 if re.search(r"[,;|\t]", field) else -1


def _is_record(row: list[str], decimal: str) -> bool:
    return any(number_in(field, decimal) is not None for field in row)


def _first_record(rows: list[tuple[int, list[str]]], width: int, decimal: str) -> int | None:
    """The first row from which on all have the width of records and numbers in them."""
    first = None
    for index in range(len(rows) - 1, -1, -1):
        if len(rows[index][1]) != width or not _is_record(rows[index][1], decimal):
            # One odd line within the records is a fault of the file, not its beginning.
            if first is not None and index < len(rows) // 2:
                break
            continue
        first = index
    return first


def _header(rows: list[tuple[int, list[str]]], first: int, width: int) -> tuple[int | None, int]:
    """The row of names before the first record, and how many lines of units stand between."""
    if first == 0 or len(rows[first - 1][1]) != width:
        return None, 0
    units = [f.strip("[]()") for f in rows[first - 1][1]]
    recognised = [unit for unit in units if unit and (raw_unit_of(unit) or time_unit_of(unit))]
    if first > 1 and len(rows[first - 2][1]) == width and len(recognised) > 1:
        return first - 2, 1
    return first - 1, 0
