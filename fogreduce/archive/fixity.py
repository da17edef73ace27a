"""Hash each file of a bag, each byte read once; of small files that say what others are, keep the bytes."""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Iterable
from hashlib import new
from pathlib import Path

from fogreduce.errors import Fault

_CHUNK = 1 << 20
#: The largest file that is kept: a table or a record.
LARGEST_KEPT_BYTES = 64 << 20

Keep = Callable[[str, bytes], None]


def hash_files(
    bag: Path,
    paths: Iterable[str],
    algorithms: Iterable[str],
    hashes: dict[str, dict[str, str]],
    wanted: Callable[[str], bool],
    keep: Keep,
    progress: Callable[[int], None],
) -> list[Fault]:
    """Fill `hashes`, by path and algorithm; hand the bytes of each wanted file to `keep`.

    Returns the faults of what cannot be read.
    """
    faults: list[Fault] = []
    buffer = memoryview(bytearray(_CHUNK))
    done = 0
    for path in paths:
        digests = {algorithm: new(algorithm, usedforsecurity=False) for algorithm in algorithms}
        kept: bytearray | None = bytearray() if wanted(path) else None
        try:
            descriptor = os.open(bag / path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        except OSError as error:
            faults.append(Fault(str(bag / path), "", error.strerror or str(error), "a readable file"))
            continue
        with os.fdopen(descriptor, "rb", buffering=0) as file:
            if not stat.S_ISREG(os.fstat(descriptor).st_mode):
                faults.append(Fault(str(bag / path), "", "something that is no file", "a plain file"))
                continue
            while count := file.readinto(buffer):
                for digest in digests.values():
                    digest.update(buffer[:count])
                if kept is not None:
                    kept += buffer[:count]
                    if len(kept) > LARGEST_KEPT_BYTES:
                        expected = f"at most {LARGEST_KEPT_BYTES} in such a file"
                        faults.append(Fault(str(bag / path), "", "more bytes", expected))
                        kept = None
                done += count
                progress(done)
        hashes[path] = {algorithm: digest.hexdigest() for algorithm, digest in digests.items()}
        if kept is not None:
            keep(path, bytes(kept))
    return faults
