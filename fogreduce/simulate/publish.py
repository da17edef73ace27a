"""A folder that appears whole: made under a temporary name beside its place, then moved there."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from fogreduce.datasets.atomic import sweep


@contextmanager
def published(out: Path) -> Iterator[Path]:
    """A temporary folder, which becomes `out` when the block ends well, and is removed when it does not.

    Where `out` exists already, every file takes its place there by one rename, run.yaml and logs before
    captures, and what else stands there is left alone.
    """
    whole = out.absolute()
    temporary = whole.with_name(f".{whole.name}.{os.getpid()}.tmp")
    shutil.rmtree(temporary, ignore_errors=True)
    if whole.parent.is_dir():
        sweep(whole)
    try:
        temporary.mkdir(parents=True)
        yield temporary
        try:
            temporary.rename(whole)
        except OSError:
            # Something stands there: an older output, or what another process is making beside this one.
            if not whole.is_dir():
                raise
            _move_files(temporary, whole)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)


def _move_files(source: Path, target: Path) -> None:
    files = sorted(path for path in source.rglob("*") if path.is_file())
    for path in sorted(files, key=lambda path: path.suffix == ".fogcap"):
        place = target / path.relative_to(source)
        place.parent.mkdir(parents=True, exist_ok=True)
        path.replace(place)
