"""No command outlives its workflow; a dead workflow's locks are taken away, a live one's are not."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from small_lab import header, records

from fogreduce.cli.alone import WORKFLOW, hold

COMMAND = str(Path(sys.executable).with_name("fogreduce"))
PATIENCE_S = 60


@pytest.fixture
def state(tmp_path: Path) -> Path:
    """A folder `.snakemake` with a lock that a workflow has left which was here before."""
    state = tmp_path / ".snakemake"
    held = hold(state)
    assert held is not None
    held.close()
    (state / "locks").mkdir()
    (state / "locks" / "0.output.lock").write_text("results/x\n")
    return state


def locks(state: Path) -> list[str]:
    return sorted(path.name for path in (state / "locks").iterdir())


def test_a_dead_workflows_locks_are_removed(state: Path) -> None:
    assert hold(state) is not None
    assert locks(state) == []


def test_a_live_workflows_locks_stay(state: Path) -> None:
    first = hold(state)
    (state / "locks" / "0.output.lock").write_text("results/x\n")
    second = hold(state)
    assert locks(state) == ["0.output.lock"]
    assert first is not None
    assert second is not None
    # The first ends; the second, which holds the folder too, still stands in the way of a third.
    first.close()
    third = hold(state)
    assert third is not None
    assert locks(state) == ["0.output.lock"]


@pytest.mark.parametrize("said", ["another-machine", ""])
def test_locks_that_may_be_another_machines_stay(state: Path, said: str) -> None:
    (state / "fogreduce.lock").write_text(said)
    assert hold(state) is not None
    assert locks(state) == ["0.output.lock"]


def test_a_file_system_without_locks(state: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(*_: object) -> None:
        raise OSError(38, "Function not implemented")

    monkeypatch.setattr("fcntl.flock", none)
    assert hold(state) is None
    assert locks(state) == ["0.output.lock"]


@pytest.mark.skipif(sys.platform != "linux", reason="Linux tells of another process's end")
class TestCommand:
    def test_it_ends_with_its_workflow(self, small_lab) -> None:
        """In a record long enough (a million records) to be met while its datasets are being written."""
        small_lab.write_run({"table.profile": [{"rate_deg_s": 0.01, "duration_s": 62_500.0}]})
        small_lab.write_capture(header(), records(1_000_000).tobytes())
        with subprocess.Popen(["sleep", str(2 * PATIENCE_S)]) as workflow:
            environment = {**os.environ, WORKFLOW: str(workflow.pid)}
            process = subprocess.Popen(
                [COMMAND, *small_lab.reduce()], stderr=subprocess.PIPE, text=True, env=environment
            )
            until = time.monotonic() + PATIENCE_S
            while not list(small_lab.root.rglob("*.tmp")) and time.monotonic() < until:
                time.sleep(0.001)
            assert process.poll() is None, "ended before its workflow"
            workflow.kill()
            _, said = process.communicate(timeout=PATIENCE_S)
        assert (process.returncode, said) == (1, "stopped\n")
        assert [path for path in small_lab.out.rglob("*") if path.is_file()] == []

    def test_it_does_not_start_when_its_workflow_is_gone(self, small_lab) -> None:
        with subprocess.Popen(["true"]) as workflow:
            pass
        done = subprocess.run(
            [COMMAND, *small_lab.reduce()],
            capture_output=True,
            text=True,
            env={**os.environ, WORKFLOW: str(workflow.pid)},
            check=False,
        )
        assert (done.returncode, done.stderr) == (1, "stopped: its workflow is gone\n")
        assert not small_lab.out.exists()
