"""One writer of a folder at a time: a lock of the kernel, which ends with its process, however that ends."""

from __future__ import annotations

import fcntl
import os
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from fogreduce.errors import BadInput

#: Process id of the workflow that a command belongs to, in the environment of the workflow's jobs.
WORKFLOW = "FOGREDUCE_WORKFLOW"


class NoLocks(OSError):
    """A file system without locks of the kernel."""


@contextmanager
def sole_writer(folder: Path) -> Iterator[None]:
    """Be the only one who writes into a folder, until the block ends.

    The lock is on the file ``.<folder>.lock`` beside the folder, which says who holds it. Locks of the
    folders that the folder lies in count as well. A job of a workflow, whose workflow holds the results as a
    whole, shares its lock with the workflow's other jobs.

    Parameters
    ----------
    folder : Path
        The folder to write into; it need not exist.

    Raises
    ------
    BadInput
        If another process writes there: its host, process id and since when.
    """
    folder = folder.resolve()
    made = [path for path in folder.parents if not path.exists()]
    folder.parent.mkdir(parents=True, exist_ok=True)
    in_workflow = WORKFLOW in os.environ
    with ExitStack() as locks:
        locks.callback(_remove_empty, made)
        try:
            if not in_workflow:
                for parent in folder.parents[:-1]:
                    if lock_file(parent).is_file():
                        locks.enter_context(_locked(parent, shared=True))
            locks.enter_context(_locked(folder, shared=in_workflow))
        except NoLocks as error:
            print(f"{folder}: {error}; see to it that nothing else writes there", file=sys.stderr)
        yield


def lock_file(folder: Path) -> Path:
    """The file that is locked while a folder is written."""
    return folder.with_name(f".{folder.name}.lock")


def writers_inside(folder: Path, depth: int) -> list[str]:
    """Who writes into folders inside this one now, down to a depth of folders, as one line each."""
    found = []
    for level in range(depth):
        for path in folder.glob("*/" * level + ".*.lock"):
            inner = path.with_name(path.name[1 : -len(".lock")])
            try:
                with _locked(inner, shared=False):
                    pass
            except BadInput as error:
                found.append(str(error))
            except NoLocks:
                continue
    return found


@contextmanager
def _locked(folder: Path, *, shared: bool) -> Iterator[None]:
    path = lock_file(folder)
    descriptor = _lock(path, folder, fcntl.LOCK_SH if shared else fcntl.LOCK_EX)
    try:
        if not shared:
            os.ftruncate(descriptor, 0)
            os.pwrite(descriptor, _self().encode(), 0)
        yield
    finally:
        # Nobody else shares it: it is ours to remove.
        with suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            path.unlink()
        os.close(descriptor)


def _lock(path: Path, folder: Path, kind: int) -> int:
    """A locked file that still has its name; whoever held it before may have removed it in between."""
    while True:
        descriptor = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        try:
            fcntl.flock(descriptor, kind | fcntl.LOCK_NB)
        except BlockingIOError:
            found = (os.pread(descriptor, 500, 0).decode(errors="replace") or "another writer") + " at work"
            os.close(descriptor)
            raise BadInput.at(folder, "", found=found, expected="one writer at a time") from None
        except OSError as error:
            os.close(descriptor)
            path.unlink(missing_ok=True)
            raise NoLocks(f"no locks on this file system ({error.strerror})") from None
        with suppress(FileNotFoundError):
            if os.path.samestat(os.fstat(descriptor), path.stat()):
                return descriptor
        os.close(descriptor)


def _self() -> str:
    since = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
    return f"process {os.getpid()} on {os.uname().nodename}, since {since},"


def _remove_empty(folders: list[Path]) -> None:
    for path in folders:
        with suppress(OSError):
            path.rmdir()
