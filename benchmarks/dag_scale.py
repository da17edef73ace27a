"""What the workflow costs over many small runs: a job, a second call, one run more, planning.

    python benchmarks/dag_scale.py --runs 1000 --planning 100 1000 5000

Runs of 10 s at 128 Hz are simulated, then reduced by the workflow with all tables and datasets, without
figures and pages.  Overhead a job = (2 x wall - CPU of the same commands in one process) / jobs, on two
cores.  On a machine that others use, wall time counts them too; the CPU time of everything that the workflow
started does not, so (that CPU - CPU in one process) / jobs stands beside it.
"""

from __future__ import annotations

import argparse
import ctypes
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
BIN = Path(sys.executable).parent
RUN_YAML = """\
schema: fogreduce/run/1
run_id: {run_id}
unit: TETRA-01
started_at: 2014-05-12T13:00:00Z
site: {{latitude_deg: -23.21132308}}
table: {{axis: x, profile: [{{rate_deg_s: 10, duration_s: 10}}]}}
orientation: {{x: up, z: north}}
capture:
  file: capture.fogcap
  format: fogcap-1
  sample_rate_hz: 128
  volts_per_count: 1.0e-7
  polarity: [1, -1, 1, 1]
calibration: TETRA-01@2012a
"""
_PR_SET_CHILD_SUBREAPER = 36


@dataclass
class Cost:
    """Of a call: wall and CPU time of all that it started, largest memory, jobs done, what it said."""

    wall_s: float
    cpu_s: float
    memory_mb: float
    jobs: int
    said: str


def call(place: Path, *words: str) -> Cost:
    """Snakemake over the campaigns in `place`."""
    told = ["--cores", "2", "--snakefile", ROOT / "Snakefile", "--directory", place]
    told += ["--workflow-profile", ROOT / "profiles" / "default"]
    told += ["--quiet", "host", *words]  # so that it counts the jobs
    told += ["--config", "campaigns_dir=campaigns", f"calibrations_dir={ROOT / 'calibrations'}"]
    told += ["figures={enabled: false}", "pages={enabled: false}"]
    before, start = _children_cpu(), time.monotonic()
    with tempfile.TemporaryFile("w+") as said:
        process = subprocess.Popen(["snakemake", *told], cwd=place, stdout=said, stderr=subprocess.STDOUT)
        _, status, used = os.wait4(process.pid, 0)
        wall = time.monotonic() - start
        _wait_for_orphans()
        said.seek(0)
        text = said.read()
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        sys.exit(text[-3000:])
    steps = re.findall(r"(\d+) of \d+ steps", text)
    return Cost(wall, _children_cpu() - before, used.ru_maxrss / 1024, int(steps[-1]) if steps else 0, text)


def _children_cpu() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _wait_for_orphans() -> None:
    """The warm server outlives its workflow by an instant, and is ours then."""
    while True:
        try:
            os.wait()
        except ChildProcessError:
            return


def make_runs(campaign: Path, numbers: range, *, captures: bool) -> None:
    """Run folders; with simulated captures, or with empty ones where they are only to be planned."""
    plan = campaign if not captures else campaign.parents[1] / "plans" / str(numbers.start) / campaign.name
    made = campaign.parents[1] / "made" / str(numbers.start)
    for number in numbers:
        run_id = f"r{number:05d}"
        folder = plan / "runs" / run_id
        folder.mkdir(parents=True)
        (folder / "run.yaml").write_text(RUN_YAML.format(run_id=run_id))
        if not captures:
            (folder / "capture.fogcap").touch()
    if captures:
        words = ["simulate", plan, "--calibrations", ROOT / "calibrations", "--out", made]
        subprocess.run(["fogreduce", *words], check=True, stdout=subprocess.DEVNULL)
        (campaign / "runs").mkdir(parents=True, exist_ok=True)
        for run in (made / "runs").iterdir():
            run.rename(campaign / "runs" / run.name)


def in_one_process(campaign: Path, runs: list[str], out: Path) -> float:
    """CPU [s] of the commands of these runs' nodes, one after another in a process of their own."""
    script = """
import sys, time
from pathlib import Path
from fogreduce.cli.main import main
from fogreduce.cli.stage import STAGES
campaign, out, calibrations, *runs = sys.argv[1:]
def all_of(run):
    folder, results = f"{campaign}/runs/{run}", f"{out}/{run}"
    assert main(["manifest", folder, "--calibrations", calibrations, "--out", results]) == 0
    for stage in STAGES:
        assert main(["stage", stage, "--run", folder, "--out", results]) == 0
    assert main(["checksums", results]) == 0
all_of(runs[0])
start = time.process_time()
for run in runs:
    all_of(run)
print("CPU", time.process_time() - start)
"""
    words = [sys.executable, "-c", script, campaign, out, ROOT / "calibrations", *runs]
    done = subprocess.run(words, check=True, capture_output=True, text=True)
    return float(done.stdout.split()[-1])


def planning(runs: int) -> None:
    """A dry run over runs of which none is reduced."""
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        make_runs(place / "campaigns" / "many", range(runs), captures=False)
        cost = call(place, "--dry-run", "--quiet", "all")
    print(f"planning {runs} runs: {cost.cpu_s:.1f} s CPU, {cost.wall_s:.1f} s, {cost.memory_mb:.0f} MB")


def whole(runs: int, sample: int) -> None:
    """Reduce all; again; one more."""
    with tempfile.TemporaryDirectory() as name:
        place = Path(name)
        campaign = place / "campaigns" / "many"
        make_runs(campaign, range(runs), captures=True)
        names = [f"r{number:05d}" for number in range(min(sample, runs))]
        alone_s = in_one_process(campaign, names, place / "alone") / len(names) * runs
        first = call(place)
        print(
            f"{runs} runs, {first.jobs} jobs: {first.wall_s:.0f} s, {first.cpu_s:.0f} s CPU,"
            f" {first.memory_mb:.0f} MB; the same in one process {alone_s:.0f} s CPU"
        )
        by_wall = (2 * first.wall_s - alone_s) / first.jobs
        by_cpu = (first.cpu_s - alone_s) / first.jobs
        print(f"overhead a job: {1e3 * by_wall:.0f} ms by wall time, {1e3 * by_cpu:.0f} ms by CPU time")
        again = call(place)
        assert "Nothing to be done" in again.said
        print(f"again, nothing to do: {again.wall_s:.1f} s, {again.cpu_s:.1f} s CPU")
        make_runs(campaign, range(runs, runs + 1), captures=True)
        more = call(place)
        print(f"one run more, {more.jobs} jobs: {more.wall_s:.1f} s, {more.cpu_s:.1f} s CPU")


def main() -> None:
    """Measure."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--runs", type=int, default=100)
    parser.add_argument("--sample", type=int, default=50, help="runs reduced in one process, for comparison")
    parser.add_argument("--planning", type=int, nargs="*", default=[])
    arguments = parser.parse_args()
    os.environ["PATH"] = f"{BIN}:{os.environ['PATH']}"
    os.environ["OPENBLAS_NUM_THREADS"] = "1"
    ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)
    for runs in arguments.planning:
        planning(runs)
    if arguments.runs:
        whole(arguments.runs, arguments.sample)


if __name__ == "__main__":
    main()
