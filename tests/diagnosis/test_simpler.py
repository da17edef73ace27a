"""The unknown gets no credit for having fewer numbers than an effect that does the same."""

from __future__ import annotations

from pathlib import Path

import pytest
from bench_lab import diagnosed, lab, simulated


@pytest.mark.parametrize("deg_h", [0.5, 8.0])
def test_a_magnetic_bias_about_one_axis_is_believed_at_any_size(tmp_path: Path, deg_h: float) -> None:
    lab(tmp_path)
    put = {
        "effect": "magnetic_bias",
        "channels": ["gyro1"],
        "runs": ["*"],
        "parameters": {"deg_h": deg_h, "field_direction": [0.0, 1.0, 0.0]},
    }
    found = diagnosed(tmp_path, simulated(tmp_path, [put]), "--only-runs", "r0,r1")
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert (cause["effect"], cause["channels"]) == ("magnetic_bias", ["gyro1"])
    assert cause["probability"] > 0.8
