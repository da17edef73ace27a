"""A dataset that came from elsewhere, looked at before anything is read from it.

Refused: links to other files, data that lie in other files, filters that would load code, and shapes that
would fill the memory. Only the file's own directory of objects is read, no data. It is read in a process
apart: a spoilt file can keep the HDF5 library busy for ever, or end its process.
"""

from __future__ import annotations

import multiprocessing
import resource
import signal
from collections.abc import Iterator, Sequence
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

#: Filters that HDF5 has built in: gzip, shuffle, fletcher32. Others are loaded from outside.
_FILTERS = (1, 2, 3)
_MOST_OBJECTS = 10_000
_DEEPEST = 32
#: gzip packs no better than 1 in 1,032.
_LARGEST_RATIO = 1100
_SMALL_BYTES = 1 << 24


#: What a file may take of processor time and of memory; ours take a thousandth of it.
_LONGEST_S = 2.0
_MOST_MEMORY_BYTES = 1 << 32
_UNREAD = "a file that HDF5 does not read"

#: What a dataset's file must not have, each in words; and the version id that it carries.
Looked = tuple[list[str], str | None]


def look_at(paths: Sequence[Path]) -> dict[Path, Looked]:
    """What each dataset's file must not have, each in words; and the version id that it carries."""
    import h5py  # noqa: F401  before the fork, so that it is imported once

    fork = multiprocessing.get_context("fork")
    found: dict[Path, Looked] = {}
    while left := [path for path in paths if path not in found]:
        answers, sends = fork.Pipe(duplex=False)
        process = fork.Process(target=_look_apart, args=(left, sends), daemon=True)
        process.start()
        sends.close()
        try:
            for path in left:
                found[path] = answers.recv()
        except EOFError:
            found[path] = [f"{_UNREAD} (the attempt did not end)"], None
        finally:
            process.join()
            answers.close()
    return found


def _look_apart(paths: Sequence[Path], sends: Connection) -> None:
    _, most = resource.getrlimit(resource.RLIMIT_AS)
    limit = _MOST_MEMORY_BYTES if most == resource.RLIM_INFINITY else min(_MOST_MEMORY_BYTES, most)
    resource.setrlimit(resource.RLIMIT_AS, (limit, most))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    # The process ends by the signal itself: no handler of Python's would be called inside the library.
    signal.signal(signal.SIGPROF, signal.SIG_DFL)
    for path in paths:
        signal.setitimer(signal.ITIMER_PROF, _LONGEST_S)
        sends.send(_look(path))


def _look(path: Path) -> Looked:
    import h5py

    try:
        with h5py.File(path, "r") as file:
            found = file.attrs.get("version_id")
            problems = list(_problems(file, h5py, path.stat().st_size))
            return problems, found if isinstance(found, str) else None
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, ArithmeticError, MemoryError) as error:
        return [f"{_UNREAD} ({' '.join(str(error).split())[:100]})"], None


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
