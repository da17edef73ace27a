"""Named arrays of equal length as columns: what HDF5, MATLAB and numpy files hold.

A vector is a column of its own name; a matrix of N rows (or N columns, where it is wider than high) is a
column for each of its columns, ``name[1]``, ``name[2]``, ...; a table of named fields, ``name.field``, of
which one that holds several numbers is ``name.field[1]``, ``name.field[2]``, ...
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets.readers.columns import Chunk
from fogreduce.errors import BadInput

#: Kinds of elements that can be columns: floats, integers, truth values, instants, text.
_KINDS = "fiubMOSU"


@dataclass(frozen=True)
class ArrayColumn:
    """A column: its name, how many records it has and how a part of it is read."""

    name: str
    records: int
    read: Callable[[int, int], NDArray[Any]]


def columns_of(name: str, array: Any) -> list[ArrayColumn]:
    """The columns that an array-like (shape, dtype, slices) holds; none where it is of another kind."""
    shape = tuple(array.shape)
    fields = array.dtype.names
    if fields is not None and len(shape) == 1:
        return [column for field in fields for column in _columns_of_field(name, array, field)]
    if array.dtype.kind not in _KINDS or len(shape) not in (1, 2) or 0 in shape:
        return []
    if len(shape) == 1:
        return [ArrayColumn(name, shape[0], lambda start, stop: np.asarray(array[start:stop]))]
    if 1 in shape:
        size = max(shape)
        return [ArrayColumn(name, size, _part(array, 0, shape[0] >= shape[1]))]
    upright = shape[0] >= shape[1]
    records, width = shape if upright else shape[::-1]
    return [ArrayColumn(f"{name}[{k + 1}]", records, _part(array, k, upright)) for k in range(width)]


def _part(array: Any, k: int, upright: bool) -> Callable[[int, int], NDArray[Any]]:
    if upright:
        return lambda start, stop: np.asarray(array[start:stop, k])
    return lambda start, stop: np.asarray(array[k, start:stop])


def _columns_of_field(name: str, table: Any, field: str) -> list[ArrayColumn]:
    """The columns of a table's field: one, or one for each number that it holds."""
    kind, records = table.dtype[field], table.shape[0]

    def part(*rest: int) -> Callable[[int, int], NDArray[Any]]:
        return lambda start, stop: np.asarray(table[start:stop][field][(slice(None), *rest)])

    if kind.base.kind not in _KINDS or len(kind.shape) > 1:
        return []
    if not kind.shape:
        return [ArrayColumn(f"{name}.{field}", records, part())]
    return [ArrayColumn(f"{name}.{field}[{k + 1}]", records, part(k)) for k in range(kind.shape[0])]


def of_one_length(
    columns: Sequence[ArrayColumn], capture: Mapping[str, Any], path: Path
) -> list[ArrayColumn]:
    """The columns of a capture: as long as the first gyro's, below `dataset` where that is stated.

    Names may be given in full or from `dataset` on.
    """
    below = capture.get("dataset")
    if below is not None:
        prefix = str(below).strip("/").replace("/", ".")
        columns = [
            ArrayColumn(short, column.records, column.read)
            for column in columns
            if (short := _below(column.name, prefix)) is not None
        ]
        if not columns:
            raise BadInput.at(
                path.parent / "run.yaml", "capture.dataset", found=below, expected=f"what {path.name} holds"
            )
    first = (capture.get("columns") or {}).get("gyros", [None])[0]
    length = next((column.records for column in columns if column.name == first), None)
    if length is None:
        length = max((column.records for column in columns), default=0)
    return [column for column in columns if column.records == length]


def _below(name: str, prefix: str) -> str | None:
    """A name from `prefix` on; None where it does not begin so."""
    plain = name.strip("/").replace("/", ".")
    if plain == prefix:
        return prefix.rsplit(".", 1)[-1]
    rest = plain.removeprefix(prefix)
    if rest == plain or rest[:1] not in (".", "["):
        return None
    return rest[1:] if rest[0] == "." else prefix.rsplit(".", 1)[-1] + rest


def chunks_of(
    columns: Sequence[ArrayColumn], chosen: Sequence[int], records: int, size: int
) -> Iterator[Chunk]:
    """The chosen columns, `size` records at a time."""
    for start in range(0, records, size):
        stop = min(start + size, records)
        yield [columns[k].read(start, stop).ravel() for k in chosen]
