"""What a simulation costs: memory of the paper's run and of one ten times as long; CPU time is printed."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
CODE = r"""
import re, sys, time
from pathlib import Path
from fogreduce.simulate.campaign import write_campaign
from fogreduce.simulate.plan import Options, prepare
plan = prepare(Path(sys.argv[1]), Path(sys.argv[2]), Options())
began = time.process_time()
write_campaign(plan, Path(sys.argv[3]))
# Not ru_maxrss, which a child takes over from the process that started it.
status = Path("/proc/self/status").read_text()
print(time.process_time() - began, int(re.search(r"VmHWM:\s*(\d+)", status)[1]) / 1024)
"""


def cost(tmp_path: Path, seconds: int) -> tuple[float, float]:
    """CPU seconds after start-up, and megabytes at most, to simulate and write four gyros at 128 Hz."""
    here = tmp_path / "campaign" / "runs" / "x-one-turn"
    here.mkdir(parents=True, exist_ok=True)
    source = ROOT / "campaigns" / "one-turn-each" / "runs" / "x-one-turn"
    text = (source / "run.yaml").read_text().replace("duration_s: 6000", f"duration_s: {seconds}")
    (here / "run.yaml").write_text(text)
    (here / "temperature.csv").write_bytes((source / "temperature.csv").read_bytes())
    arguments = [str(tmp_path / "campaign"), str(ROOT / "calibrations"), str(tmp_path / "out")]
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [sys.executable, "-c", CODE, *arguments], capture_output=True, text=True, check=True, env=environment
    )
    capture = tmp_path / "out" / "runs" / "x-one-turn" / "capture.fogcap"
    assert capture.stat().st_size == 64 + seconds * 128 * 28
    capture.unlink()
    cpu, megabytes = done.stdout.split()
    return float(cpu), float(megabytes)


@pytest.mark.slow
def test_the_papers_run(tmp_path: Path) -> None:
    """768 000 records of four gyros, all nominal noise: under 250 MB."""
    cpu, megabytes = min(cost(tmp_path, 6000) for _ in range(3))
    print(f"100 minutes: {cpu:.2f} s, {megabytes:.0f} MB")
    assert megabytes < 250


@pytest.mark.slow
def test_ten_times_as_long(tmp_path: Path) -> None:
    """No more memory than the paper's run."""
    one, ten = (min(cost(tmp_path, seconds) for _ in range(2)) for seconds in (6000, 60000))
    print(f"100 minutes: {one[0]:.2f} s, {one[1]:.0f} MB; 1000 minutes: {ten[0]:.2f} s, {ten[1]:.0f} MB")
    assert ten[1] < one[1] + 5
