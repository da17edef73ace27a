"""A dataset that came from elsewhere, looked at before anything is read from it.

Refused: links to other files, data that lie in other files, filters that would load code, and shapes that
would fill the memory. Only the file's own directory of objects is read, no data.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

#: Filters that HDF5 has built in: gzip, shuffle, fletcher32. Others are loaded from outside.
_FILTERS = (1, 2, 3)
_MOST_OBJECTS = 10_000
_DEEPEST = 32
#: gzip packs no better than 1 in 1,032.
_LARGEST_RATIO = 1100
_SMALL_BYTES = 1 << 24


def hdf5_problems(path: Path) -> tuple[list[str], str | None]:
    """What a dataset's file must not have, each in words; and the version id that it carries."""
    import h5py

    try:
        with h5py.File(path, "r") as file:
            found = file.attrs.get("version_id")
            problems = list(_problems(file, h5py, path.stat().st_size))
            return problems, found if isinstance(found, str) else None
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, ArithmeticError, MemoryError) as error:
        return [f"a file that HDF5 does not read ({' '.join(str(error).split())[:100]})"], None


def _problems(file: Any, h5py: Any, size: int) -> Iterator[str]:
    todo = [(file, 0)]
    seen = 0
    while todo:
        group, depth = todo.pop()
        for name in group:
            seen += 1
            if seen > _MOST_OBJECTS or depth > _DEEPEST:
                yield "objects without end"
                return
            link = group.get(name, getlink=True)
            if not isinstance(link, h5py.HardLink):
                kind = "another file" if isinstance(link, h5py.ExternalLink) else "another place"
                yield f"{name!r}, a link to {kind}"
                continue
            item = group[name]
            if isinstance(item, h5py.Group):
                todo.append((item, depth + 1))
            elif isinstance(item, h5py.Dataset):
                yield from _dataset_problems(name, item, size)


def _dataset_problems(name: str, dataset: Any, size: int) -> Iterator[str]:
    if dataset.external or dataset.is_virtual:
        yield f"{name!r}, whose data lie in another file"
        return
    creation = dataset.id.get_create_plist()
    filters = [creation.get_filter(k)[0] for k in range(creation.get_nfilters())]
    if unknown := [number for number in filters if number not in _FILTERS]:
        yield f"{name!r}, packed with filter {unknown[0]}"
    # A shape may claim more than the file holds: what was never written reads as its fill value.
    if dataset.nbytes > _LARGEST_RATIO * size + _SMALL_BYTES:
        yield f"{name!r}, of {dataset.nbytes} bytes in a file of {size}"
