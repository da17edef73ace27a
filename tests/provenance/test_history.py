"""Results of an older version stay beside the new, and what changed between them is told."""

import json
import shutil

import pytest
from archived_lab import CAMPAIGN, seal
from small_unit import call, succeed

from fogreduce.archive.verify import verify
from fogreduce.provenance.history import history
from fogreduce.provenance.versions import kept_versions


@pytest.fixture(scope="module", autouse=True)
def one_code(archived):
    """All reductions of this file name the archived code."""
    with archived.one_code():
        yield


@pytest.fixture(scope="module")
def twice(archived, tmp_path_factory):
    """A run reduced again with another parameter and another calibration record."""
    root = tmp_path_factory.mktemp("twice")
    results = root / "results"
    shutil.copytree(archived.results, results)
    calibrations = root / "calibrations"
    shutil.copytree(archived.calibrations, calibrations)
    record = (calibrations / "TETRA-01" / "2012a.yaml").read_text()
    later = record.replace("0.075", "0.0751").replace("2012a", "2012b")
    (calibrations / "TETRA-01" / "2012b.yaml").write_text(later)
    run, out = root / "campaigns" / CAMPAIGN / "runs" / "r1", results / CAMPAIGN / "r1"
    shutil.copytree(archived.campaigns, root / "campaigns")
    text = (run / "run.yaml").read_text()
    (run / "run.yaml").write_text(text.replace("TETRA-01@2012a", "TETRA-01@2012b"))
    before = {path.name: path.read_bytes() for path in (out / "tables").iterdir()}
    places = ["--calibrations", calibrations, "--out", out]
    succeed("reduce", run, *places, "--parameters", '{"edge_guard_s": 1.5}')
    succeed("checksums", out)
    return root, out, before


def test_the_older_version_is_still_there_to_the_byte(twice):
    _, out, before = twice
    old, new = kept_versions(out)
    assert {path.name: path.read_bytes() for path in (old.folder / "tables").iterdir()} == before
    assert (old.folder / "datasets" / "ingest.nc").is_file()
    assert old.version_id != new.version_id
    assert json.loads((out / "manifest.json").read_text())["version_id"] == new.version_id


def test_what_changed_and_why(twice):
    _, out, before = twice
    found = history(out)
    assert found["now"] == 2
    (change,) = found["changes"]
    causes = "\n".join(change["causes"])
    assert "parameters: edge_guard_s: 0.5 -> 1.5" in causes
    assert "calibration: TETRA-01@2012a -> TETRA-01@2012b" in causes
    assert "scale_factor_V_per_deg_s" in causes
    assert "code" not in causes
    cell = next(item for item in change["cells"] if item["cell"] == "drift.csv:x@1:drift_deg_h")
    rows = [line.split(",") for line in before["drift.csv"].decode().splitlines()]
    assert cell["old"] == rows[1][rows[0].index("drift_deg_h")]
    assert cell["old_uncertainty"]["drift_err_deg_h"] == rows[1][rows[0].index("drift_err_deg_h")]
    now = [line.split(",") for line in (out / "tables" / "drift.csv").read_text().splitlines()]
    assert cell["new"] == now[1][now[0].index("drift_deg_h")]
    expected = abs(float(cell["new"]) - float(cell["old"])) / float(
        cell["old_uncertainty"]["drift_err_deg_h"]
    )
    assert cell["sigma"] == pytest.approx(expected)
    # The records are the same, so their number is.
    assert "quality.csv:records:count" not in {item["cell"] for item in change["cells"]}
    assert change["unchanged"] > 0


def test_the_text_says_value_uncertainty_and_cause(twice):
    _, out, _ = twice
    text = succeed("history", out, "--all")
    assert "because  parameters: edge_guard_s: 0.5 -> 1.5" in text
    assert "drift.csv:x@1:drift_deg_h: " in text
    assert " ± " in text
    assert "now version 2" in text


def test_the_same_results_are_no_new_version(archived):
    out = archived.results / CAMPAIGN / "r1"
    succeed("checksums", out)
    assert [version.number for version in kept_versions(out)] == [1]
    assert history(out)["changes"] == []


def test_going_back_is_seen(twice, archived, tmp_path):
    _, out, _ = twice
    again = tmp_path / "results" / CAMPAIGN / "r1"
    shutil.copytree(out, again)
    run = archived.campaigns / CAMPAIGN / "runs" / "r1"
    succeed("reduce", run, "--calibrations", archived.calibrations, "--out", again)
    succeed("checksums", again)
    assert len(kept_versions(again)) == 2
    assert history(again)["now"] == 1


def test_a_kept_version_that_was_changed_is_found(twice, tmp_path):
    _, out, _ = twice
    copy = tmp_path / "r1"
    shutil.copytree(out, copy)
    table = kept_versions(copy)[0].folder / "tables" / "drift.csv"
    table.write_text(table.read_text().replace("x,", "x,1", 1))
    status, _, err = call("history", copy)
    assert status == 2
    assert str(table) in err


def test_the_archive_holds_all_versions(twice, archived):
    root, _, before = twice
    shutil.rmtree(root / "results" / CAMPAIGN / "r2")
    places = ["--campaigns", root / "campaigns", "--calibrations", root / "calibrations"]
    places += ["--source", archived.source]
    succeed("archive", root / "results", *places, "--out", root / "bags")
    bag = root / "bags" / CAMPAIGN
    assert verify(bag).faults == ()
    text = succeed("history", bag)
    assert "now version 2" in text
    assert "because  parameters: edge_guard_s: 0.5 -> 1.5" in text
    old = next((bag / "data/results" / CAMPAIGN / "r1" / "versions").iterdir())
    assert (old / "tables" / "drift.csv").read_bytes() == before["drift.csv"]
    (old / "tables" / "drift.csv").write_bytes(before["drift.csv"] + b"\n")
    seal(bag)
    assert any(str(old / "tables" / "drift.csv") in str(fault) for fault in verify(bag).faults)


def test_unfinished_results_have_no_checksums(archived, tmp_path):
    out = tmp_path / "r1"
    shutil.copytree(archived.results / CAMPAIGN / "r1", out)
    (out / "tables" / "drift.csv").unlink()
    status, _, err = call("checksums", out)
    assert status == 2
    assert "drift.csv" in err
    status, _, err = call("checksums", tmp_path / "none")
    assert status == 2
