"""One command in a forked process of its own, with bounds on memory, time and the size of files."""

from __future__ import annotations

import contextlib
import io
import os
import resource
import select
import signal
import sys
import tempfile
import traceback
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from fogreduce.cli.main import main
from fogreduce.errors import FogreduceError

#: A command line, or a function that reads what a command reads.
Command = Sequence[str] | Callable[[], object]

MORE_MEMORY_BYTES = 300 << 20
CPU_S = 10
WALL_S = 120
LARGEST_FILE_BYTES = 64 << 20
UNEXPECTED = 70


@dataclass(frozen=True)
class Outcome:
    """What became of a command.

    Attributes
    ----------
    status : int
        Exit status; minus the signal's number where one ended it; `UNEXPECTED` for an exception that
        `main` let through.
    out, err : str
        What it said.
    cpu_s, peak_mb : float
        Processor time, and largest resident memory (what the fork began with counted).
    """

    status: int
    out: str
    err: str
    cpu_s: float
    peak_mb: float


def warm(commands: Sequence[Command]) -> None:
    """Run commands in this process, so that those forked from it need import nothing."""
    with contextlib.redirect_stdout(io.StringIO()), contextlib.redirect_stderr(io.StringIO()):
        for command in commands:
            assert called(command) == 0


def attempt(command: Command) -> Outcome:
    """Run a command to its end, or to the end of what it may use."""
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        child = os.fork()
        if child == 0:
            _run(command, out.fileno(), err.fileno())
        watch = os.pidfd_open(child)
        try:
            if not select.select([watch], [], [], WALL_S)[0]:
                os.kill(child, signal.SIGKILL)
        finally:
            os.close(watch)
        _, status, usage = os.wait4(child, 0)
        said = [_text(out.fileno()), _text(err.fileno())]
    spent = usage.ru_utime + usage.ru_stime
    return Outcome(os.waitstatus_to_exitcode(status), *said, spent, usage.ru_maxrss / 1024)


def _text(descriptor: int) -> str:
    return os.pread(descriptor, 1 << 20, 0).decode("utf-8", "replace")


def _run(command: Command, out: int, err: int) -> None:
    """In the child; never returns."""
    status = UNEXPECTED
    try:
        for source, target in ((out, 1), (err, 2)):
            os.dup2(source, target)
        sys.stdout = os.fdopen(1, "w", closefd=False)
        sys.stderr = os.fdopen(2, "w", closefd=False)
        held = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        for kind, limit in (
            (resource.RLIMIT_AS, held + MORE_MEMORY_BYTES),
            (resource.RLIMIT_CPU, CPU_S),
            (resource.RLIMIT_FSIZE, LARGEST_FILE_BYTES),
            (resource.RLIMIT_CORE, 0),
        ):
            resource.setrlimit(kind, (limit, limit))
        status = called(command)
    except SystemExit as end:
        status = end.code if isinstance(end.code, int) else 1
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)


def called(command: Command) -> int:
    """The exit status of a command called in this process."""
    if not callable(command):
        return main(command)
    try:
        command()
    except FogreduceError as error:
        print(error, file=sys.stderr)
        return error.exit_status
    return 0
