"""Captures of format `mat`: variables of a MATLAB file as columns, those of a struct by ``struct.field``.

Files of version 7.3 are HDF5 and are read in chunks; of versions 5 to 7 (which hold at most 2 GB a variable)
the variables that the columns name are loaded whole, as their compression allows nothing else.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import h5py
import numpy as np

from fogreduce.datasets.readers.arrays import ArrayColumn, chunks_of, columns_of, of_one_length
from fogreduce.datasets.readers.columns import Chunk, ColumnsReader
from fogreduce.datasets.readers.hdf5 import list_columns
from fogreduce.errors import BadInput

FORMAT = "mat"


class MatReader(ColumnsReader):
    """Variables of a MATLAB file."""

    def _open(self) -> Sequence[str]:
        # Version 7.3 begins with 512 bytes of MATLAB's own, then HDF5.
        is_hdf5 = self.path.is_file() and h5py.is_hdf5(self.path)
        columns = self._of_hdf5() if is_hdf5 else self._of_version_5()
        self._columns = of_one_length(columns, self.capture, self.path)
        self.n_records = self._columns[0].records if self._columns else 0
        return [column.name for column in self._columns]

    def _chunks(self, columns: Sequence[int], size: int) -> Iterator[Chunk]:
        try:
            yield from chunks_of(self._columns, columns, self.n_records, size)
        except (OSError, RuntimeError) as error:
            found = f"damage ({error})"[:200]
            raise BadInput.at(self.path, "", found=found, expected="variables as listed") from None

    def _of_hdf5(self) -> list[ArrayColumn]:
        """Names as MATLAB has them: dots for slashes; what begins with # is MATLAB's own."""
        return [
            ArrayColumn(column.name.replace("/", "."), column.records, column.read)
            for column in list_columns(self)
            if not column.name.startswith("#")
        ]

    def _of_version_5(self) -> list[ArrayColumn]:
        from scipy.io import loadmat, whosmat
        from scipy.io.matlab import MatReadError

        try:
            named = self._variables([name for name, _, _ in whosmat(self.path)])
            variables = loadmat(self.path, variable_names=named, struct_as_record=True, squeeze_me=False)
        except (OSError, ValueError, MatReadError, NotImplementedError, TypeError) as error:
            problem = getattr(error, "strerror", None) or f"{error}"
            raise BadInput.at(self.path, "", found=problem[:100], expected="a MATLAB file") from None
        found: list[ArrayColumn] = []
        for name, value in variables.items():
            if not name.startswith("__"):
                found += _columns_within(name, value)
        return found

    def _variables(self, names: list[str]) -> list[str]:
        """The variables that the columns are in; all where that is not told by their names."""
        columns = self.capture.get("columns") or {}
        given = [
            *columns.get("gyros", ()),
            *(v for k, v in columns.items() if k != "gyros" and v is not None),
        ]
        if any(isinstance(column, int) for column in given):
            return names
        if self.capture.get("dataset"):
            given = [str(self.capture["dataset"])]
        heads = {str(column).replace("/", ".").split(".")[0].split("[")[0] for column in given}
        return [name for name in names if name in heads] or names


def _columns_within(name: str, value: Any) -> list[ArrayColumn]:
    """The columns of a variable; a struct's fields one by one."""
    array = np.asarray(value)
    if array.dtype.names is not None and array.size == 1:
        found: list[ArrayColumn] = []
        for field in array.dtype.names:
            found += _columns_within(f"{name}.{field}", array.reshape(-1)[0][field])
        return found
    return columns_of(name, array) if array.dtype.kind != "O" else []
