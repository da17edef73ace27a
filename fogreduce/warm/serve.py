"""The server's side: take a command with its streams, fork, tell how it ended.

One process, one thread: a fork copies no lock that someone holds.  A child ends when its client does (the
connection closes) and when the server does (PR_SET_PDEATHSIG); the server when its workflow does (its
standard input closes).
"""

from __future__ import annotations

import contextlib
import ctypes
import gc
import importlib
import os
import selectors
import signal
import socket
import struct
import sys
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

SOCKET = "socket"
#: What is imported before the first fork: all that the nodes of every run import, late or not.
ALWAYS = (
    *(f"fogreduce.cli.{name}" for name in ("manifest", "stage", "checksums", "warnings", "flags")),
    "fogreduce.datasets.readers.fogcap",
    "fogreduce.pages.rate_flags",
    "fogreduce.provenance.manifest",
    "fogreduce.provenance.versions",
    "fogreduce.stages.nodes.calibrate",
    "fogreduce.stages.nodes.remove_earth",
    "fogreduce.stages.run",
    "fogreduce.stages.summary",
    "numpy.fft",
    "numpy.ma",
    "numpy.polynomial",
)
#: Command -> what is imported before its first fork.
PER_COMMAND = {
    "figures": ("fogreduce.figures.catalogue", "fogreduce.figures.results", "fogreduce.figures.save"),
    "diagnose": ("fogreduce.diagnosis.diagnose", "fogreduce.diagnosis.report.write"),
    "page": ("fogreduce.pages.overview", "fogreduce.pages.run_page"),
    "simulate": ("fogreduce.simulate.campaign", "fogreduce.simulate.plan"),
}
_LARGEST_REQUEST_BYTES = 1 << 24
_PR_SET_PDEATHSIG = 1
#: How long a command that was told to stop may tidy up.
_GRACE_S = 10.0
_STOP = (signal.SIGTERM, signal.SIGINT)
_libc = ctypes.CDLL(None, use_errno=True)


@dataclass
class Job:
    """A command that runs for a client."""

    pid: int
    connection: socket.socket
    stopped_at: float | None = None

    def stop(self) -> None:
        """Tell it to stop, as Ctrl-C does; for good when it was told long ago."""
        if self.stopped_at is None:
            self.stopped_at = time.monotonic()
            os.kill(self.pid, signal.SIGTERM)
        elif time.monotonic() - self.stopped_at > _GRACE_S:
            os.kill(self.pid, signal.SIGKILL)


