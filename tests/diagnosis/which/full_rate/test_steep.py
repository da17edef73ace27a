"""A filter slow against the sample rate: its steep spectrum is accounted for by it alone."""

from __future__ import annotations

from pathlib import Path

import pytest
from bench_lab import diagnosed, lab, simulated


@pytest.mark.slow
@pytest.mark.parametrize("seed", [5, 6])
@pytest.mark.parametrize("tau_ms", [30.0, 100.0, 200.0])
def test_a_slow_filter_leaves_nothing(tmp_path: Path, tau_ms: float, seed: int) -> None:
    lab(tmp_path, rate_hz=100.0)
    filtered = {"effect": "low_pass", "channels": ["gyro2"], "parameters": {"time_constant_ms": tau_ms}}
    out = diagnosed(tmp_path, simulated(tmp_path, [filtered], seed=seed))
    assert out["verdict"] == "explained"
    assert [(c["effect"], c["channels"]) for c in out["causes"]] == [("low_pass", ["gyro2"])]
    value = out["causes"][0]["parameters"]["time_constant_ms"]
    assert abs(value["value"] - tau_ms) < 2.0 * min(value["std"], 0.02 * tau_ms)
    assert not out["remainder"]["significant"]
    assert out["unknown_probability"] < 0.5
