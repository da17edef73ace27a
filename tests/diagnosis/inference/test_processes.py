"""Random processes of the catalogue as causes: one that drowns all else is named alone, at its size."""

from __future__ import annotations

import pytest
from bench_lab import diagnosed, lab, simulated


@pytest.mark.parametrize(
    ("size", "duration_s"), [(900.0, 120.0), pytest.param(300.0, 300.0, marks=pytest.mark.slow)]
)
def test_a_strong_walk_is_a_walk_and_nothing_else(tmp_path, size: float, duration_s: float) -> None:
    lab(tmp_path, duration_s=duration_s)
    walk = {"effect": "rate_random_walk", "channels": ["gyro2"], "parameters": {"deg_h_sqrt_h": size}}
    document = diagnosed(tmp_path, simulated(tmp_path, [walk], seed=1))
    assert document["verdict"] == "explained"
    assert [(c["effect"], c["channels"]) for c in document["causes"]] == [("rate_random_walk", ["gyro2"])]
    found = document["causes"][0]["parameters"]["deg_h_sqrt_h"]
    assert abs(found["value"] - size) < 2.0 * found["std"]
