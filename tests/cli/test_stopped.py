"""A command that is stopped in the middle: no traceback, exit status 1, and nothing half written."""

import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from small_lab import header, records

COMMAND = str(Path(sys.executable).with_name("fogreduce"))
PATIENCE_S = 60


def temporary_files(folder: Path) -> list[Path]:
    return list(folder.rglob("*.tmp"))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_stopped_by_a_signal(small_lab, number):
    """In a record long enough (a million records) to be met while its datasets are being written."""
    small_lab.write_run({"table.profile": [{"rate_deg_s": 0.01, "duration_s": 62_500.0}]})
    small_lab.write_capture(header(), records(1_000_000).tobytes())
    process = subprocess.Popen(
        [COMMAND, *small_lab.reduce()],
        stderr=subprocess.PIPE,
        text=True,
        # where the tests run in the background, SIGINT is ignored, and so it would be here
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    until = time.monotonic() + PATIENCE_S
    while not temporary_files(small_lab.root) and time.monotonic() < until and process.poll() is None:
        time.sleep(0.001)
    assert process.poll() is None, "ended before it was stopped"
    process.send_signal(number)
    _, said = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, said) == (1, "stopped\n")
    assert temporary_files(small_lab.root) == []
    assert [path for path in small_lab.out.rglob("*") if path.is_file()] == []


def test_killed_and_run_again(small_lab):
    """Killed without a chance to tidy up: nothing stands under its own name; the next attempt succeeds."""
    small_lab.write_run({"table.profile": [{"rate_deg_s": 0.01, "duration_s": 62_500.0}]})
    small_lab.write_capture(header(), records(1_000_000).tobytes())
    process = subprocess.Popen([COMMAND, *small_lab.reduce()])
    until = time.monotonic() + PATIENCE_S
    while not temporary_files(small_lab.root) and time.monotonic() < until and process.poll() is None:
        time.sleep(0.001)
    process.kill()
    process.wait()
    left = [path for path in small_lab.out.rglob("*") if path.is_file()]
    assert left == temporary_files(small_lab.out)
    subprocess.run([COMMAND, *small_lab.reduce()], check=True)
    assert (small_lab.out / "tables" / "drift.csv").exists()
    assert (small_lab.out / "manifest.json").exists()
