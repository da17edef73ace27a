"""Outputs that appear whole under their name or not at all: write beside, then rename."""

from __future__ import annotations

import glob
import os
import shutil
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


class TemporaryFile:
    """A temporary name in the folder of `target`; `finish` renames it onto the target or removes it."""

    def __init__(self, target: Path) -> None:
        self.target = target
        target.parent.mkdir(parents=True, exist_ok=True)
        sweep(target)
        self.path = target.with_name(f".{target.name}.{os.getpid()}.tmp")

    def finish(self, *, keep: bool) -> None:
        """Rename onto the target, or remove."""
        try:
            if keep:
                self.path.replace(self.target)
        except OSError as error:
            raise naming(error, self.target) from None
        finally:
            self.path.unlink(missing_ok=True)


def sweep(target: Path) -> None:
    """Remove what killed processes left behind on their way to `target`."""
    for path in target.parent.glob(f".{glob.escape(target.name)}.*.tmp"):
        pid = path.name.split(".")[-2]
        if pid.isdigit() and not _lives(int(pid)):
            if path.is_dir():
                shutil.rmtree(path, ignore_errors=True)
            else:
                path.unlink(missing_ok=True)


def _lives(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except (ProcessLookupError, OverflowError):
        return False
    except OSError:  # another user's
        pass
    return True


def naming(error: OSError, target: Path) -> OSError:
    """The same error of the system, short, and with the name of the file that was to be written."""
    text = str(error) if error.errno is None else os.strerror(error.errno)
    return OSError(error.errno, text, str(target))


@contextmanager
def whole_file(target: Path) -> Iterator[Path]:
    """A temporary path to write to; it becomes `target` when the block ends without an error."""
    temporary = TemporaryFile(target)
    try:
        yield temporary.path
    except OSError as error:
        temporary.finish(keep=False)
        raise naming(error, target) from None
    except BaseException:
        temporary.finish(keep=False)
        raise
    temporary.finish(keep=True)


def write_text(target: Path, text: str) -> None:
    """Write a whole text file (UTF-8)."""
    with whole_file(target) as path:
        path.write_text(text, encoding="utf-8", newline="\n")
