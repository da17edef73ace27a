"""A stage's dataset read again, in the blocks in which it was written; refused where it is not as written."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets.block import Block
from fogreduce.datasets.templates import variables_of
from fogreduce.errors import BadInput
from fogreduce.physics.quantization import raw_from_counts
from fogreduce.stages.setup import Setup

_LARGEST = 1e100
_EXPECTED = "one, as its stage writes it"
#: What h5py raises where a file is damaged or of another making.
_DAMAGED = (OSError, RuntimeError, ValueError, KeyError, TypeError, AttributeError)


class StageDataset:
    """A stage's dataset, read in the blocks in which it was written.

    Parameters
    ----------
    setup : Setup
    stage : str
        Whose dataset.

    Raises
    ------
    BadInput
        No such file, or not of this version; here and later: a variable that is missing, damaged, or of
        another kind or shape than the stage writes.
    """

    def __init__(self, setup: Setup, stage: str) -> None:
        self.path = setup.dataset(stage)
        self._size = setup.block_records
        self._raw = setup.facts.raw_unit.variable
        try:
            self._file = h5py.File(self.path, "r")
        except _DAMAGED as error:
            expected = f"the dataset of stage {stage}"
            raise BadInput.at(self.path, "", found=problem_of(self.path, error), expected=expected) from None
        try:
            with self._reading("version_id"):
                found_id = self._file.attrs.get("version_id")
            if not isinstance(found_id, str) or found_id != setup.version_id:
                expected = f"{setup.version_id}, as the manifest has it"
                raise BadInput.at(self.path, "version_id", found=_shown(found_id), expected=expected)
            self._sizes = {"gyro": setup.facts.n_gyros, "axis": 3, "time": self._length()}
            has_counts = stage == "ingest" and self._found(self._raw).dtype == np.int32
            self._expected = variables_of(stage, setup.facts, has_counts=has_counts)
            # All of them, before anything is made in the size that one of them claims.
            self._variables = {
                name: self._variable(name)
                for name, expected in self._expected.items()
                if setup.axes or "axis" not in expected.dims
            }
        except BaseException:
            self._file.close()
            raise

    @property
    def n_records(self) -> int:
        """Number of records (or bins)."""
        return self._sizes["time"]

    def __enter__(self) -> StageDataset:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def has_counts(self) -> bool:
        """Whether raw readings are packed counts."""
        return bool(np.dtype(self._expected[self._raw].dtype) == np.int32)

    def blocks(self, names: Sequence[str]) -> Iterator[tuple[int, dict[str, NDArray[Any]]]]:
        """Index of the first record, and the named variables' values, block by block."""
        for start in range(0, self.n_records, self._size):
            part = slice(start, min(start + self._size, self.n_records))
            values = {}
            for name in names:
                with self._reading(name):
                    values[name] = self._variables[name][..., part]
                self._check_size(name, values[name])
            yield start, values

    def _check_size(self, name: str, values: NDArray[Any]) -> None:
        """No number of a size that no stage writes: squares of it would be infinite."""
        if values.dtype.kind == "f" and np.fmax.reduce(np.abs(values), axis=None, initial=0.0) > _LARGEST:
            raise BadInput.at(self.path, name, found=f"a number beyond {_LARGEST:g}", expected=_EXPECTED)

    def _variable(self, name: str) -> h5py.Dataset:
        """A variable, of the kind and shape that its stage writes."""
        variable, expected = self._found(name), self._expected[name]
        shape = tuple(self._sizes[dim] for dim in expected.dims)
        with self._reading(name):
            found = (variable.shape, variable.dtype, variable.is_virtual or bool(variable.external))
        if found != (shape, np.dtype(expected.dtype), False):
            raise BadInput.at(
                self.path,
                name,
                found=f"{found[1]} of shape {found[0]}" + (" in another file" if found[2] else ""),
                expected=f"{np.dtype(expected.dtype)} of shape {shape}, as its stage writes it",
            )
        return variable

    def _found(self, name: str) -> h5py.Dataset:
        """A variable of whatever kind."""
        with self._reading(name):
            link = self._file.get(name, getlink=True)
            there = isinstance(self._file[name], h5py.Dataset) if isinstance(link, h5py.HardLink) else False
        if not there:
            found = "no such variable" if link is None else "a group or a link"
            raise BadInput.at(self.path, name, found=found, expected=_EXPECTED)
        return self._file[name]

    def _length(self) -> int:
        """Along the records; at least one."""
        with self._reading("time"):
            shape = self._found("time").shape
        if shape is None or len(shape) != 1 or shape[0] < 1:
            raise BadInput.at(self.path, "time", found=f"shape {shape}", expected="a time stamp a record")
        return int(shape[0])

    @contextmanager
    def _reading(self, name: str) -> Iterator[None]:
        """What h5py raises at a damaged variable, turned into BadInput."""
        try:
            yield
        except _DAMAGED as error:
            found = f"damage ({_shown(error)})"
            raise BadInput.at(self.path, name, found=found, expected=_EXPECTED) from None


def ingested_blocks(setup: Setup, source: StageDataset) -> Iterator[Block]:
    """The blocks that ingest wrote."""
    has_counts = source.has_counts()
    variable = setup.facts.raw_unit.variable
    for start, part in source.blocks(("time", "pulse", variable, "flag", "gyro_flag")):
        stored = part[variable]
        raw = raw_from_counts(stored, setup.facts.least_count) if has_counts else stored
        counts = stored if has_counts else None
        yield Block(start, part["time"], part["pulse"], part["flag"], part["gyro_flag"], counts, raw)


def _shown(value: object) -> str:
    """A value from elsewhere, short."""
    return " ".join(str(value).split())[:100]


def problem_of(path: Path, error: Exception) -> str:
    """Why a file could not be opened, in words: HDF5's own message is long and names its internals."""
    if not path.exists():
        return "no such file"
    if path.is_dir():
        return "a folder"
    if isinstance(error, OSError) and error.errno is not None:
        return os.strerror(error.errno)
    return "a truncated file" if "truncated file" in str(error) else "a file that is not HDF5"
