"""A record gone stale: what the diagnosis says of the same campaign agrees with what is derived from it."""

from __future__ import annotations

import json

import numpy as np
import pytest

from fogreduce.calibrate.coefficients import Coefficients
from fogreduce.calibrate.derive import derive
from fogreduce.cli.main import main

BIAS_DEG_H = (8.0, -6.0, 10.0, 7.0)
SCALE_PPM = (1500.0, -1800.0, 2100.0, -1400.0)


@pytest.mark.slow
def test_a_diagnosis_and_a_derivation_agree_within_both_errors(bench, capsys) -> None:
    effects = [
        {"effect": effect, "channels": [f"gyro{k + 1}"], "runs": ["*"], "parameters": {key: value}}
        for effect, key, values in (
            ("bias_offset", "deg_h", BIAS_DEG_H),
            ("scale_factor_error", "ppm", SCALE_PPM),
        )
        for k, value in enumerate(values)
    ]
    campaign = bench.simulate(effects)
    out = bench.folder / "diagnosis"
    words = ["diagnose", str(campaign), "--calibrations", str(bench.calibrations), "--out", str(out)]
    assert main(words) == 0
    said = json.loads((out / "diagnosis.json").read_text())
    assert "fogreduce derive-calibration" in (out / "index.html").read_text()
    found = derive(campaign, bench.calibrations)
    present, parameters = Coefficients.of(found.readings[0].record), found.parameters
    scale = found.readings[0].facts.scale_factor * parameters.scale_ratio
    derived = {
        "bias_offset": (parameters.bias_deg_h - present.bias_deg_h, parameters.standard_errors[:, 0]),
        "scale_factor_error": (
            (scale / present.scale_factor - 1) * 1e6,
            parameters.standard_errors[:, 1] * 1e6,
        ),
    }
    compared = 0
    for cause in said["causes"]:
        if cause["effect"] not in derived or cause["runs"] != ["*"]:
            continue
        gyro = int(cause["channels"][0].removeprefix("gyro")) - 1
        (parameter,) = cause["parameters"].values()
        values, stds = derived[cause["effect"]]
        both = np.hypot(parameter["std"], stds[gyro])
        assert parameter["value"] == pytest.approx(values[gyro], abs=3 * both), cause
        compared += 1
    assert compared == 8
