"""A run reduced again into its folder: nothing of the older version is taken for the new."""

import json
import shutil

import pytest
from archived_lab import CAMPAIGN
from small_unit import call, succeed

MADE_OF_IT = (
    "index.html",
    "reports/overview.json",
    "outputs.json",
    "figures/index.json",
    "figures/rates.svg",
)


@pytest.fixture(scope="module", autouse=True)
def one_code(archived):
    """All reductions of this file name the archived code."""
    with archived.one_code():
        yield


@pytest.fixture
def finished(archived, tmp_path):
    """A run's results with page, figures (a stand-in for one, to be quick) and checksums."""
    results = tmp_path / "results"
    shutil.copytree(archived.results, results)
    out = results / CAMPAIGN / "r1"
    version = json.loads((out / "manifest.json").read_text())["version_id"]
    (out / "figures").mkdir(exist_ok=True)
    (out / "figures" / "rates.svg").write_text("<svg/>")
    index = {"version_id": version, "figures": ["rates.svg"], "left_out": {}}
    (out / "figures" / "index.json").write_text(json.dumps(index))
    succeed("page", "run", out)
    succeed("checksums", out)
    return out


def reduce(archived, out, *more, run="r1"):
    run = archived.campaigns / CAMPAIGN / "runs" / run
    return call("reduce", run, "--calibrations", archived.calibrations, "--out", out, *more)


OTHER = ("--parameters", '{"edge_guard_s": 1.5}')


@pytest.mark.parametrize("command", ["reduce", "manifest"])
def test_what_another_version_makes_stale_is_removed(archived, finished, command):
    run = archived.campaigns / CAMPAIGN / "runs" / "r1"
    (finished / "figures" / "my-own.png").write_bytes(b"kept")
    succeed(command, run, "--calibrations", archived.calibrations, "--out", finished, *OTHER)
    assert [name for name in MADE_OF_IT if (finished / name).exists()] == []
    assert (finished / "figures" / "my-own.png").exists()
    assert len(list((finished / "versions").iterdir())) >= 1


def test_the_same_version_again_removes_nothing(archived, finished):
    assert reduce(archived, finished)[0] == 0
    assert [name for name in MADE_OF_IT if not (finished / name).exists()] == []


def test_archived_after_a_second_reduction_it_verifies(archived, finished, tmp_path):
    assert reduce(archived, finished, *OTHER)[0] == 0
    places = ["--campaigns", archived.campaigns, "--calibrations", archived.calibrations]
    bags = tmp_path / "bags"
    status, _, said = call("archive", finished.parents[1], "--out", bags, *places)
    assert status == 2
    assert said.count("\n") == 1
    assert f"{finished}/outputs.json: found no such file; expected checksums" in said
    succeed("checksums", finished)
    succeed("archive", finished.parents[1], "--out", bags, *places)
    succeed("verify", bags / CAMPAIGN)


@pytest.mark.parametrize(
    "name", ["reports/overview.json", "tables/quality.csv", "datasets/bins.nc", "figures/index.json"]
)
def test_checksums_refuse_a_file_of_another_version(archived, finished, name):
    kept = (finished / name).read_bytes()
    assert reduce(archived, finished, *OTHER)[0] == 0
    (finished / name).parent.mkdir(exist_ok=True)
    (finished / name).write_bytes(kept)
    status, _, said = call("checksums", finished)
    assert status == 2
    assert said.startswith(f"{finished / name}: version_id: found ")
    assert said.count("\n") == 1
    assert not (finished / "outputs.json").exists()


@pytest.mark.parametrize("command", ["reduce", "manifest"])
def test_another_run_is_refused(archived, finished, command):
    before = {path: path.read_bytes() for path in finished.rglob("*") if path.is_file()}
    run = archived.campaigns / CAMPAIGN / "runs" / "r2"
    status, _, said = call(command, run, "--calibrations", archived.calibrations, "--out", finished)
    assert status == 2
    expected = f"an empty folder, or results of {CAMPAIGN}/r2"
    assert said == f"{finished}: found results of {CAMPAIGN}/r1; expected {expected}\n"
    assert {path: path.read_bytes() for path in finished.rglob("*") if path.is_file()} == before
