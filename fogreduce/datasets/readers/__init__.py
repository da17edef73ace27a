"""Readers of raw captures: one small file a format, and the table that lists them.

A reader is a class made from a path, the `capture` block of run.yaml and the run's start, with `facts`
(CaptureFacts), `n_records`, `torn_bytes`, `place(record)` and `blocks(size)`. Packages that a laboratory
installs add theirs (`fogreduce.datasets.readers.installed`). See docs/adding-a-reader.md.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, cast

from fogreduce.errors import BadInput

if TYPE_CHECKING:  # who only asks what formats there are does not pay for numpy
    from fogreduce.datasets.block import RawBlock
    from fogreduce.datasets.readers.facts import CaptureFacts

#: Format name -> (module, class). Modules are imported when a capture of their format is opened.
READERS: dict[str, tuple[str, str]] = {
    "fogcap-1": ("fogreduce.datasets.readers.fogcap", "FogcapReader"),
    "csv-1": ("fogreduce.datasets.readers.csv1", "CsvReader"),
    "table": ("fogreduce.datasets.readers.table", "TableReader"),
    "hdf5": ("fogreduce.datasets.readers.hdf5", "Hdf5Reader"),
    "mat": ("fogreduce.datasets.readers.mat", "MatReader"),
    "npy": ("fogreduce.datasets.readers.numpy_files", "NpyReader"),
    "npz": ("fogreduce.datasets.readers.numpy_files", "NpzReader"),
    "tdms": ("fogreduce.datasets.readers.tdms", "TdmsReader"),
    "parquet": ("fogreduce.datasets.readers.parquet", "ParquetReader"),
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


def open_capture(path: Path, capture: Mapping[str, Any], start_us: int) -> Reader:
    """Open a capture.

    Parameters
    ----------
    path : Path
    capture : mapping
        The `capture` block of run.yaml, validated plain data.
    start_us : int
        The run's start, microseconds since 1970-01-01T00:00:00Z.

    Raises
    ------
    BadInput
        Unknown format; no such file; not a capture of this format.
    """
    make = _reader_of(capture["format"], path.parent / "run.yaml")
    if path.is_dir():
        raise BadInput.at(path, "", found="a directory", expected=f"a {capture['format']} capture file")
    return cast(Reader, make(path, capture, start_us))


def _reader_of(format_name: str, run_yaml: Path) -> Callable[[Path, Mapping[str, Any], int], Any]:
    """The class that reads a format; its module is imported now."""
    if format_name in READERS:
        module, name = READERS[format_name]
        return cast(Callable[..., Any], getattr(importlib.import_module(module), name))
    from fogreduce.datasets.readers.installed import installed_readers

    installed = installed_readers()
    if format_name not in installed:
        expected = "one of " + ", ".join([*READERS, *installed])
        raise BadInput.at(run_yaml, "capture.format", found=format_name, expected=expected)
    return cast(Callable[..., Any], installed[format_name].load())
