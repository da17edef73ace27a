"""The machine fails the workflow: full disk, no permission, a clock set back, a spoilt capture among many.

Each time: one clear line, nothing half written, and the plain command completes it once the fault is mended.
"""

from __future__ import annotations

import csv
import ctypes
import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from small_campaign import Place, write_captures

pytestmark = pytest.mark.slow

IS_ROOT = os.geteuid() == 0
DAY_S = 86_400.0


@pytest.fixture(scope="module")
def captures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign of one short run."""
    return write_captures(tmp_path_factory.mktemp("captures"), ("a",))


@pytest.fixture(scope="module")
def undisturbed(captures: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    """What the run gives where nothing fails."""
    place = Place(tmp_path_factory.mktemp("undisturbed"))
    shutil.copytree(captures, place.here / "campaigns")
    status, said = place.run()
    assert status == 0, said
    return place.contents()


@pytest.fixture
def place(captures: Path, tmp_path: Path) -> Place:
    shutil.copytree(captures, tmp_path / "campaigns")
    return Place(tmp_path)


def nothing_is_half_written(place: Place, undisturbed: dict[str, bytes]) -> None:
    assert list(place.here.rglob("*.tmp")) == []
    for name, data in place.whole_files_of_runs().items():
        assert data == undisturbed[name], name


def completes(place: Place, undisturbed: dict[str, bytes]) -> None:
    status, said = place.run()
    assert status == 0, said
    assert place.contents() == undisturbed


def in_one_place(said: str) -> list[str]:
    """What the end says of the runs that are not reduced."""
    end = said[said.index("These runs are not reduced:") :]
    return [line.strip() for line in end.splitlines()[1:] if line.startswith("  ")]


@pytest.fixture
def small_disk(place: Place) -> Iterator[Callable[[str], None]]:
    """Results on a file system of 200 kB, half of what they need; the function gives it another size."""
    place.results.mkdir()

    def mount(options: str) -> int:
        words = ["mount", "-t", "tmpfs", "-o", options, "tmpfs", str(place.results)]
        return subprocess.run(words, capture_output=True, check=False).returncode

    if not IS_ROOT or mount("size=200k"):
        pytest.skip("no right to mount a small disk")
    yield lambda size: None if mount(f"remount,size={size}") == 0 else pytest.fail("no larger disk")
    subprocess.run(["umount", str(place.results)], check=True)


def test_a_full_disk(place: Place, undisturbed: dict[str, bytes], small_disk: Callable[[str], None]) -> None:
    status, said = place.run()
    assert status == 1
    # the tables over all runs, which say which run failed, have no room either: the end says both
    assert "found No space left on device; expected room on the disk" in said
    (line,) = in_one_place(said)
    assert line.startswith("lab/a: ")
    assert "Traceback" not in said
    nothing_is_half_written(place, undisturbed)
    small_disk("20m")
    completes(place, undisturbed)


def bound_by_modes() -> None:
    """For the child: even root is held to modes (no CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH)."""
    for capability in (1, 2):
        if IS_ROOT and ctypes.CDLL(None).prctl(24, capability, 0, 0, 0):
            os._exit(77)


def test_permission_lost(place: Place, undisturbed: dict[str, bytes]) -> None:
    datasets = place.results / "lab" / "a" / "datasets"
    datasets.mkdir(parents=True, mode=0o555)
    status, said = place.run(before=bound_by_modes)
    if status == 77:
        pytest.skip("no right to give up a right")
    assert status == 1
    assert in_one_place(said) == [
        "lab/a: results/lab/a/datasets/ingest.nc: found Permission denied; "
        "expected permission to read or write it"
    ]
    nothing_is_half_written(place, undisturbed)
    if datasets.exists():
        datasets.chmod(0o755)
    completes(place, undisturbed)


def later(folder: Path, seconds: float) -> None:
    """As if the clock had been so much ahead when these files were written."""
    when = time.time() + seconds
    for path in folder.rglob("*"):
        if path.is_file():
            os.utime(path, (when, when))


def test_a_clock_set_back(place: Place, undisturbed: dict[str, bytes]) -> None:
    """Results that are two days ahead: left alone while nothing changes, made anew when an input does."""
    completes(place, undisturbed)
    later(place.results, 2 * DAY_S)
    status, said = place.run()
    assert status == 0
    assert "written in the future" in said
    assert "Nothing to be done" in said
    later(place.results, 2 * DAY_S)
    run_yaml = place.here / "campaigns/lab/runs/a/run.yaml"
    run_yaml.write_text(run_yaml.read_text().replace("latitude_deg: -23.2", "latitude_deg: -23.3"))
    assert place.run()[0] == 0
    drift = "lab/a/tables/drift.csv"
    assert place.contents()[drift] != undisturbed[drift]


def test_an_input_from_the_future_is_named(place: Place) -> None:
    capture = place.here / "campaigns/lab/runs/a/capture.fogcap"
    os.utime(capture, (time.time() + DAY_S,) * 2)
    _, said = place.run()
    (line,) = [line for line in said.splitlines() if "a time in the future" in line]
    assert line.startswith("campaigns/lab/runs/a/capture.fogcap: found a time in the future, ")
    os.utime(capture)
    assert "a time in the future" not in place.run()[1]


def test_one_corrupt_run_of_twenty(tmp_path: Path) -> None:
    """The others finish, the tables are made of them, and the failure is told in one place."""
    runs = [f"r{k:02d}" for k in range(20)]
    place = Place(tmp_path)
    write_captures(tmp_path, runs)
    capture = tmp_path / "campaigns/lab/runs/r07/capture.fogcap"
    whole = capture.read_bytes()
    capture.write_bytes(b"NOT A CAPTURE" + whole[13:])
    status, said = place.run()
    assert status == 1
    (line,) = in_one_place(said)
    assert line.startswith("lab/r07: campaigns/lab/runs/r07/capture.fogcap: byte 0: found")
    others = [run for run in runs if run != "r07"]
    assert sorted(path.parent.name for path in place.results.glob("lab/*/outputs.json")) == others
    with (place.results / "_summary/drift_all.csv").open(newline="") as file:
        assert sorted({row["run_id"] for row in csv.DictReader(file)}) == others
    with (place.results / "_summary/failed.csv").open(newline="") as file:
        assert [row["run_id"] for row in csv.DictReader(file)] == ["r07"]
    capture.write_bytes(whole)
    status, said = place.run()
    assert status == 0, said
    newest = max((tmp_path / ".snakemake" / "log").glob("*.log"))
    assert newest.read_text().count("localrule ingest") == 1, "only what was missing"
    assert len(list(place.results.glob("lab/*/outputs.json"))) == 20
