"""What the benchmarks share: a process timed whole, the machine named, spreads printed, runs made."""

from __future__ import annotations

import argparse
import datetime
import os
import platform
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from fogreduce.metadata.yaml12 import dump_yaml, load_yaml

REPOSITORY = Path(__file__).resolve().parents[1]
CALIBRATIONS = REPOSITORY / "calibrations"
COMMAND = str(Path(sys.executable).with_name("fogreduce"))


@dataclass(frozen=True)
class Measured:
    """One process from its start to its end: wall and processor time [s] and largest resident memory [MB].

    Processor time is that of the process and of those that it started and waited for; `user_s` is the part
    of it spent outside the system's kernel, which is the least disturbed by other work. The memory is never
    less than what the calling process held when it started the other: callers stay small.
    """

    wall_s: float
    cpu_s: float
    peak_mb: float
    user_s: float


def run(command: Sequence[object]) -> Measured:
    """Run a command to its end; RuntimeError where it fails."""
    words = [str(word) for word in command]
    began = time.perf_counter()
    process = os.posix_spawn(words[0], words, os.environ)
    _, status, usage = os.wait4(process, 0)
    wall = time.perf_counter() - began
    if status:
        raise RuntimeError(f"{' '.join(words)} ended with status {os.waitstatus_to_exitcode(status)}")
    return Measured(wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024, usage.ru_utime)


def reduce(run_dir: Path, out: Path, *more: str) -> Measured:
    """Reduce a run into a folder that does not exist, whole process."""
    shutil.rmtree(out, ignore_errors=True)
    return run([COMMAND, "reduce", run_dir, "--calibrations", CALIBRATIONS, "--out", out, *more])


def spread(values: Sequence[float], digits: int = 3) -> str:
    """Median, quartiles and range."""
    ordered = sorted(values)
    low, _, high = statistics.quantiles(ordered, n=4) if len(ordered) > 1 else ordered * 3
    shown = [
        f"{value:.{digits}f}" for value in (statistics.median(ordered), low, high, ordered[0], ordered[-1])
    ]
    return "{} (quartiles {} to {}, range {} to {})".format(*shown)


def machine() -> str:
    """Date, processor, cores and how busy they are."""
    model = platform.processor() or platform.machine()
    information = Path("/proc/cpuinfo")
    if information.exists():
        names = [
            line.split(":", 1)[1] for line in information.read_text().splitlines() if "model name" in line
        ]
        model = names[0].strip() if names else model
    load = " ".join(f"{value:.2f}" for value in os.getloadavg())
    now = datetime.datetime.now(datetime.UTC).strftime("%Y-%m-%d %H:%M UTC")
    return (
        f"{now}; {model}, {os.cpu_count()} cores, {platform.system()} {platform.release()}, "
        f"Python {platform.python_version()}; load averages {load}"
    )


@contextmanager
def workplace(arguments: argparse.Namespace) -> Iterator[Path]:
    """The folder of --work, or one that is taken away at the end."""
    if arguments.work is not None:
        arguments.work.mkdir(parents=True, exist_ok=True)
        yield arguments.work
        return
    with tempfile.TemporaryDirectory(prefix="fogreduce-bench-") as name:
        yield Path(name)


def parser(text: str, repetitions: int) -> argparse.ArgumentParser:
    """Options that all benchmarks have."""
    made = argparse.ArgumentParser(description=text)
    made.add_argument("--work", type=Path, help="folder for captures and results (default: a temporary one)")
    made.add_argument("--repetitions", type=int, default=repetitions, help="default: %(default)s")
    return made


def published_run(work: Path) -> Path:
    """The reconstructed published run: 6000 s at 128 Hz, four gyros; made unless it is there."""
    campaign = work / "published"
    if not campaign.exists():
        source = REPOSITORY / "campaigns" / "published"
        run([COMMAND, "simulate", source, "--calibrations", CALIBRATIONS, "--out", campaign])
    return campaign / "runs" / "x-one-turn"


def long_run(work: Path, duration_s: float, taken: list[Measured] | None = None) -> Path:
    """A run of the bundled unit at 0.06 deg/s for some time, with nominal noise; made unless it is there.

    What making it took is appended to `taken`.
    """
    made = work / f"long-{duration_s:g}"
    if not made.exists():
        plan = work / f"plan-{duration_s:g}" / "runs" / "long"
        plan.mkdir(parents=True, exist_ok=True)
        data = load_yaml(REPOSITORY / "campaigns" / "published" / "runs" / "x-one-turn" / "run.yaml")
        table = {"axis": "x", "profile": [{"rate_deg_s": 0.06, "duration_s": float(duration_s)}]}
        (plan / "run.yaml").write_text(dump_yaml({**data, "run_id": "long", "table": table}))
        made_in = run([COMMAND, "simulate", plan.parents[1], "--calibrations", CALIBRATIONS, "--out", made])
        if taken is not None:
            taken.append(made_in)
    return made / "runs" / "long"


def folder_mb(folder: Path) -> float:
    """Size of all files below a folder [MB]."""
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) / 1e6


def compiled(source: Path, target: Path, *flags: str) -> Path:
    """A C program built with ``gcc -O2``."""
    subprocess.run(["gcc", "-O2", *flags, "-o", str(target), str(source), "-lm"], check=True)
    return target
