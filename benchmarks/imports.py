"""What a start costs: each command on next to no data, and the large libraries that it imports."""

from __future__ import annotations

import os
import shutil
import statistics
import subprocess
import sys
from pathlib import Path

from measure import CALIBRATIONS, COMMAND, Measured, long_run, machine, parser, run, workplace

LARGE = ("numpy", "h5py", "pydantic", "yaml", "scipy", "pandas", "xarray", "matplotlib", "tqdm")


def large_imports(arguments: list[str]) -> str:
    """Which of the large libraries a command imports."""
    command = [sys.executable, "-X", "importtime", COMMAND, *arguments]
    said = subprocess.run(command, capture_output=True, text=True, env={**os.environ}).stderr
    names = {
        line.rsplit("|", 1)[-1].strip().split(".")[0] for line in said.splitlines() if "import time" in line
    }
    return " ".join(name for name in LARGE if name in names)


def commands(run_dir: Path, out: Path, spare: Path) -> dict[str, list[str]]:
    """Each command's arguments, in an order in which each finds what it needs."""
    calibrations = ["--calibrations", str(CALIBRATIONS)]
    stages = ("ingest", "calibrate", "project", "remove_earth", "fit", "drift")
    return {
        "--version": ["--version"],
        "check": ["check", str(run_dir), *calibrations],
        "manifest": ["manifest", str(run_dir), *calibrations, "--out", str(out)],
        **{f"stage {name}": ["stage", name, "--run", str(run_dir), "--out", str(out)] for name in stages},
        "reduce": ["reduce", str(run_dir), *calibrations, "--out", str(spare)],
        "summary": ["summary", str(out), "--out", str(spare / "summary")],
        "curve": ["curve", str(out), "--channel", "x"],
        "simulate": ["simulate", str(run_dir.parents[1]), *calibrations, "--out", str(spare / "made")],
    }


def main() -> None:
    """A row a command, beside the bare interpreter."""
    arguments = parser(__doc__ or "", 7).parse_args()
    with workplace(arguments) as work:
        print(machine())
        run_dir, out, spare = long_run(work, 10), work / "out", work / "spare"
        shutil.rmtree(out, ignore_errors=True)
        print(f"{'command':<20}{'wall ms':>9}{'cpu ms':>8}{'peak MB':>9}  large libraries")
        bare = [run([sys.executable, "-c", "pass"]) for _ in range(arguments.repetitions)]
        rows = {"python -c pass": (bare, "")}
        for name, words in commands(run_dir, out, spare).items():
            found = []
            for _ in range(arguments.repetitions):
                shutil.rmtree(spare, ignore_errors=True)
                found.append(_quiet(words))
            shutil.rmtree(spare, ignore_errors=True)
            rows[name] = (found, large_imports(words))
        for name, (found, libraries) in rows.items():
            wall = 1e3 * statistics.median(item.wall_s for item in found)
            cpu = 1e3 * statistics.median(item.cpu_s for item in found)
            peak = statistics.median(item.peak_mb for item in found)
            print(f"{name:<20}{wall:>9.0f}{cpu:>8.0f}{peak:>9.0f}  {libraries}")


def _quiet(words: list[str]) -> Measured:
    """The command timed, its standard output thrown away."""
    saved, null = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1)
    try:
        return run([COMMAND, *words])
    finally:
        os.dup2(saved, 1)
        os.close(saved)
        os.close(null)


if __name__ == "__main__":
    main()