class Server:
    """Serves until its standard input closes.

    Parameters
    ----------
    folder : Path
        Private folder, in which the socket is made.
    command : callable
        Runs a command line; its exit status.
    """

    def __init__(self, folder: Path, command: Callable[[list[str]], int]) -> None:
        self._command = command
        self._listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._listener.bind(str(folder / SOCKET))
        self._listener.listen(512)
        self._pid = os.getpid()
        self._jobs: dict[int, Job] = {}
        self._warm: set[str] = set()
        # A child's end wakes the selector.
        self._ended, ended = socket.socketpair()
        for end in (self._ended, ended):
            end.setblocking(False)
        self._wakeup = ended
        signal.set_wakeup_fd(ended.fileno(), warn_on_full_buffer=False)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.signal(signal.SIGTERM, signal.default_int_handler)

    def run(self) -> None:
        """Serve."""
        self._import(ALWAYS)
        _know_the_machine()
        with selectors.DefaultSelector() as selector, self._listener:
            self._selector = selector
            selector.register(self._listener, selectors.EVENT_READ, self._accept)
            selector.register(self._ended, selectors.EVENT_READ, self._reap)
            selector.register(sys.stdin.fileno(), selectors.EVENT_READ, None)
            try:
                while True:
                    for key, _ in selector.select(1.0 if self._stopping() else None):
                        if key.data is None:  # the workflow has gone
                            return
                        key.data(key.fileobj)
                    for job in self._stopping():
                        job.stop()
            finally:
                self._end_all()

    def _stopping(self) -> list[Job]:
        return [job for job in self._jobs.values() if job.stopped_at is not None]

    def _import(self, modules: Sequence[str]) -> None:
        for module in modules:
            importlib.import_module(module)
        if len(os.listdir("/proc/self/task")) > 1:  # noqa: PTH208
            raise RuntimeError("a module that is imported starts a thread: a fork would copy its locks")
        gc.collect()
        gc.freeze()

    def _accept(self, listener: socket.socket) -> None:
        connection, _ = listener.accept()
        try:
            connection.settimeout(10.0)
            fields, streams, stop = _request(connection)
        except (OSError, ValueError):
            connection.close()
            return
        try:
            words = fields[1 : 1 + int(fields[0])]
            command = os.fsdecode(words[0]) if words else ""
            if command in PER_COMMAND and command not in self._warm:
                self._warm.add(command)
                with contextlib.suppress(ImportError):  # the command will say so itself
                    self._import(PER_COMMAND[command])
            # A signal must find the child ready for it.
            signal.pthread_sigmask(signal.SIG_BLOCK, _STOP)
            pid = os.fork()
            if pid == 0:
                self._child(fields, streams)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOP)
            connection.settimeout(None)
            self._jobs[pid] = Job(pid, connection)
            self._selector.register(connection, selectors.EVENT_READ, self._heard)
            with contextlib.suppress(OSError):
                connection.sendall(b"+")
            if stop:
                self._jobs[pid].stop()
        finally:
            for stream in streams:
                os.close(stream)

    def _heard(self, connection: socket.socket) -> None:
        """A client says stop, or is gone."""
        job = next((job for job in self._jobs.values() if job.connection is connection), None)
        if job is None:  # ended in the same instant
            return
        try:
            gone = not connection.recv(16)
        except OSError:
            gone = True
        if gone:
            self._selector.unregister(connection)
        job.stop()

    def _reap(self, ended: socket.socket) -> None:
        with contextlib.suppress(BlockingIOError):
            ended.recv(4096)
        for pid in list(self._jobs):
            found, status = os.waitpid(pid, os.WNOHANG)
            if found:
                job = self._jobs.pop(pid)
                with contextlib.suppress(KeyError):
                    self._selector.unregister(job.connection)
                code = os.waitstatus_to_exitcode(status)
                with contextlib.suppress(OSError):
                    job.connection.sendall(code.to_bytes(4, "little", signed=True))
                job.connection.close()

    def _end_all(self) -> None:
        for job in self._jobs.values():
            job.stop()
        until = time.monotonic() + _GRACE_S
        while self._jobs and time.monotonic() < until:
            self._reap(self._ended)
            time.sleep(0.01)
        for job in self._jobs.values():
            os.kill(job.pid, signal.SIGKILL)

    def _child(self, fields: list[bytes], streams: Sequence[int]) -> None:
        """The forked process: the command, in the client's place. Never returns."""
        status = 1
        try:
            _libc.prctl(_PR_SET_PDEATHSIG, signal.SIGTERM)
            if os.getppid() != self._pid:
                os._exit(1)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOP)
            signal.set_wakeup_fd(-1)
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            self._selector.close()
            for end in (self._listener, self._ended, self._wakeup):
                end.close()
            for job in self._jobs.values():
                job.connection.close()
            for number, stream in enumerate(streams):
                os.dup2(stream, number)
            status = _run(fields, self._command)
        except BaseException:
            import traceback

            traceback.print_exc()
        finally:
            with contextlib.suppress(Exception):
                sys.stdout.flush()
                sys.stderr.flush()
            os._exit(status)


def _know_the_machine() -> None:
    """What the last node of every run records; finding it out takes 15 ms."""
    from fogreduce.provenance.code import code_digest
    from fogreduce.provenance.machine import machine

    machine()
    code_digest()  # reads the sources, and keeps what they say


def _request(connection: socket.socket) -> tuple[list[bytes], list[int], bool]:
    """A client's request, its three streams, and whether it says stop already; only the same user may ask."""
    _, user, _ = struct.unpack("3i", connection.getsockopt(socket.SOL_SOCKET, socket.SO_PEERCRED, 12))
    if user != os.getuid():
        raise ValueError(f"user {user}")
    data, streams, _, _ = socket.recv_fds(connection, 1 << 16, 3)
    try:
        while len(data) < 8 or len(data) < 8 + int.from_bytes(data[:8], "little"):
            if not (more := connection.recv(1 << 16)) or len(data) > _LARGEST_REQUEST_BYTES:
                raise ValueError("a request that breaks off")
            data += more
        if len(streams) != 3:
            raise ValueError(f"{len(streams)} streams")
    except BaseException:
        for stream in streams:
            os.close(stream)
        raise
    end = 8 + int.from_bytes(data[:8], "little")
    return data[8:end].split(b"\0"), streams, len(data) > end


def _run(fields: list[bytes], command: Callable[[list[str]], int]) -> int:
    """Run a request's command in this process; its exit status."""
    count = int(fields[0])
    words = [os.fsdecode(word) for word in fields[1 : 1 + count]]
    folder, mask = fields[1 + count : 3 + count]
    os.chdir(folder)
    os.umask(int(mask))
    for name in set(os.environ):
        del os.environ[name]
    for entry in fields[3 + count :]:
        variable, _, value = entry.partition(b"=")
        os.environb[variable] = value
    sys.argv = ["fogreduce", *words]
    # As in a process of its own: lines appear at once on a terminal.
    sys.stdout.reconfigure(line_buffering=sys.stdout.isatty())  # type: ignore[union-attr]
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        return command(words)
    except SystemExit as end:  # argparse
        return end.code if isinstance(end.code, int) else 1
