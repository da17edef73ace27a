"""Readers of raw captures: one small file a format, and the table that lists them.

A reader is a class made from a path and the sample rate of run.yaml, with `facts` (CaptureFacts),
`n_records`, `torn_bytes`, `place(record)` and `blocks(size)`. See docs/adding-a-reader.md.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from pathlib import Path
from typing import Protocol, cast

from fogreduce.datasets.block import RawBlock
from fogreduce.datasets.readers.facts import CaptureFacts
from fogreduce.errors import BadInput

#: Format name -> (module, class). Modules are imported when a capture of their format is opened.
READERS: dict[str, tuple[str, str]] = {
    "fogcap-1": ("fogreduce.datasets.readers.fogcap", "FogcapReader"),
    "csv-1": ("fogreduce.datasets.readers.csv1", "CsvReader"),
}


class Reader(Protocol):
    """What every reader offers."""

    path: Path
    facts: CaptureFacts
    n_records: int
    torn_bytes: int

    def place(self, record: int) -> str:
        """Where a record lies in the file (byte offset or line), for a message."""

    def blocks(self, size: int) -> Iterator[RawBlock]:
        """The records in file order, `size` at a time."""


def open_capture(path: Path, format_name: str, sample_rate_hz: float) -> Reader:
    """Open a capture of a named format.

    Parameters
    ----------
    path : Path
    format_name : str
        A key of `READERS`.
    sample_rate_hz : float
        From run.yaml; for formats that do not number their records.

    Raises
    ------
    BadInput
        Unknown format; no such file; not a capture of this format.
    """
    if format_name not in READERS:
        raise BadInput.at(
            path.parent / "run.yaml",
            "capture.format",
            found=format_name,
            expected="one of " + ", ".join(READERS),
        )
    module, name = READERS[format_name]
    reader = getattr(importlib.import_module(module), name)
    if path.is_dir():
        raise BadInput.at(path, "", found="a directory", expected=f"a {format_name} capture file")
    return cast(Reader, reader(path, sample_rate_hz))
