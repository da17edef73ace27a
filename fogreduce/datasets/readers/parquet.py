"""Captures of format `parquet`: columns of a Parquet file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from fogreduce.datasets.readers.columns import Chunk, ColumnsReader, needs
from fogreduce.errors import BadInput

FORMAT = "parquet"


class ParquetReader(ColumnsReader):
    """Columns of a Parquet file, read in batches."""

    def _open(self) -> Sequence[str]:
        library = needs("pyarrow.parquet", "parquet", self.path)
        try:
            self._file = library.ParquetFile(self.path)
        except (OSError, ValueError) as error:
            found = getattr(error, "strerror", None) or str(error)
            raise BadInput.at(self.path, "", found=found[:100], expected="a Parquet file") from None
        self.n_records = self._file.metadata.num_rows
        return list(self._file.schema_arrow.names)

    def _chunks(self, columns: Sequence[int], size: int) -> Iterator[Chunk]:
        names = [self.names[k] for k in columns]
        try:
            # Batches end with their row groups: they are put together to the size that was asked for.
            waiting: Chunk = [np.empty(0)] * len(names)
            for batch in self._file.iter_batches(batch_size=size, columns=sorted(set(names))):
                read = [_numbers(batch.column(name)) for name in names]
                waiting = read if not len(waiting[0]) else _joined(waiting, read)
                while len(waiting[0]) >= size:
                    yield [column[:size] for column in waiting]
                    waiting = [column[size:] for column in waiting]
            if len(waiting[0]):
                yield waiting
        except (OSError, ValueError) as error:
            raise BadInput.at(self.path, "", found=str(error)[:100], expected="columns as listed") from None


def _joined(first: Chunk, second: Chunk) -> Chunk:
    return [np.concatenate(parts) for parts in zip(first, second, strict=True)]


def _numbers(column: Any) -> np.ndarray[Any, Any]:
    """A column as numpy has it; no value is NaN (or NaT)."""
    if column.null_count and str(column.type).startswith(("int", "uint")):
        column = column.cast("float64")
    values: np.ndarray[Any, Any] = column.to_numpy(zero_copy_only=False)
    return values
