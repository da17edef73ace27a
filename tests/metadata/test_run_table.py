"""The table of runs: what listing finds, and that reading gives it back."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from fogreduce.errors import BadInput
from fogreduce.metadata.run_table import RunTable, list_runs


@pytest.fixture
def place(tmp_path: Path) -> Path:
    """Campaign `lab` of two runs, one of which names a record that is there, and `other` of one."""
    for name in ("lab/runs/a", "lab/runs/b", "other/runs/a"):
        folder = tmp_path / "campaigns" / name
        folder.mkdir(parents=True)
        (folder / "run.yaml").write_text("calibration: UNIT@2  # the second\n")
        (folder / "capture.csv").write_text("0.0,1\n")
    (tmp_path / "campaigns/lab/runs/b/run.yaml").write_text("calibration: UNIT@9\n")
    (tmp_path / "campaigns/lab/campaign.yaml").write_text(
        "title: two runs\ncaptures_from: {simulate: {seed: 1}}\n"
    )
    for version in ("1", "2"):
        (tmp_path / "records/UNIT").mkdir(parents=True, exist_ok=True)
        (tmp_path / f"records/UNIT/{version}.yaml").write_text("")
    return tmp_path


def listed(place: Path, *names: str) -> RunTable:
    return list_runs(str(place / "campaigns"), str(place / "records"), names)


def test_what_is_listed(place: Path) -> None:
    (place / "campaigns/lab/runs/.hidden").mkdir()
    (place / "campaigns/lab/runs/no name").mkdir()
    (place / "campaigns/lab/runs/a/.swap").touch()
    table = listed(place)
    assert list(table.campaigns) == ["lab", "other"]
    assert table.records == ["UNIT/1.yaml", "UNIT/2.yaml"]
    lab = table.campaigns["lab"]
    assert (lab.about.title, lab.files, list(lab.runs)) == ("two runs", ["campaign.yaml"], ["a", "b"])
    assert len(lab.left_out) == 1
    assert lab.runs["a"].files == ["capture.csv", "run.yaml"]
    assert lab.runs["a"].records == ["UNIT/2.yaml"]
    assert lab.runs["b"].records == table.records, "which one is for its manifest to find out"


def test_read_is_what_was_written(place: Path) -> None:
    table = listed(place)
    (place / "table.json").write_text(table.text())
    assert RunTable.read(place / "table.json") == table


def test_some_campaigns(place: Path) -> None:
    assert list(listed(place, "other").campaigns) == ["other"]
    with pytest.raises(BadInput) as told:
        listed(place, "third")
    assert str(told.value) == f"{place}/campaigns: found no campaign third; expected one, as configured"


def test_an_edit_is_seen_whatever_the_clock_says(place: Path) -> None:
    capture = place / "campaigns/lab/runs/a/capture.csv"
    before, times = listed(place).campaigns["lab"].runs, capture.stat()
    capture.write_text("0.0,2\n")
    os.utime(capture, ns=(times.st_atime_ns, times.st_mtime_ns))
    after = listed(place).campaigns["lab"].runs
    assert after["a"].says != before["a"].says
    assert after["b"].says == before["b"].says
