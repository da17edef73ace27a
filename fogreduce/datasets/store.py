"""Writes datasets as netCDF-4-conforming HDF5, block by block, without importing xarray.

The file is laid out by h5py: dimension scales, coordinates, CF attributes. Where variables are contiguous
(the default) their bytes then go straight to their places in the file, from a thread beside the
arithmetic; where they are chunked or compressed, h5py writes them.
"""

from __future__ import annotations

import io
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import h5py
import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets.atomic import TemporaryFile, naming
from fogreduce.datasets.hold import signals_held
from fogreduce.datasets.templates import Attributes, Variable
from fogreduce.datasets.worker import Worker

if TYPE_CHECKING:
    from _typeshed import ReadableBuffer as Buffer


#: Larger pieces of a file begin at multiples of eight bytes, so that readers may map them.
_ALIGNED = {"alignment_threshold": 256, "alignment_interval": 8}


@dataclass(frozen=True)
class Storage:
    """Layout: records in a chunk (0 = contiguous) and gzip level (None = not compressed)."""

    chunk_records: int = 0
    gzip_level: int | None = None


class DatasetWriter:
    """One dataset on disk; it appears under its name when the `with` block ends well.

    Parameters
    ----------
    path : Path
    sizes : mapping
        Length of each dimension.
    coordinates : mapping
        Labels of dimensions that have them (``gyro``, ``axis``).
    variables : sequence of Variable
    attributes : mapping
        Global attributes.
    storage : Storage
    """

    def __init__(
        self,
        path: Path,
        sizes: Mapping[str, int],
        coordinates: Mapping[str, Sequence[str]],
        variables: Sequence[Variable],
        attributes: Attributes,
        storage: Storage,
    ) -> None:
        self._target = TemporaryFile(path)
        self._sizes = sizes
        self._coordinates = coordinates
        self._variables = {variable.name: variable for variable in variables}
        self._attributes = attributes
        self._storage = storage
        self._offsets: dict[str, int] = {}

    def __enter__(self) -> DatasetWriter:
        try:
            with signals_held():
                self._disk = _NotingFile(self._target.path, "w+")
                self._file = h5py.File(
                    self._disk, "w", libver=("earliest", "v110"), track_order=True, **_ALIGNED
                )
                datasets = self._lay_out()
                if not self._storage.chunk_records:
                    self._offsets = {name: datasets[name].id.get_offset() for name in self._variables}
                    datasets.clear()  # what is open would keep the file open
                    self._close_file()
            if not self._storage.chunk_records:
                self._raw = _PlacedWriter(self._target)
        except OSError as error:
            self._target.finish(keep=False)
            raise naming(error, self._target.target) from None
        except BaseException:
            self._target.finish(keep=False)
            raise
        return self

    def _lay_out(self) -> dict[str, h5py.Dataset]:
        file = self._file
        _describe(file, self._attributes)
        datasets = {}
        for variable in self._variables.values():
            shape = tuple(self._sizes[dim] for dim in variable.dims)
            dataset = datasets[variable.name] = self._create(variable, shape)
            _describe(dataset, variable.attributes)
        for dim, labels in self._coordinates.items():
            datasets[dim] = file.create_dataset(dim, data=list(labels), dtype=h5py.string_dtype())
        for number, dim in enumerate(self._sizes):
            datasets[dim].make_scale(dim)
            datasets[dim].attrs["_Netcdf4Dimid"] = np.int32(number)
        for variable in self._variables.values():
            for position, dim in enumerate(variable.dims):
                if variable.name != dim:
                    h5py.h5ds.attach_scale(datasets[variable.name].id, datasets[dim].id, position)
        return datasets

    def _create(self, variable: Variable, shape: tuple[int, ...]) -> h5py.Dataset:
        options: dict[str, Any] = {"shape": shape, "dtype": variable.dtype, "track_times": False}
        fill = variable.attributes.get("_FillValue")
        if self._storage.chunk_records:
            options["chunks"] = (*shape[:-1], min(self._storage.chunk_records, shape[-1]))
            if self._storage.gzip_level is not None:
                options |= {"compression": "gzip", "compression_opts": self._storage.gzip_level}
                options |= {"shuffle": True}
            return self._file.create_dataset(variable.name, fillvalue=fill, **options)
        properties = _contiguous()
        if fill is not None:
            properties = properties.copy()
            properties.set_fill_value(np.asarray(fill))
        kind = h5py.h5t.py_create(np.dtype(variable.dtype))
        space = h5py.h5s.create_simple(shape)
        identifier = h5py.h5d.create(self._file.id, variable.name.encode(), kind, space, dcpl=properties)
        return h5py.Dataset(identifier)

    def write(self, name: str, start: int, values: NDArray[Any]) -> None:
        """Write a variable from record `start` on; `values` (..., N) must not change afterwards."""
        variable = self._variables[name]
        values = np.ascontiguousarray(values, dtype=variable.dtype)
        if self._storage.chunk_records:
            with signals_held():
                self._file[name][..., start : start + values.shape[-1]] = values
            if self._disk.error is not None:
                raise naming(self._disk.error, self._target.target)
            return
        size = values.dtype.itemsize
        length = self._sizes[variable.dims[-1]]
        for row, line in enumerate(np.atleast_2d(values)):
            self._raw.put(self._offsets[name] + size * (row * length + start), line)

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        try:
            if self._storage.chunk_records:
                self._close_file()
            else:
                self._raw.close()
        except OSError as closing:
            self._target.finish(keep=False)
            raise naming(closing, self._target.target) from None
        except BaseException:
            self._target.finish(keep=False)
            raise
        self._target.finish(keep=kind is None)

    def _close_file(self) -> None:
        with signals_held():
            self._file.close()
            self._disk.close()
        if self._disk.error is not None:
            raise self._disk.error


