"""A folder with a small campaign in which the workflow runs, and what it leaves there and in memory."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).parents[2]
BIN = Path(sys.executable).parent
#: Of a run's results, what tells how it went and not what came out.
ASIDE = {"logs", "benchmarks"}
PATIENCE_S = 600

RUN_YAML = """\
schema: fogreduce/run/1
run_id: {run_id}
unit: TETRA-01
started_at: 2014-05-12T13:00:00Z
site: {{latitude_deg: -23.21132308}}
table:
  axis: x
  profile: {profile}
orientation: {{x: up, z: north}}
capture:
  file: capture.fogcap
  format: fogcap-1
  sample_rate_hz: 128
  volts_per_count: 1.0e-7
  polarity: [1, -1, 1, 1]
calibration: TETRA-01@2012a
"""


def write_captures(place: Path, run_ids: Sequence[str], duration_s: float = 10.0) -> Path:
    """A folder of campaigns with one, `lab`, of such runs."""
    for k, run_id in enumerate(run_ids):
        folder = place / "plan" / "runs" / run_id
        folder.mkdir(parents=True)
        profile = f"[{{rate_deg_s: {k + 1}, duration_s: {duration_s}}}]"
        (folder / "run.yaml").write_text(RUN_YAML.format(run_id=run_id, profile=profile))
    subprocess.run(
        [
            *(BIN / "fogreduce", "simulate", place / "plan"),
            *("--calibrations", ROOT / "calibrations"),
            *("--out", place / "campaigns" / "lab", "--seed", "1"),
        ],
        check=True,
        capture_output=True,
    )
    shutil.rmtree(place / "plan")
    return place / "campaigns"


class Place:
    """A folder with campaigns, in which the workflow runs; its processes are known by their environment."""

    def __init__(self, here: Path) -> None:
        self.here = here
        self.results = here / "results"
        self.environment = {**os.environ, "FOGREDUCE_PLACE": str(here), "OPENBLAS_NUM_THREADS": "1"}

    def start(self, *settings: str, before: Callable[[], None] | None = None) -> subprocess.Popen[bytes]:
        """The plain command, its messages in `said`."""
        with (self.here / "said").open("ab") as said:
            return subprocess.Popen(
                [
                    *(BIN / "snakemake", "--cores", "2", "--snakefile", ROOT / "Snakefile"),
                    *("--config", "campaigns_dir=campaigns", f"calibrations_dir={ROOT / 'calibrations'}"),
                    *("figures={enabled: false}", *settings),
                ],
                cwd=self.here,
                env=self.environment,
                stdout=said,
                stderr=said,
                preexec_fn=before,
            )

    def run(self, *settings: str, before: Callable[[], None] | None = None) -> tuple[int, str]:
        """The plain command to its end: its status, and what it said."""
        (self.here / "said").unlink(missing_ok=True)
        with self.start(*settings, before=before) as process:
            return process.wait(PATIENCE_S), self.said()

    def said(self) -> str:
        return (self.here / "said").read_text()

    def processes(self) -> dict[int, list[str]]:
        """The command lines of all that were started from here and live, by process id."""
        mark = f"FOGREDUCE_PLACE={self.here}".encode()
        found = {}
        for folder in Path("/proc").iterdir():
            try:
                if folder.name.isdecimal() and mark in (folder / "environ").read_bytes().split(b"\0"):
                    found[int(folder.name)] = (folder / "cmdline").read_text().split("\0")[:-1]
            except (FileNotFoundError, ProcessLookupError, PermissionError):
                continue
        return {pid: words for pid, words in found.items() if words}

    def contents(self) -> dict[str, bytes]:
        """Every file of the results by its name, logs and timings aside."""
        return {
            str(path.relative_to(self.results)): path.read_bytes()
            for path in sorted(self.results.rglob("*"))
            if path.is_file() and not ASIDE & set(path.relative_to(self.results).parts)
        }

    def whole_files_of_runs(self) -> dict[str, bytes]:
        """Those that stand under a name of their own, and tell of one run only."""
        return {
            name: data
            for name, data in self.contents().items()
            if len(parts := Path(name).parts) > 2
            and not any(part[0] == "_" or part.endswith(".tmp") for part in parts)
        }


def until(seconds: float, done: Callable[[], object]) -> bool:
    """Whether `done()` came true within so many seconds."""
    end = time.monotonic() + seconds
    while not done():
        if time.monotonic() > end:
            return False
        time.sleep(0.002)
    return True
