"""One writer of a folder at a time: the second is told who is at work, and the lock ends with its process."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from fogreduce.datasets.sole_writer import WORKFLOW, lock_file, sole_writer, writers_inside
from fogreduce.errors import BadInput

HOLD = """
import sys
from pathlib import Path
from fogreduce.datasets.sole_writer import sole_writer
with sole_writer(Path(sys.argv[1])):
    print("locked", flush=True)
    sys.stdin.read()
"""


class Writer:
    """Another process that writes a folder until it is ended."""

    def __init__(self, folder: Path, **environment: str) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", HOLD, str(folder)],
            env={**os.environ, **environment},
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self.process.stdout is not None
        self.locked = self.process.stdout.readline() == "locked\n"

    def __enter__(self) -> Writer:
        return self

    def __exit__(self, *_: object) -> None:
        self.process.communicate()


def test_the_second_is_told_who_is_at_work(tmp_path: Path) -> None:
    folder = tmp_path / "results"
    with Writer(folder) as first, pytest.raises(BadInput) as told, sole_writer(folder):
        pass
    text = str(told.value)
    assert text.startswith(f"{folder}: found process {first.process.pid} on {os.uname().nodename}, since 20")
    assert "one writer at a time" in text


def test_nothing_is_left(tmp_path: Path) -> None:
    with sole_writer(tmp_path / "new" / "results"):
        assert lock_file(tmp_path / "new" / "results").is_file()
    assert list(tmp_path.iterdir()) == []


def test_a_killed_writer_stands_in_nobodys_way(tmp_path: Path) -> None:
    folder = tmp_path / "results"
    with Writer(folder) as first:
        first.process.send_signal(signal.SIGKILL)
        first.process.wait()
        assert lock_file(folder).is_file()
        with sole_writer(folder):
            pass
    assert not lock_file(folder).exists()


def test_a_folder_in_a_folder_that_is_written(tmp_path: Path) -> None:
    with (
        Writer(tmp_path / "results"),
        pytest.raises(BadInput, match="one writer"),
        sole_writer(tmp_path / "results" / "lab" / "1"),
    ):
        pass


def test_folders_side_by_side(tmp_path: Path) -> None:
    with Writer(tmp_path / "a") as first, sole_writer(tmp_path / "b"):
        assert first.locked


def test_jobs_of_a_workflow_share(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(WORKFLOW, str(os.getpid()))
    with Writer(tmp_path / "results"), Writer(tmp_path / "results" / "run") as job:
        with sole_writer(tmp_path / "results" / "run"):
            assert job.locked
        # The other job still holds it: a command of no workflow is told.
        monkeypatch.delenv(WORKFLOW)
        assert lock_file(tmp_path / "results" / "run").is_file()
        with pytest.raises(BadInput), sole_writer(tmp_path / "results" / "run"):
            pass


def test_writers_inside(tmp_path: Path) -> None:
    with Writer(tmp_path / "results" / "lab" / "1") as writer:
        found = writers_inside(tmp_path / "results", depth=2)
        assert len(found) == 1
        assert f"process {writer.process.pid}" in found[0]
    assert writers_inside(tmp_path / "results", depth=2) == []


def test_a_file_system_without_locks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def none(*_: object) -> None:
        raise OSError(38, "Function not implemented")

    monkeypatch.setattr("fcntl.flock", none)
    with sole_writer(tmp_path / "results"):
        pass
    said = capsys.readouterr().err
    assert said.count("no locks on this file system (Function not implemented)") == 1
    assert list(tmp_path.iterdir()) == []
