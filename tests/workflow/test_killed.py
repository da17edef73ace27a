"""kill -9 at random instants, then `snakemake --unlock` where Snakemake asks for it, and the plain command.

The same bytes come out, nothing is half there, nobody is left.

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
from small_campaign import PATIENCE_S, Place, until, write_captures

KILLS = int(os.environ.get("FOGREDUCE_KILLS", "6"))
SEED = int(os.environ.get("FOGREDUCE_SEED", "1"))
VICTIMS = ("snakemake", "server", "worker")


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
    """A campaign of two short runs."""
    return write_captures(tmp_path_factory.mktemp("captures"), ("a", "b"))


def place_of(folder: Path, captures: Path) -> Place:
    shutil.copytree(captures, folder / "campaigns")
    return Place(folder)


def must_be_whole(place: Place, undisturbed: dict[str, bytes]) -> None:
    """What stands under its name is as it should be, even right after a kill."""
    odd = [name for name, data in place.whole_files_of_runs().items() if undisturbed.get(name) != data]
    assert not odd, odd


def must_be_unlocked_by_hand(place: Place) -> None:
    """A killed workflow's lock is told, with the command that unlocks it; that is enough."""
    status, said = place.run()
    assert status == 1
    assert "--unlock" in said
    assert place.run("--unlock")[0] == 0
    assert not locked(place)


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
            if locked(place):
                must_be_unlocked_by_hand(place)
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


@pytest.mark.slow
def test_two_at_once(captures: Path, tmp_path: Path) -> None:
    """Begun together: one is told who is at work, and takes nothing from the other."""
    place = place_of(tmp_path, captures)
    both = place.start(), place.start()
    done, told = sorted(process.wait(PATIENCE_S) for process in both)
    said = place.said()
    assert done == 0, said
    assert told in (1, 2)
    assert "Directory cannot be locked" in said or "expected one writer at a time" in said
    assert (place.results / "lab/b/outputs.json").exists()
