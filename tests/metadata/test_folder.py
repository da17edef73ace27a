"""Folders: names, defaults, what may be absent."""

import pytest

from fogreduce.errors import BadInput
from fogreduce.metadata.campaign import Campaign
from fogreduce.metadata.folder import (
    find_runs,
    is_name,
    list_campaigns,
    list_runs,
    load_campaign,
    load_run,
    named_calibration,
)


@pytest.mark.parametrize("name", ["a", "1-xp", "TETRA-01", "2012a", "a" * 64, "a..b", "x_1.2"])
def test_names(name):
    assert is_name(name)


@pytest.mark.parametrize("name", ["", ".", "..", ".a", "-a", "a/b", "a b", "a" * 65, "a\n", "é", "a@b"])
def test_what_is_no_name(name):
    assert not is_name(name)


def test_calibration_of_the_campaign_stands_in(lab):
    lab.edit("run", "calibration: TETRA-01@2012a\n", "")
    assert load_run(lab.run).calibration == "TETRA-01@2012a"
    assert named_calibration(lab.run) == "TETRA-01@2012a"


def test_calibration_of_the_run_goes_first(lab):
    lab.edit("campaign", "TETRA-01@2012a", "TETRA-01@2010a")
    assert load_run(lab.run).calibration == "TETRA-01@2012a"


def test_calibration_named_nowhere(lab):
    lab.edit("run", "calibration: TETRA-01@2012a\n", "")
    lab.edit("campaign", "calibration: TETRA-01@2012a\n", "")
    with pytest.raises(BadInput, match="calibration: found nothing; expected calibration record"):
        load_run(lab.run)
    assert named_calibration(lab.run) is None


def test_broken_campaign_file_is_told_where_it_is_needed(lab):
    lab.files["campaign"].write_text("title: [")
    load_run(lab.run)
    lab.edit("run", "calibration: TETRA-01@2012a\n", "")
    with pytest.raises(BadInput, match=r"campaign\.yaml: line"):
        load_run(lab.run)


def test_relative_paths(lab, monkeypatch):
    lab.edit("run", "calibration: TETRA-01@2012a\n", "")
    for folder, path in (
        (lab.run, "."),
        (lab.run.parent, "r1"),
        (lab.campaign, "runs/r1"),
        (lab.calibrations, "../c1/runs/r1"),
    ):
        monkeypatch.chdir(folder)
        assert load_run(path).calibration == "TETRA-01@2012a"


def test_capture_may_be_absent_where_it_is_not_needed(lab):
    (lab.run / "capture.fogcap").unlink()
    assert load_run(lab.run, need_capture=False).run_id == "r1"


def test_named_calibration_despite_other_faults(lab):
    lab.edit("run", "unit: TETRA-01", "unit: 5")
    assert named_calibration(lab.run) == "TETRA-01@2012a"
    lab.files["run"].write_text("[")
    assert named_calibration(lab.run) is None


def test_runs_and_campaigns_in_order(lab):
    (lab.campaign / "runs" / "a1").mkdir()
    (lab.campaign / "runs" / ".hidden").mkdir()
    (lab.campaign / "runs" / "notes.txt").write_text("")
    assert [path.name for path in list_runs(lab.campaign)] == ["a1", "r1"]
    assert [path.name for path in list_campaigns(lab.campaign.parent)] == ["c1"]


def test_folders_with_bad_names(lab):
    (lab.campaign / "runs" / "run 2").mkdir()
    (lab.campaign / "runs" / "-3").mkdir()
    with pytest.raises(BadInput) as error:
        list_runs(lab.campaign)
    assert len(error.value.faults) == 2
    runs, faults = find_runs(lab.campaign)
    assert [path.name for path in runs] == ["r1"]
    assert len(faults) == 2


def test_only_folders_with_runs_are_campaigns(lab):
    root = lab.campaign.parent
    (root / "my notes").mkdir()
    assert [path.name for path in list_campaigns(root)] == ["c1"]
    (root / "my notes" / "runs").mkdir()
    with pytest.raises(BadInput, match="my notes: found this folder's name; expected a name of 1 to 64"):
        list_campaigns(root)


def test_a_run_named_from_below(lab, monkeypatch):
    (lab.run / "below").mkdir()
    monkeypatch.chdir(lab.run / "below")
    assert load_run("..").run_id == "r1"


def test_no_runs(lab, tmp_path):
    with pytest.raises(BadInput, match="runs: found no such folder; expected a folder with one folder a run"):
        list_runs(tmp_path)
    (tmp_path / "runs").mkdir()
    with pytest.raises(BadInput, match="runs: found no run; expected one folder a run"):
        list_runs(tmp_path)


def test_campaign_without_a_file(lab):
    lab.files["campaign"].unlink()
    assert load_campaign(lab.campaign) == Campaign()
