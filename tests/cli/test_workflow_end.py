"""No command outlives its workflow."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest
from small_lab import header, records

from fogreduce.datasets.sole_writer import WORKFLOW

COMMAND = str(Path(sys.executable).with_name("fogreduce"))
PATIENCE_S = 60


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
