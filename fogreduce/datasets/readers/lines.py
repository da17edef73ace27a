"""Lines of a text file told apart without parsing: header, records, comments, blank lines, a torn end."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np

from fogreduce.errors import BadInput
from fogreduce.metadata.capture import Text

_BYTES = 1 << 20
_NEWLINE, _RETURN = 10, 13


@dataclass(frozen=True)
class Lines:
    """Where the records of a text file lie.

    Attributes
    ----------
    header : int
        Line of the columns' names, from 1; 0 where there is none.
    first : int
        Line of the first record.
    records : int
        Whole records.
    between : int
        Comments and blank lines between the records.
    torn_bytes : int
        Bytes of a last line that was cut off: no line end, and fewer delimiters than the first record.
    uneven : bool
        Whether some records have fewer or more delimiters than the first.
    """

    header: int
    first: int
    records: int
    between: int
    torn_bytes: int
    uneven: bool


def count_lines(file: IO[bytes], text: Text, path: Path) -> Lines:
    """Where the records lie; one pass over the file's bytes, whatever its line ends."""
    if text.encoding == "utf-16":
        file = _recoded(file, path)
    comment = ord(text.comment) if text.comment else -1
    number = 0  # of the line before
    header = first = delimiters = counted = 0
    below = text.skip_below_header
    tail = b""
    kinds: list[np.ndarray] = []  # per chunk: True for a record, False for a comment or blank line
    while True:
        data = file.read(_BYTES)
        whole, tail = _whole_lines(tail + data, end=not data)
        starts, ends = _lines(whole)
        if starts.size:
            is_record = _is_record(whole, starts, ends, comment)
            skip = min(max(text.skip_lines - number, 0), starts.size)
            is_record[:skip] = False
            if first == 0:
                at = np.flatnonzero(is_record)
                if text.header and header == 0 and at.size:
                    header = number + int(at[0]) + 1
                    at = at[1:]
                if header or not text.header:
                    below, at = max(below - at.size, 0), at[below:]
                if at.size:
                    first = number + int(at[0]) + 1
                    delimiters = _delimiters(whole[starts[at[0]] : ends[at[0]]], text)
                    is_record = is_record[at[0] :]
                    counted -= _delimiters(whole[: starts[at[0]]], text)
                else:
                    is_record = is_record[:0]
            if first:
                kinds.append(is_record)
                counted += _delimiters(whole, text)
            number += starts.size
        if not data:
            break
    torn = 0
    if tail.strip(b"\r\n \t") and not (comment >= 0 and tail.lstrip(b" \t")[:1] == bytes([comment])):
        if first and _delimiters(tail, text) < delimiters:
            torn = len(tail)
        else:
            kinds.append(np.ones(1, bool))
            counted += _delimiters(tail, text)
            first = first or number + 1
    found = np.concatenate(kinds) if kinds else np.zeros(0, bool)
    records = int(np.count_nonzero(found))
    last = int(np.flatnonzero(found)[-1]) + 1 if records else 0
    # Comments may hold delimiters too: then lines are looked at that need not be.
    uneven = text.delimiter != "whitespace" and counted != records * delimiters
    return Lines(header, first, records, last - records, torn, uneven)


def _whole_lines(data: bytes, end: bool) -> tuple[bytes, bytes]:
    """Data up to its last line end, line ends made one byte; and the rest."""
    if b"\r" in data:
        if data.endswith(b"\r") and not end:
            data, kept_back = data[:-1], b"\r"  # the newline that belongs to it may come next
        else:
            kept_back = b""
        data = data.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    else:
        kept_back = b""
    cut = data.rfind(b"\n") + 1
    return data[:cut], data[cut:] + kept_back


def _lines(data: bytes) -> tuple[np.ndarray, np.ndarray]:
    ends = np.flatnonzero(np.frombuffer(data, np.uint8) == _NEWLINE)
    starts = np.concatenate(([0], ends[:-1] + 1)) if ends.size else ends
    return starts, ends


def _is_record(data: bytes, starts: np.ndarray, ends: np.ndarray, comment: int) -> np.ndarray:
    """Which lines are neither blank nor a comment."""
    octets = np.frombuffer(data, np.uint8)
    first = octets[starts]
    found = (ends > starts) & (first != comment)
    for k in np.flatnonzero(((first == 32) | (first == 9)) & found).tolist():
        line = data[starts[k] : ends[k]].strip()
        found[k] = bool(line) and line[0] != comment
    if data.startswith(b"\xef\xbb\xbf"):
        line = data[3 : ends[0]].strip()
        found[0] = bool(line) and line[0] != comment
    return found


def _delimiters(line: bytes, text: Text) -> int:
    if text.delimiter == "whitespace":
        return max(len(line.split()) - 1, 0)
    return line.count(text.delimiter.encode())


def _recoded(file: IO[bytes], path: Path) -> IO[bytes]:
    """UTF-16 as UTF-8: loggers that write it write small files."""
    try:
        return io.BytesIO(file.read().decode("utf-16").encode())
    except UnicodeDecodeError:
        raise BadInput.at(path, "", found="bytes that are not UTF-16", expected="text in UTF-16") from None