@cache
def _contiguous() -> h5py.h5p.PropDCID:
    """Space allocated at once and not filled: every byte of it is written by `DatasetWriter.write`."""
    properties = h5py.h5p.create(h5py.h5p.DATASET_CREATE)
    properties.set_layout(h5py.h5d.CONTIGUOUS)
    properties.set_alloc_time(h5py.h5d.ALLOC_TIME_EARLY)
    properties.set_fill_time(h5py.h5d.FILL_TIME_NEVER)
    properties.set_obj_track_times(False)
    properties.set_attr_creation_order(h5py.h5p.CRT_ORDER_TRACKED | h5py.h5p.CRT_ORDER_INDEXED)
    return properties


@cache
def _text_type() -> h5py.h5t.TypeID:
    return h5py.h5t.py_create(h5py.string_dtype(), logical=True)


def _describe(owner: h5py.HLObject, attributes: Attributes) -> None:
    """Write attributes, none of which is there yet.

    Texts, of which a dataset has some hundreds, go past `attrs`, which looks whether there is one to replace.
    """
    for name, value in attributes.items():
        if not isinstance(value, str) and not (isinstance(value, list) and isinstance(value[0], str)):
            owner.attrs[name] = value
            continue
        text = np.array(value, h5py.string_dtype())
        space = h5py.h5s.create_simple(text.shape) if text.shape else h5py.h5s.create(h5py.h5s.SCALAR)
        h5py.h5a.create(owner.id, name.encode(), _text_type(), space).write(text)


class _NotingFile(io.FileIO):
    """A file for HDF5 that keeps its first error of writing to itself and goes on as if nothing were wrong.

    HDF5, once told that a disk is full, can neither close the file nor end the process in good order.
    """

    error: OSError | None = None

    def write(self, data: Buffer, /) -> int:
        view = memoryview(data).cast("B")
        end = self.tell() + len(view)
        try:
            while len(view) and self.error is None:
                view = view[super().write(view) :]
        except OSError as error:
            self.error = error
        self.seek(end)
        return len(memoryview(data).cast("B"))

    def truncate(self, size: int | None = None, /) -> int:
        try:
            return super().truncate(size)
        except OSError as error:
            self.error = self.error or error
            return size or 0


class _PlacedWriter:
    """Writes arrays at given offsets of a file, in a thread (the system call lets the arithmetic go on)."""

    #: Pieces of at most a block's row: few, so that memory is the same whether the disk is quick or slow.
    _MOST_WAITING = 16

    def __init__(self, file: TemporaryFile) -> None:
        self._target = file.target
        self._descriptor = os.open(file.path, os.O_WRONLY)
        self._worker = Worker(self._MOST_WAITING)

    def put(self, offset: int, values: NDArray[Any]) -> None:
        self._worker.do(lambda: self._write(offset, memoryview(values.data).cast("B")))

    def _write(self, offset: int, view: memoryview) -> None:
        try:
            while len(view):
                written = os.pwrite(self._descriptor, view, offset)
                view, offset = view[written:], offset + written
        except OSError as error:
            raise naming(error, self._target) from None

    def close(self) -> None:
        try:
            self._worker.close()
        finally:
            os.close(self._descriptor)
