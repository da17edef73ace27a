"""Readers of raw captures: one small file a format, and the table that lists them.

A reader is a class made from a path and the sample rate of run.yaml, with `facts` (CaptureFacts),
`n_records`, `torn_bytes`, `place(record)` and `blocks(size)`. Packages that a laboratory installs add
theirs (`fogreduce.datasets.readers.installed`). See docs/adding-a-reader.md.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Protocol, cast

from fogreduce.errors import BadInput

if TYPE_CHECKING:  # who only asks what formats there are does not pay for numpy
    from fogreduce.datasets.block import RawBlock
    from fogreduce.datasets.readers.facts import CaptureFacts

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
    reader = _reader_of(format_name, path.parent / "run.yaml")
    if path.is_dir():
        raise BadInput.at(path, "", found="a directory", expected=f"a {format_name} capture file")
    return cast(Reader, reader(path, sample_rate_hz))


def _reader_of(format_name: str, run_yaml: Path) -> Callable[..., object]:
    """A format's reader: of the table, else of an installed package."""
    if format_name in READERS:
        module, name = READERS[format_name]
        return cast(Callable[..., object], getattr(importlib.import_module(module), name))
    from fogreduce.datasets.readers.installed import installed_readers

    installed = installed_readers()
    if format_name in installed:
        return cast(Callable[..., object], installed[format_name].load())
    expected = "one of " + ", ".join((*READERS, *installed))
    raise BadInput.at(run_yaml, "capture.format", found=format_name, expected=expected)
