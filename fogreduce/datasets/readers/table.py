"""Captures of format `table`: delimited text of whatever a logger writes, gzipped or not."""

from __future__ import annotations

import csv
import gzip
import io
import zlib
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO

import numpy as np

from fogreduce.datasets.readers.columns import Chunk, ColumnsReader
from fogreduce.datasets.readers.lines import Lines, count_lines
from fogreduce.datasets.readers.text import number_in
from fogreduce.errors import BadInput
from fogreduce.metadata.capture import Text

FORMAT = "table"


@contextmanager
def opened(path: Path) -> Iterator[IO[bytes]]:
    """A file's bytes, unpacked where it is gzipped; BadInput where it cannot be read."""
    try:
        with path.open("rb") as raw:
            packed = raw.read(2) == b"\x1f\x8b"
            raw.seek(0)
            with gzip.GzipFile(fileobj=raw) if packed else raw as file:
                yield file  # type: ignore[misc]
    except (OSError, EOFError, zlib.error) as error:
        found = getattr(error, "strerror", None) or str(error)
        raise BadInput.at(path, "", found=found, expected="a readable file") from None


class TableReader(ColumnsReader):
    """Delimited text, read in chunks by pandas.

    `exact`: whether a record with more fields than there are columns is refused.
    """

    exact = False

    def _open(self) -> Sequence[str]:
        self._text = Text.model_validate(self.capture.get("text") or {})
        names, self._lines = look(self.path, self._text)
        self.n_records, self.torn_bytes = self._lines.records, self._lines.torn_bytes
        return names

    def place(self, record: int) -> str:
        """The record's line; where comments or blank lines stand between records, its number alone."""
        if self._lines.between:
            return f"record {record + 1}"
        return f"line {(self._lines.first or self._lines.header + 1) + record}"

    def _chunks(self, columns: Sequence[int], size: int) -> Iterator[Chunk]:
        from pandas import read_csv  # costs a third of a second: only who reads text pays
        from pandas.errors import ParserError

        text = self._text
        order = sorted(set(columns))
        as_text = self._time if (self.capture.get("time") or {}).get("unit") == "iso8601" else None
        if self._lines.uneven:
            self._blame(columns, as_text)  # a line cut short would read as gyros that did not answer
        dtypes = {k: str if k == as_text else np.float64 for k in order}
        start = 0
        try:
            with opened(self.path) as file:
                frames = read_csv(
                    file,
                    sep=r"\s+" if text.delimiter == "whitespace" else text.delimiter,
                    decimal=text.decimal,
                    comment=text.comment,
                    header=None,
                    names=range(len(self.names)),
                    skiprows=self._lines.first - 1,
                    nrows=self.n_records,
                    usecols=order,
                    dtype=dtypes,
                    chunksize=size,
                    keep_default_na=False,
                    na_values=["", *text.missing],
                    skipinitialspace=True,
                    skip_blank_lines=True,
                    index_col=False,
                    encoding=text.encoding,
                )
                for frame in frames:
                    yield [frame[k].to_numpy() for k in columns]
                    start += len(frame)
        except (ValueError, ParserError, UnicodeError):
            self._blame(columns, as_text)
            raise

    def _blame(self, columns: Sequence[int], as_text: int | None) -> None:
        """Name the first line that is not a record, if there is one."""
        text = self._text
        words = {"", *text.missing}
        records = 0
        with opened(self.path) as file:
            stream = io.TextIOWrapper(file, encoding=text.encoding, errors="replace", newline=None)
            for number, line in enumerate(stream, start=1):
                fields = fields_of(line, text)
                if number < self._lines.first or fields == [""]:
                    continue
                records += 1
                if records > self.n_records:
                    return
                found = ""
                if self.exact and len(fields) != len(self.names):
                    found = line.strip()
                for k in columns:
                    field = fields[k].strip() if k < len(fields) else None
                    if field is None:
                        found = found or f"{len(fields)} fields"
                    elif k != as_text and field not in words and number_in(field, text.decimal) is None:
                        found = found or f"{self.names[k]} {field}"
                if "\ufffd" in line:
                    found = f"bytes that are not {text.encoding.upper()}"
                if found:
                    place = f"line {number}"
                    raise BadInput.at(self.path, place, found=found[:80], expected=self._record())


def look(path: Path, text: Text) -> tuple[list[str], Lines]:
    """Names of the columns, and where the records lie."""
    with opened(path) as file:
        lines = count_lines(file, text, path)
    names: list[str] = []
    width = 0
    with opened(path) as file:
        stream = io.TextIOWrapper(file, encoding=text.encoding, errors="replace", newline=None)
        for number, line in enumerate(stream, start=1):
            if "\ufffd" in line and number >= max(lines.header, 1):
                found = f"bytes that are not {text.encoding.upper()}"
                raise BadInput.at(path, f"line {number}", found=found, expected="text")
            if number == lines.header:
                names = [name.strip().lstrip("\ufeff").strip('"') for name in fields_of(line, text)]
            if number >= max(lines.first, lines.header):
                width = len(fields_of(line, text)) if number == lines.first else 0
                break
    names += [str(k + 1) for k in range(len(names), width)]
    return names, lines


def fields_of(line: str, text: Text) -> list[str]:
    """The fields of a line, comments left out."""
    line = line.rstrip("\r\n")
    if text.comment:
        line = line.split(text.comment, 1)[0]
    if text.delimiter == "whitespace":
        return line.split() or [""]
    return next(csv.reader([line], delimiter=text.delimiter, skipinitialspace=True), [""]) or [""]
