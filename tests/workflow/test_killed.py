"""kill -9 at random instants, then the plain command again: the same bytes, nothing half there, nobody left.

FOGREDUCE_KILLS is the number of kills (6), FOGREDUCE_SEED what their instants are drawn from.
"""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BIN = Path(sys.executable).parent
KILLS = int(os.environ.get("FOGREDUCE_KILLS", "6"))
SEED = int(os.environ.get("FOGREDUCE_SEED", "1"))
VICTIMS = ("snakemake", "server", "worker")
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
  profile: [{{rate_deg_s: {rate}, duration_s: 10}}]
orientation: {{x: up, z: north}}
capture:
  file: capture.fogcap
  format: fogcap-1
  sample_rate_hz: 128
  volts_per_count: 1.0e-7
  polarity: [1, -1, 1, 1]
calibration: TETRA-01@2012a
"""


class Place:
    """A folder with campaigns, in which the workflow runs; its processes are known by their environment."""

    def __init__(self, here: Path) -> None:
        self.here = here
        self.results = here / "results"
        self.environment = {**os.environ, "FOGREDUCE_PLACE": str(here)}

    def start(self, *settings: str) -> subprocess.Popen[bytes]:
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
            )

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
            if not name.startswith("_") and not any(part.endswith(".tmp") for part in Path(name).parts)
        }


def until(seconds: float, done: object) -> bool:
    """Whether `done()` came true within so many seconds."""
    end = time.monotonic() + seconds
    while not done():  # type: ignore[operator]
        if time.monotonic() > end:
            return False
        time.sleep(0.002)
    return True


def locked(place: Place) -> bool:
    return any((place.here / ".snakemake" / "locks").glob("*.lock"))


def children(pid: int) -> list[int]:
    """The processes that a process has started, by any of its threads."""
    found: list[int] = []
    for thread in Path(f"/proc/{pid}/task").glob("*/children"):
        try:
            found += map(int, thread.read_text().split())
        except (FileNotFoundError, ProcessLookupError):
            continue
    return found


def command(pid: int) -> list[str]:
    try:
        return Path(f"/proc/{pid}/cmdline").read_text().split("\0")
    except (FileNotFoundError, ProcessLookupError):
        return []


def candidates(victim: str, snakemake: int) -> list[int]:
    """What may be killed: Snakemake, its server, or what does the work of a job or waits for it."""
    if victim == "snakemake":
        return [snakemake]
    below = children(snakemake)
    servers = [pid for pid in below if "server" in command(pid)]
    if victim == "server":
        return servers
    return [working for pid in below for working in children(pid)]


@pytest.fixture(scope="module")
def captures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign `lab` of two short runs."""
    place = tmp_path_factory.mktemp("captures")
    for k, run_id in enumerate(("a", "b")):
        folder = place / "plan" / "runs" / run_id
        folder.mkdir(parents=True)
        (folder / "run.yaml").write_text(RUN_YAML.format(run_id=run_id, rate=k + 1))
    subprocess.run(
        [
            *(BIN / "fogreduce", "simulate", place / "plan"),
            *("--calibrations", ROOT / "calibrations"),
            *("--out", place / "campaigns" / "lab", "--seed", "1"),
        ],
        check=True,
        capture_output=True,
    )
    return place / "campaigns"


def place_of(folder: Path, captures: Path) -> Place:
    shutil.copytree(captures, folder / "campaigns")
    return Place(folder)


def must_be_whole(place: Place, undisturbed: dict[str, bytes]) -> None:
    """What stands under its name is as it should be, even right after a kill."""
    odd = [name for name, data in place.whole_files_of_runs().items() if undisturbed.get(name) != data]
    assert not odd, odd


def must_be_alone(place: Place) -> None:
    """No process outlives its workflow."""
    assert until(20.0, lambda: not place.processes()), place.processes()


def must_be_done(place: Place, undisturbed: dict[str, bytes]) -> None:
    """As if nothing had happened."""
    assert place.contents() == undisturbed
    assert list(place.here.rglob("*.tmp")) == []
    assert not locked(place)


def kill(victim: str, process: subprocess.Popen[bytes]) -> str:
    """Kill the victim, or Snakemake where none is found for seconds; whom, `""` where all had ended."""
    for wanted in (victim, "snakemake"):
        end = time.monotonic() + 3.0
        while process.poll() is None and time.monotonic() < end:
            if found := candidates(wanted, process.pid):
                try:
                    os.kill(random.choice(found), signal.SIGKILL)
                    return wanted
                except ProcessLookupError:
                    pass
    return ""


@pytest.mark.slow
@pytest.mark.skipif(sys.platform != "linux", reason="processes are found in /proc")
def test_killed_and_started_again(captures: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    """One place is killed again and again until it is done nevertheless, then the next."""
    place = place_of(tmp_path_factory.mktemp("undisturbed"), captures)
    process = place.start()
    assert until(PATIENCE_S, lambda: locked(place))
    begun = time.monotonic()
    assert process.wait(PATIENCE_S) == 0, place.said()
    length = time.monotonic() - begun
    undisturbed = place.contents()
    assert "lab/a/outputs.json" in undisturbed

    random.seed(SEED)
    killed = dict.fromkeys(VICTIMS, 0)
    places = 0
    while sum(killed.values()) < KILLS or places == 0:
        place = place_of(tmp_path_factory.mktemp("killed"), captures)
        places += 1
        while True:
            process = place.start()
            until(PATIENCE_S, lambda: locked(place) or process.poll() is not None)  # noqa: B023
            victim = ""
            if sum(killed.values()) < KILLS:
                until(random.uniform(0.0, length), lambda: process.poll() is not None)  # noqa: B023
                victim = kill(random.choice(VICTIMS), process)
            if victim:
                killed[victim] += 1
            status = process.wait(PATIENCE_S)
            print(f"{sum(killed.values())}: {victim or 'nobody'} killed, status {status}", flush=True)
            must_be_alone(place)
            must_be_whole(place, undisturbed)
            if status == 0:
                break
            assert status == (-9 if victim == "snakemake" else 1), place.said()
        must_be_done(place, undisturbed)
        shutil.rmtree(place.here)
    print(f"\n{sum(killed.values())} kills in {places} folders, seed {SEED}: {killed}; work: {length:.1f} s")
