"""``fogreduce diagnose`` from outside: what it writes, what it says of what was put in, and what it
refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fogreduce.cli.main import main
from fogreduce.metadata.yaml12 import dump_yaml

AXES = {"x": {"x": "up", "z": "north"}, "y": {"y": "up", "x": "north"}, "z": {"z": "up", "y": "north"}}
RECORD = {
    "schema": "fogreduce/calibration/1",
    "unit": "U",
    "version": "1",
    "valid_from": "2012-06-01T00:00:00Z",
    "procedure": "made up",
    "H": [[0.29, 0.29, 0.29, 0.5], [0.0, 0.71, -0.7, 0.0], [0.81, -0.41, -0.41, 0.0]],
    "scale_factor_V_per_deg_s": [0.075, 0.09, 0.092, 0.075],
    "bias_V": [1e-4, 6e-4, 2e-4, -4e-4],
    "uncertainty": {
        "scale_factor_rel": [2e-5] * 4,
        "bias_V": [1e-9] * 4,
        "axis_rad": [2e-5] * 4,
        "turn_on_bias_deg_h": [0.05] * 4,
    },
    "noise": {
        "angle_random_walk_deg_sqrt_h": [2e-3] * 4,
        "bias_instability_deg_h": [0.03] * 4,
        "rate_random_walk_deg_h_sqrt_h": [0.0] * 4,
    },
}
ONE_GYRO = {
    **{k: v for k, v in RECORD.items() if k not in ("H", "uncertainty", "noise")},
    "axes": [[1.0, 0.0, 0.0]],
    "scale_factor_V_per_deg_s": [0.075],
    "bias_V": [1e-4],
}


def lab(root: Path, record: dict = RECORD, rate_hz: float = 64.0, duration_s: float = 120.0) -> None:
    """Six runs without captures: both senses about x and y, one slow, one still."""
    n = len(record["bias_V"])
    (root / "cal" / "U").mkdir(parents=True)
    (root / "cal" / "U" / "1.yaml").write_text(dump_yaml(record))
    turns = [("x", 10.0), ("x", -10.0), ("y", 10.0), ("y", -10.0), ("z", 0.5), ("x", 0.0)]
    for k, (axis, rate) in enumerate(turns):
        folder = root / "plan" / "runs" / f"r{k}"
        folder.mkdir(parents=True)
        run = {
            "schema": "fogreduce/run/1",
            "run_id": f"r{k}",
            "unit": "U",
            "started_at": "2014-05-12T13:00:00Z",
            "site": {"latitude_deg": -23.2},
            "table": {"axis": axis, "profile": [{"rate_deg_s": rate, "duration_s": duration_s}]},
            "orientation": AXES[axis],
            "capture": {
                "file": "capture.fogcap",
                "format": "fogcap-1",
                "sample_rate_hz": rate_hz,
                "volts_per_count": 1e-7,
                "polarity": [1] * n,
            },
            "calibration": "U@1",
        }
        (folder / "run.yaml").write_text(dump_yaml(run))


def simulated(root: Path, effects: list[dict], name: str = "bench", seed: int = 5) -> Path:
    """A campaign made by the simulator with effects in it and the stated uncertainties drawn."""
    path = root / f"{name}.yaml"
    path.write_text(dump_yaml({"schema": "fogreduce/effects/1", "effects": effects}))
    arguments = [
        "simulate",
        str(root / "plan"),
        "--calibrations",
        str(root / "cal"),
        "--out",
        str(root / name),
    ]
    assert main([*arguments, "--effects", str(path), "--seed", str(seed), "--draw-uncertainties"]) == 0
    return root / name


def diagnosed(root: Path, campaign: Path, *more: str) -> dict:
    out = root / f"out-{campaign.name}"
    assert (
        main(["diagnose", str(campaign), "--calibrations", str(root / "cal"), "--out", str(out), *more]) == 0
    )
    return json.loads((out / "diagnosis.json").read_text())


RAMP = {"effect": "bias_ramp", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h_per_h": 40.0}}


def test_what_was_put_in_is_found_and_closes_the_gap(tmp_path) -> None:
    lab(tmp_path)
    found = diagnosed(tmp_path, simulated(tmp_path, [RAMP]))
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert (cause["effect"], cause["channels"], cause["runs"]) == ("bias_ramp", ["gyro2"], ["*"])
    value = cause["parameters"]["deg_h_per_h"]
    # 4 standard deviations: once in 16000
    assert abs(value["value"] - 40.0) < 4.0 * value["std"]
    assert found["where"][0]["channels"] == ["gyro2"]
    assert found["closure"]["fraction"] > 0.9
    assert abs(found["closure"].get("placebo_fraction", 0.0)) < 0.2
    assert sum(place["share"] for place in found["where"]) <= 1.0
    out = tmp_path / "out-bench"
    assert (out / "index.html").read_text().startswith("<!DOCTYPE html>")
    # simulator.yaml runs as it stands
    arguments = ["simulate", str(tmp_path / "plan"), "--calibrations", str(tmp_path / "cal")]
    assert main([*arguments, "--effects", str(out / "simulator.yaml"), "--out", str(tmp_path / "again")]) == 0


def test_nothing_put_in_is_no_gap(tmp_path) -> None:
    lab(tmp_path)
    found = diagnosed(tmp_path, simulated(tmp_path, []))
    assert (found["verdict"], found["causes"], found["closure"]) == ("no_gap", [], None)
    assert found["gap_probability"] < 0.5


def test_an_effect_left_out_is_not_named(tmp_path) -> None:
    lab(tmp_path)
    found = diagnosed(tmp_path, simulated(tmp_path, [RAMP]), "--without", "bias_ramp")
    assert "bias_ramp" not in found["catalogue"]
    assert found["verdict"] != "no_gap"
    assert all(cause["effect"] != "bias_ramp" for cause in found["causes"])
    assert found["where"][0]["channels"] == ["gyro2"]


@pytest.mark.parametrize(
    ("effect", "channels", "parameters"),
    [
        ("polarity_error", ["gyro3"], {}),
        ("rotation_sense", ["table"], {}),
        ("dropouts", ["gyro1"], {"fraction": 0.01}),
        ("lost_bits", ["gyro4"], {"bits": 5}),
        ("clock_error", ["clock"], {"ppm": 20.0}),
        ("common_noise", ["gyro1", "gyro2", "gyro3", "gyro4"], {"correlation": 0.2}),
    ],
)
def test_faults_of_every_kind(tmp_path, effect, channels, parameters) -> None:
    lab(tmp_path)
    entry = {"effect": effect, "channels": channels, "runs": ["*"], "parameters": parameters}
    found = diagnosed(tmp_path, simulated(tmp_path, [entry]))
    assert found["verdict"] == "explained"
    assert [(c["effect"], c["channels"]) for c in found["causes"]] == [(effect, channels)]


def test_another_simulators_captures_as_the_prediction(tmp_path) -> None:
    lab(tmp_path)
    bench = simulated(tmp_path, [RAMP])
    same = diagnosed(tmp_path, bench, "--simulated", str(bench))
    assert same["verdict"] == "no_gap"


def test_one_gyro_and_a_slow_log(tmp_path) -> None:
    lab(tmp_path, ONE_GYRO, rate_hz=0.2, duration_s=1200.0)
    entry = {"effect": "bias_step", "channels": ["gyro1"], "runs": ["r5"]}
    entry["parameters"] = {"deg_h": 60.0, "time_s": 600.0}
    found = diagnosed(tmp_path, simulated(tmp_path, [entry]))
    assert found["verdict"] == "explained"
    assert found["causes"][0]["effect"] == "bias_step"
    assert found["causes"][0]["runs"] == ["r5"]


@pytest.mark.parametrize(
    ("more", "says"),
    [
        (["--without", "gremlins"], "--without: found gremlins; expected an effect of the catalogue"),
        (["--only-runs", "r9"], "--only-runs: found r9; expected one of r0"),
    ],
)
def test_bad_input_is_one_clear_line(tmp_path, capsys, more, says) -> None:
    lab(tmp_path)
    out = tmp_path / "out"
    arguments = [
        "diagnose",
        str(tmp_path / "plan"),
        "--calibrations",
        str(tmp_path / "cal"),
        "--out",
        str(out),
    ]
    assert main([*arguments, *more]) == 2
    assert says in capsys.readouterr().err
    assert not out.exists()


def test_a_campaign_without_captures_is_refused(tmp_path, capsys) -> None:
    lab(tmp_path)
    arguments = ["diagnose", str(tmp_path / "plan"), "--calibrations", str(tmp_path / "cal")]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 2
    assert "capture.fogcap, which is not there" in capsys.readouterr().err
