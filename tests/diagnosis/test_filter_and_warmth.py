"""A filter and a bias that follows the temperature, at one gyro."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import yaml
from bench_lab import diagnosed, lab, simulated

from fogreduce.metadata.yaml12 import dump_yaml


def test_both_are_named(tmp_path: Path) -> None:
    lab(tmp_path)
    t = np.arange(0.0, 121.0)
    for k, folder in enumerate(sorted((tmp_path / "plan" / "runs").iterdir())):
        degC = 25.0 + 0.01 * t + 0.8 * np.sin(t / 35.0 + k)
        rows = "".join(f"{a:.1f},{b:.4f}\n" for a, b in zip(t, degC, strict=True))
        (folder / "temperature.csv").write_text("time_s,sensor_degC\n" + rows)
        run = yaml.safe_load((folder / "run.yaml").read_text())
        (folder / "run.yaml").write_text(dump_yaml(run | {"temperature": "temperature.csv"}))
    effects = [
        {"effect": name, "channels": ["gyro2"], "runs": ["*"], "parameters": values}
        for name, values in (
            ("low_pass", {"time_constant_ms": 30.0}),
            ("temperature_bias", {"deg_h_per_degC": 1.0}),
        )
    ]
    found = diagnosed(tmp_path, simulated(tmp_path, effects))
    assert found["verdict"] == "explained"
    named = {c["effect"]: c for c in found["causes"]}
    assert named.keys() == {"low_pass", "temperature_bias"}
    stated = named["low_pass"]["parameters"]["time_constant_ms"]
    assert abs(stated["value"] - 30.0) < max(2.0 * stated["std"], 0.6)
