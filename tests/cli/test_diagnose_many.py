"""``fogreduce diagnose`` over many campaigns: each as if alone, and one that cannot be stops no other."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest
from bench_lab import lab, simulated

from fogreduce.cli.main import main

RAMP = {"effect": "bias_ramp", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h_per_h": 40.0}}


@pytest.fixture(scope="module")
def made(tmp_path_factory) -> Path:
    """Two campaigns in a folder `many`: one with a ramp, one with nothing; and their calibrations."""
    root = tmp_path_factory.mktemp("many")
    lab(root, duration_s=60.0)
    simulated(root, [RAMP], "many/with-ramp")
    simulated(root, [], "many/with-nothing", seed=7)
    return root


def run(root: Path, *words: str) -> int:
    return main(["diagnose", *words, "--calibrations", str(root / "cal")])


def test_a_folder_of_campaigns_gives_each_what_it_gets_alone(made, tmp_path, capsys) -> None:
    assert run(made, str(made / "many"), "--out", str(tmp_path / "out")) == 0
    said = capsys.readouterr().out.splitlines()
    assert [line.split(": ")[1] for line in said] == ["no gap", "explained"]
    for name in ("with-ramp", "with-nothing"):
        assert run(made, str(made / "many" / name), "--out", str(tmp_path / name)) == 0
        files = {p.relative_to(tmp_path / name) for p in (tmp_path / name).rglob("*") if p.is_file()}
        assert Path("diagnosis.json") in files
        for file in files:
            alone = (tmp_path / name / file).read_bytes()
            assert (tmp_path / "out" / name / file).read_bytes() == alone, file


def test_several_campaigns_named_one_by_one(made, tmp_path) -> None:
    both = [str(made / "many" / name) for name in ("with-ramp", "with-nothing")]
    assert run(made, *both, "--out", str(tmp_path)) == 0
    assert {p.parent.name for p in tmp_path.glob("*/diagnosis.json")} == {"with-ramp", "with-nothing"}


def test_what_holds_for_one_campaign_alone(made, tmp_path) -> None:
    each = tmp_path / "each.json"
    each.write_text(
        json.dumps({"with-ramp": {"without": ["bias_ramp"]}, "with-nothing": {"only_runs": ["r0", "r2"]}})
    )
    assert run(made, str(made / "many"), "--out", str(tmp_path / "out"), "--each", str(each)) == 0
    ramp, nothing = (
        json.loads((tmp_path / "out" / name / "diagnosis.json").read_text())
        for name in ("with-ramp", "with-nothing")
    )
    assert "bias_ramp" not in ramp["catalogue"]
    assert "bias_ramp" in nothing["catalogue"]
    assert (len(ramp["runs"]), nothing["runs"]) == (6, ["r0", "r2"])


def test_a_campaign_that_cannot_be_diagnosed_stops_no_other(made, tmp_path, capsys) -> None:
    shutil.copytree(made / "many", tmp_path / "many")
    broken = tmp_path / "many" / "a-broken-one" / "runs" / "r0"
    broken.mkdir(parents=True)
    (broken / "run.yaml").write_text("schema: fogreduce/run/1\n")
    assert run(made, str(tmp_path / "many"), "--out", str(tmp_path / "out")) == 2
    said = capsys.readouterr()
    assert "a-broken-one" in said.err
    assert "Traceback" not in said.err
    assert len(said.out.splitlines()) == 2
    assert not (tmp_path / "out" / "a-broken-one").exists()


def test_a_fault_of_ours_in_one_campaign_stops_no_other(made, tmp_path, capsys, monkeypatch) -> None:
    from fogreduce.diagnosis import diagnose as module

    right = module.diagnose

    def wrong(campaign: Path, *others: object) -> object:
        if campaign.name == "with-nothing":
            raise ZeroDivisionError
        return right(campaign, *others)

    monkeypatch.setattr(module, "diagnose", wrong)
    assert run(made, str(made / "many"), "--out", str(tmp_path)) == 1
    assert "with-nothing: not diagnosed" in capsys.readouterr().err
    assert (tmp_path / "with-ramp" / "diagnosis.json").is_file()


@pytest.mark.parametrize(
    ("each", "words"),
    [
        ({"elsewhere": {}}, ["elsewhere", "no such campaign"]),
        ({"with-ramp": {"effects": []}}, ["with-ramp.effects", "without or only_runs"]),
        ({"with-ramp": {"without": "bias_ramp"}}, ["with-ramp.without", "a list of names"]),
        ({"with-ramp": {"without": ["gremlins"]}}, ["each.json: with-ramp.without[0]: found gremlins"]),
        ({"with-ramp": 3}, ["with-ramp", "a mapping"]),
    ],
)
def test_a_bad_file_for_each(made, tmp_path, capsys, each, words) -> None:
    path = tmp_path / "each.json"
    path.write_text(json.dumps(each))
    assert run(made, str(made / "many"), "--out", str(tmp_path / "out"), "--each", str(path)) == 2
    said = capsys.readouterr().err
    assert all(word in said for word in words)
    assert not (tmp_path / "out").exists()


def test_two_campaigns_of_one_name(made, tmp_path, capsys) -> None:
    shutil.copytree(made / "many" / "with-ramp", tmp_path / "with-ramp")
    both = [str(made / "many" / "with-ramp"), str(tmp_path / "with-ramp")]
    assert run(made, *both, "--out", str(tmp_path / "out")) == 2
    assert "with-ramp: found two campaigns of this name" in capsys.readouterr().err


def test_one_prediction_does_not_stand_for_several_campaigns(made, tmp_path, capsys) -> None:
    many = str(made / "many")
    assert run(made, many, "--out", str(tmp_path), "--simulated", many) == 2
    assert "--simulated: found 2 campaigns; expected one campaign" in capsys.readouterr().err
