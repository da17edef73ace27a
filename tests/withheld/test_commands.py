"""The commands: what they write, and one clear line where the input is bad."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from bench import COUNTS_PER_DEG_H, campaign, run

from withheld.chain.capture_file import read_capture
from withheld.chain.injector import realistic_world, write_campaign
from withheld.cli import main
from withheld.score.diagnosis_file import read_diagnosis
from withheld.study.run_diagnoser import run_batch

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture
def batch(tmp_path):
    """Two small campaigns as a batch."""
    folder = tmp_path / "batch"
    for name in ("case-0001", "case-0002"):
        of = campaign(run("a", duration=1.0))
        write_campaign(realistic_world(of, (), 1), folder / "campaigns" / name, folder / "calibrations")
    asked = {"case-0001": {"without": []}, "case-0002": {"without": ["spikes"]}}
    (folder / "public.json").write_text(json.dumps(asked))
    return folder


@pytest.mark.parametrize("name", ["no_gap", "one_group", "unexplained", "guess"])
def test_candidates_write_what_the_contract_asks(batch, tmp_path, name):
    assert main(["candidate", name, "--batch", str(batch), "--out", str(tmp_path / "out")]) == 0
    for case in ("case-0001", "case-0002"):
        path = tmp_path / "out" / case / "diagnosis.json"
        read_diagnosis(path)
        document = json.loads(path.read_text())
        assert ("spikes" in document["catalogue"]) == (case == "case-0001")
        assert document["campaign"] == case
        assert document["runs"] == ["a"]


def test_a_diagnoser_is_run_once_a_case_with_what_it_may_know(batch, tmp_path):
    script = tmp_path / "say.py"
    script.write_text("import sys, pathlib\nout = pathlib.Path(sys.argv[sys.argv.index('--out') + 1])\n"
                      "out.mkdir(parents=True)\n(out / 'said').write_text"
                      "(' '.join(sys.argv[1:]))\n")  # fmt: skip
    template = f"{sys.executable} {script} {{campaign}} --calibrations {{calibrations}} --out {{out}}"
    run_batch(template, batch, tmp_path / "out")
    plain, lacking = ((tmp_path / "out" / f"case-000{k}" / "said").read_text() for k in (1, 2))
    assert plain.startswith(f"{batch}/campaigns/case-0001 --calibrations {batch}/calibrations --out ")
    assert "--without" not in plain
    assert lacking.endswith("--without spikes")
    timing = json.loads((tmp_path / "out" / "timing.json").read_text())
    assert timing["case-0001"]["exit"] == 0
    assert timing["case-0001"]["wall_s"] > 0


def test_a_diagnoser_that_fails_leaves_no_diagnosis_and_its_last_words(batch, tmp_path):
    template = f"{sys.executable} -c 'import sys; sys.exit(\"broken\")' {{campaign}} {{out}}"
    run_batch(template, batch, tmp_path / "out")
    timing = json.loads((tmp_path / "out" / "timing.json").read_text())
    assert (timing["case-0002"]["exit"], timing["case-0002"]["said"]) == (1, "broken")
    assert not list((tmp_path / "out").rglob("diagnosis.json"))


BAD = {
    "no such study": (
        ["protocol", "--study", "big", "--seed", "1000001", "--out", "p"],
        "expected small, quarter, full or whole",
    ),
    "a training seed": (["protocol", "--study", "small", "--seed", "7", "--out", "p"], "study seed 7"),
    "a wrong number": (
        ["protocol", "--study", "small", "--seed", "1000001", "--cases", "3", "--out", "p"],
        "has 20 cases, not 3",
    ),
    "no protocol": (
        ["make", "--protocol", "none.json", "--batch", "0", "--size", "1", "--out", "o", "--labels", "l"],
        "none.json: cannot be read",
    ),
    "a study's seed": (["train", "--seed", "1000000", "--first", "1", "--out", "o"], "training seed 1000000"),
    "no such candidate": (
        ["candidate", "nobody", "c", "--calibrations", "k", "--out", "o"],
        "expected one of no_gap",
    ),
    "no campaign": (["candidate", "guess", "--out", "o"], "expected CAMPAIGN"),
    "an empty folder": (
        ["candidate", "guess", ".", "--calibrations", "k", "--out", "o"],
        "no runs/*/run.yaml",
    ),
    "nothing to seal": (["seal", "--root", ".", "--files", "*.none", "--out", "s"], "nothing to seal"),
}


@pytest.mark.parametrize("what", BAD)
def test_bad_input_is_one_line_and_status_2(what, tmp_path, monkeypatch, capsys):
    arguments, message = BAD[what]
    monkeypatch.chdir(tmp_path)
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    assert message in said


@pytest.mark.parametrize(
    ("template", "message"),
    [
        ("diagnose", "expected {campaign} and {out}"),
        ("diagnose {campaign} {out} {labels}", "expected only the fields"),
        ("/no/such/program {campaign} {out}", "cannot be run"),
    ],
)
def test_a_bad_diagnoser_is_bad_input(batch, tmp_path, capsys, template, message):
    assert (
        main(["diagnose", "--diagnoser", template, "--batch", str(batch), "--out", str(tmp_path / "o")]) == 2
    )
    assert message in capsys.readouterr().err


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"schema": "other"}, "expected fogreduce/diagnosis/1"),
        ({"verdict": "fine"}, "expected one of no_gap"),
        ({"gap_probability": 1.2}, "expected a number from 0 to 1"),
        ({"where": [{"stage": "moon", "channels": []}]}, "stage is 'moon'"),
        ({"causes": [{"effect": "spikes"}]}, "not of the contract's form"),
    ],
)
def test_a_malformed_diagnosis_names_its_fault(tmp_path, change, message):
    from withheld.errors import BadInput

    good = {"schema": "fogreduce/diagnosis/1", "verdict": "no_gap", "gap_probability": 0.1,
            "unknown_probability": 0.0, "where": [], "causes": [], "closure": None}  # fmt: skip
    path = tmp_path / "diagnosis.json"
    path.write_text(json.dumps(good))
    assert read_diagnosis(path).verdict == "no_gap"
    path.write_text(json.dumps(good | change))
    with pytest.raises(BadInput, match=message):
        read_diagnosis(path)


def test_a_training_set_has_open_labels(tmp_path):
    assert (
        main(["train", "--study", "small", "--seed", "3", "--first", "1", "--out", str(tmp_path / "t")]) == 0
    )
    labels = json.loads((tmp_path / "t" / "labels.json").read_text())
    assert [one["case"] for one in labels] == [p.name for p in (tmp_path / "t" / "campaigns").iterdir()]


EFFECTS = """schema: fogreduce/effects/1
effects:
  - {effect: bias_ramp, channels: [gyro2], runs: ["*"], parameters: {deg_h_per_h: 7.2e+05}}
