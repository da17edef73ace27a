"""Captures of formats `npy` and `npz`: arrays that numpy saved.

An array in a file of its own is mapped, not loaded; those in an archive are read along with it, packed or
not, as long as their records lie one after another. Pickled objects are refused: they run code.
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy_format

from fogreduce.datasets.readers.arrays import ArrayColumn, chunks_of, columns_of, of_one_length
from fogreduce.datasets.readers.columns import Chunk, ColumnsReader
from fogreduce.errors import BadInput

FORMATS = ("npy", "npz")
_DAMAGED = (OSError, ValueError, zipfile.BadZipFile, EOFError, KeyError)


class NpyReader(ColumnsReader):
    """An array in a file of its own: ``[1]``, ``[2]``, ... for a matrix, names for one of named fields."""

    def _open(self) -> Sequence[str]:
        try:
            array = np.load(self.path, mmap_mode="r", allow_pickle=False)
        except _DAMAGED as error:
            found = getattr(error, "strerror", None) or str(error).split(";")[0]
            raise BadInput.at(self.path, "", found=found[:100], expected="a file of numpy.save") from None
        self._columns = [
            ArrayColumn(column.name.lstrip(".") or "[1]", column.records, column.read)
            for column in columns_of("", array)
        ]
        self.n_records = self._columns[0].records if self._columns else 0
        return [column.name for column in self._columns]

    def _chunks(self, columns: Sequence[int], size: int) -> Iterator[Chunk]:
        yield from chunks_of(self._columns, columns, self.n_records, size)


class NpzReader(ColumnsReader):
    """Arrays in an archive of numpy.savez, read in one pass."""

    def _open(self) -> Sequence[str]:
        try:
            columns: list[ArrayColumn] = []
            with zipfile.ZipFile(self.path) as archive:
                for member in archive.namelist():
                    name = member.removesuffix(".npy")
                    columns += columns_of(name, _Member(self.path, member))
        except _DAMAGED as error:
            found = getattr(error, "strerror", None) or str(error)
            raise BadInput.at(self.path, "", found=found[:100], expected="a file of numpy.savez") from None
        self._columns = of_one_length(columns, self.capture, self.path)
        self.n_records = self._columns[0].records if self._columns else 0
        return [column.name for column in self._columns]

    def _chunks(self, columns: Sequence[int], size: int) -> Iterator[Chunk]:
        try:
            yield from chunks_of(self._columns, columns, self.n_records, size)
        except _DAMAGED as error:
            raise BadInput.at(self.path, "", found=str(error)[:100], expected="arrays as listed") from None


class _Member:
    """An array in an archive: shape and dtype at once, rows as they are asked for, in order."""

    def __init__(self, path: Path, member: str) -> None:
        self._path, self._member = path, member
        with zipfile.ZipFile(path) as archive, archive.open(member) as file:
            self.shape, self._fortran, self.dtype = _header(file)
        self._streams: dict[Any, tuple[IO[bytes], int]] = {}
        self._whole: np.ndarray[Any, Any] | None = None

    def __getitem__(self, key: Any) -> Any:
        rows, rest = (key[0], key[1:]) if isinstance(key, tuple) else (key, ())
        if (self._fortran and len(self.shape) > 1) or not isinstance(rows, slice):
            # Its columns lie one after another: there is no reading it record by record.
            if self._whole is None:
                with np.load(self._path, allow_pickle=False) as archive:
                    self._whole = archive[self._member.removesuffix(".npy")]
            return self._whole[key]
        part = self._rows(rows.start, rows.stop, rest)
        return part[(slice(None), *rest)]

    def _rows(self, start: int, stop: int, reader: Any) -> np.ndarray[Any, Any]:
        """Rows from `start` to `stop`; each reader (a column) goes forward by itself."""
        stream, at = self._streams.get(reader, (None, 0))
        if stream is None or at != start:
            stream = zipfile.ZipFile(self._path).open(self._member)  # noqa: SIM115 -- kept for the next rows
            _header(stream)
            stream.seek(stream.tell() + start * self._row_bytes)
        data = stream.read((stop - start) * self._row_bytes)
        self._streams[reader] = stream, stop
        return np.frombuffer(data, self.dtype).reshape(-1, *self.shape[1:])

    @property
    def _row_bytes(self) -> int:
        return int(self.dtype.itemsize * np.prod(self.shape[1:], dtype=np.int64))


def _header(file: IO[bytes]) -> tuple[tuple[int, ...], bool, np.dtype[Any]]:
    """Shape, order and dtype of an array, the file left at its first number."""
    version = npy_format.read_magic(file)
    read = npy_format.read_array_header_1_0 if version == (1, 0) else npy_format.read_array_header_2_0
    shape, fortran, dtype = read(file)
    if dtype.hasobject:
        raise ValueError("pickled objects, which are not read")
    return shape, fortran, dtype
