"""``fogreduce simulate --export-model``: the model as JSON."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fogreduce.cli.main import main

ROOT = Path(__file__).parents[2]


def export(tmp_path: Path, *options: str) -> dict[str, Any]:
    file = tmp_path / "model.json"
    campaign = str(ROOT / "campaigns" / "one-turn-each")
    arguments = ["simulate", campaign, "--calibrations", str(ROOT / "calibrations")]
    assert main([*arguments, "--export-model", str(file), *options]) == 0
    model: dict[str, Any] = json.loads(file.read_text())
    return model


def test_the_nominal_model(tmp_path: Path) -> None:
    model = export(tmp_path)
    assert model["kind"] == "nominal"
    assert np.array(model["H"]) @ np.array(model["G"]) == pytest.approx(np.eye(3), abs=1e-12)
    sigmas = {p["name"]: p["sigma"] for p in model["parameters"]}
    assert sigmas["gyro3.scale_factor"] == pytest.approx(20.0)
    assert sigmas["gyro3.turn_on_bias"] == pytest.approx(0.05)
    assert sigmas["gyro3.axis_1"] == pytest.approx(2e-5)
    assert np.sqrt(np.diag(model["covariance"])) == pytest.approx(list(sigmas.values()))
    about = model["attitude_error_per_orbit"]["about"]["x"]["each_axis_by_itself"]
    assert about["mean_deg"] == [0.0, 0.0, 0.0]
    # 0.05 deg/h of each gyro over 100 minutes, through H's first row (Table 1), beside 20 ppm of 360 deg
    row = np.array(model["H"][0])
    turn_on = 0.05 * 6000 / 3600 * np.linalg.norm(row)
    scale = 20e-6 * 360 * np.linalg.norm(row * np.array(model["G"])[:, 0])
    # 1e-9 V of bias and 2e-5 rad across (second order along x) add little
    assert about["sigma_by_source_deg"]["parameters"][0] == pytest.approx(np.hypot(turn_on, scale), rel=0.01)


def test_with_effects(tmp_path: Path) -> None:
    file = tmp_path / "effects.yaml"
    file.write_text(
        "schema: fogreduce/effects/1\neffects:\n"
        "  - {effect: bias_offset, channels: [gyro2], parameters: {deg_h: 3.0}}\n"
        "  - {effect: table_rate_error, channels: [table], parameters: {ppm: 35}}\n"
        "  - {effect: angle_random_walk, channels: [gyro1], parameters: {deg_sqrt_h: 0.5}}\n"
    )
    model = export(tmp_path, "--effects", str(file))
    assert model["kind"] == "augmented"
    assert model["noise"]["angle_random_walk_deg_sqrt_h"][0] == 0.5
    orbit = model["attitude_error_per_orbit"]
    assert [one["effect"] for one in orbit["left_out"]] == ["table_rate_error"]
    # 3 deg/h over 100 minutes, 5 deg, through H's second column
    found = orbit["about"]["z"]["each_axis_by_itself"]["mean_deg"]
    assert found == pytest.approx((5.0 * np.array(model["H"])[:, 1]).tolist(), rel=1e-9)


def test_with_a_diagnosis(tmp_path: Path) -> None:
    """Causes carry standard deviations into parameters, covariance and the orbit."""
    diagnosis = {
        "schema": "fogreduce/diagnosis/1",
        "causes": [
            {
                "effect": "bias_offset",
                "channels": ["gyro1"],
                "runs": ["*"],
                "parameters": {"deg_h": {"value": 3.0, "std": 0.6}},
            },
            {
                "effect": "axis_misalignment",
                "channels": ["gyro2"],
                "runs": ["*"],
                "parameters": {"mrad": {"value": [0.0, 0.0, 0.3], "std": [0.1, 0.1, 0.1]}},
            },
        ],
    }
    file = tmp_path / "diagnosis.json"
    file.write_text(json.dumps(diagnosis))
    model, nominal = export(tmp_path, "--diagnosis", str(file)), export(tmp_path)
    told = {p["name"]: (p["value"], p["sigma"]) for p in model["parameters"]}
    assert told["gyro1.bias_offset.deg_h"] == (3.0, 0.6)
    assert told["gyro2.axis_misalignment.mrad.z"] == (0.3, 0.1)
    about, before = (
        one["attitude_error_per_orbit"]["about"]["x"]["each_axis_by_itself"] for one in (model, nominal)
    )
    # 3 +- 0.6 deg/h over 100 minutes: 5 +- 1 deg, through H's first column
    column = np.array(model["H"])[:, 0]
    # gyro 2's tip along z, less the part along its axis, has this component along x, which turns by 360 deg
    along = np.array(model["G"])[1] / np.linalg.norm(model["G"][1])
    tipped = 360 * -0.3e-3 * along[2] * along[0] * np.array(model["H"])[:, 1]
    assert about["mean_deg"] == pytest.approx((5.0 * column + tipped).tolist(), rel=1e-6)
    assert about["sigma_deg"][2] == pytest.approx(np.hypot(before["sigma_deg"][2], column[2]), rel=1e-3)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("{}", "fogreduce/diagnosis/1"),
        ('{"schema": "fogreduce/diagnosis/1", "causes": [{"effect": "bias_offset"}]}', "causes[0]"),
        (
            '{"schema": "fogreduce/diagnosis/1", "causes": [{"effect": "no_such", "channels": ["gyro1"],'
            ' "runs": ["*"], "parameters": {}}]}',
            "no_such",
        ),
    ],
)
def test_a_bad_diagnosis_is_one_clear_error(
    text: str, told: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "diagnosis.json"
    file.write_text(text)
    campaign = str(ROOT / "campaigns" / "one-turn-each")
    arguments = ["simulate", campaign, "--calibrations", str(ROOT / "calibrations")]
    assert main([*arguments, "--export-model", str(tmp_path / "m.json"), "--diagnosis", str(file)]) == 2
    assert told in capsys.readouterr().err
    assert not (tmp_path / "m.json").exists()
