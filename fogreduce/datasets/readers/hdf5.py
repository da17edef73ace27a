"""Captures of format `hdf5`: datasets of an HDF5 file as columns, by their paths."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import h5py

from fogreduce.datasets.readers.arrays import ArrayColumn, chunks_of, columns_of, of_one_length
from fogreduce.datasets.readers.columns import Chunk, ColumnsReader
from fogreduce.errors import BadInput

FORMAT = "hdf5"


class Hdf5Reader(ColumnsReader):
    """Datasets of an HDF5 file, read in chunks."""

    def _open(self) -> Sequence[str]:
        self._columns = of_one_length(list_columns(self), self.capture, self.path)
        self.n_records = self._columns[0].records if self._columns else 0
        return [column.name for column in self._columns]

    def _chunks(self, columns: Sequence[int], size: int) -> Iterator[Chunk]:
        try:
            yield from chunks_of(self._columns, columns, self.n_records, size)
        except (OSError, RuntimeError) as error:
            found = f"damage ({error})"
            raise BadInput.at(self.path, "", found=found[:200], expected="datasets as listed") from None


def list_columns(reader: ColumnsReader) -> list[ArrayColumn]:
    """Every column that the file holds; links to other files are passed over."""
    try:
        file = h5py.File(reader.path, "r")
    except OSError as error:
        problem = getattr(error, "strerror", None) or "a file that is not HDF5"
        raise BadInput.at(reader.path, "", found=problem, expected="an HDF5 file") from None
    found: list[ArrayColumn] = []

    def visit(name: str, item: Any) -> None:
        if isinstance(item, h5py.Dataset) and not item.external:
            columns = columns_of(name, item)
            found.extend(columns)
            unit = item.attrs.get("units", item.attrs.get("unit", ""))
            text = unit.decode("utf-8", "replace") if isinstance(unit, bytes) else unit
            if isinstance(text, str) and text:
                reader.units.update({column.name: text for column in columns})

    try:
        file.visititems(visit)
    except (OSError, RuntimeError) as error:
        expected = "an HDF5 file that is whole"
        raise BadInput.at(reader.path, "", found=f"damage ({error})"[:200], expected=expected) from None
    return found