"""


def injected(batch, out, *more):
    campaign = batch / "campaigns" / "case-0001"
    calibrations = str(batch / "calibrations")
    return main(["inject", str(campaign), "--calibrations", calibrations, "--out", str(out), *more])


def test_inject_puts_a_file_s_effects_into_a_campaign(batch, tmp_path):
    (tmp_path / "e.yaml").write_text(EFFECTS)
    assert injected(batch, tmp_path / "plain", "--exact") == 0
    assert injected(batch, tmp_path / "ramp", "--exact", "--effects", str(tmp_path / "e.yaml")) == 0
    where = "campaigns/case-0001/runs/a/capture.fogcap"
    plain, ramp = (read_capture(tmp_path / name / where).counts for name in ("plain", "ramp"))
    # 7.2e5 deg/h/h: after a second 200 deg/h
    expected = 200.0 * np.arange(64) / 64.0 * COUNTS_PER_DEG_H
    assert ramp[:, 1] - plain[:, 1] == pytest.approx(expected, abs=1.0)
    assert (ramp[:, [0, 2]] == plain[:, [0, 2]]).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("effects/1", "other"), "expected schema"),
        (("bias_ramp", "bias_rampp"), "effect 1: no effect bias_rampp"),
        (("gyro2", "gyro9"), "effect 1: channels"),
        (('"*"', '"z"'), "effect 1: runs"),
        (("deg_h_per_h", "deg_h"), "bias_ramp has"),
        (("channels", "chanels"), "effect 1: expected effect, channels"),
    ],
)
def test_a_bad_effects_file_names_its_fault(batch, tmp_path, capsys, change, message):
    (tmp_path / "e.yaml").write_text(EFFECTS.replace(*change))
    assert injected(batch, tmp_path / "o", "--effects", str(tmp_path / "e.yaml")) == 2
    assert message in capsys.readouterr().err


def test_it_starts_as_a_program():
    done = subprocess.run(
        [sys.executable, "-m", "withheld", "--help"], cwd=ROOT, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0
    assert "protocol" in done.stdout
