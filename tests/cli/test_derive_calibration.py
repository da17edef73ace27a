"""``fogreduce derive-calibration`` as its user calls it: candidate record, page, and what it refuses."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from fogreduce.cli.main import main
from fogreduce.metadata.folder import read_calibration

RUNS = ("1-x-plus", "2-x-minus", "3-y-plus", "4-y-minus", "5-z-plus", "6-z-minus")


@pytest.fixture(scope="module")
def campaign(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Runs of the bundled campaign about three axes, cut to 36 s at 16 Hz, simulated."""
    import re

    folder = tmp_path_factory.mktemp("derive")
    for run in RUNS:
        text = (repository / "campaigns" / "three-axes" / "runs" / run / "run.yaml").read_text()
        text = re.sub(r"duration_s: [0-9.]+", "duration_s: 36", text).replace("128", "16")
        text = re.sub(r"^temperature.*\n", "", text, flags=re.MULTILINE)
        (folder / "plan" / "runs" / run).mkdir(parents=True)
        (folder / "plan" / "runs" / run / "run.yaml").write_text(text)
    words = ["simulate", str(folder / "plan"), "--calibrations", str(repository / "calibrations")]
    assert main([*words, "--out", str(folder / "made")]) == 0
    return folder / "made"


def derive(campaign: Path, repository: Path, out: Path, *words: str) -> int:
    calibrations = str(repository / "calibrations")
    return main(
        ["derive-calibration", str(campaign), "--calibrations", calibrations, "--out", str(out), *words]
    )


def test_candidate_is_a_record_that_reduces_the_same_campaign(campaign, repository, tmp_path, capsys) -> None:
    assert derive(campaign, repository, tmp_path / "out") == 0
    said = capsys.readouterr().out
    record = read_calibration(tmp_path / "out" / "TETRA-01" / "2012a-derived.yaml")
    assert record.supersedes == "TETRA-01@2012a"
    assert record.pedigree is not None
    assert [one.run_id for one in record.pedigree.runs] == list(RUNS)
    assert record.covariance is not None
    assert len(record.covariance.matrix) == 16
    assert "gyro1: bias" in said
    text = (tmp_path / "out" / "index.html").read_text()
    assert "Candidate record TETRA-01@2012a-derived" in text
    data = json.loads((tmp_path / "out" / "derivation.json").read_text())
    assert data["candidate"] == "TETRA-01@2012a-derived"
    # A person names it: then results use it.
    shutil.copytree(campaign, tmp_path / "again")
    path = tmp_path / "again" / "runs" / RUNS[0] / "run.yaml"
    path.write_text(path.read_text().replace("TETRA-01@2012a", "TETRA-01@2012a-derived"))
    out = str(tmp_path / "reduced")
    assert main(["reduce", str(path.parent), "--calibrations", str(tmp_path / "out"), "--out", out]) == 0


def test_same_campaign_gives_the_same_bytes_and_another_is_refused(
    campaign, repository, tmp_path, capsys
) -> None:
    out = tmp_path / "out"
    assert derive(campaign, repository, out) == 0
    before = {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    assert derive(campaign, repository, out) == 0
    assert before == {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}
    capsys.readouterr()
    assert derive(campaign, repository, out, "--only-runs", ",".join(RUNS[:5])) == 2
    said = capsys.readouterr().err
    assert "2012a-derived.yaml" in said
    assert "never rewritten" in said
    assert before == {path: path.read_bytes() for path in out.rglob("*") if path.is_file()}


def test_nothing_is_written_as_a_record_where_something_is_open(
    campaign, repository, tmp_path, capsys
) -> None:
    assert derive(campaign, repository, tmp_path / "out", "--only-runs", RUNS[0]) == 0
    said = capsys.readouterr().out
    assert "not determined" in said
    assert "no candidate record" in said
    assert not list((tmp_path / "out").rglob("*.yaml"))


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (["--record-version", "2012a"], "other than 2012a"),
        (["--record-version", "a/b"], "a/b"),
        (["--only-runs", "nobody"], "nobody"),
    ],
)
def test_bad_input_is_one_line(campaign, repository, tmp_path, capsys, words, expected) -> None:
    assert derive(campaign, repository, tmp_path / "out", *words) == 2
    said = capsys.readouterr().err
    assert expected in said
    assert len(said.splitlines()) == 1
    assert not (tmp_path / "out").exists()
