"""Random processes far above the record's, named once."""

from __future__ import annotations

from pathlib import Path

import pytest
from bench_lab import diagnosed, lab, simulated


@pytest.mark.parametrize(
    ("effect", "parameter", "size"),
    [("bias_instability", "deg_h", 3.0), ("rate_random_walk", "deg_h_sqrt_h", 20.0)],
)
def test_it_is_named_alone_at_its_size(tmp_path: Path, effect: str, parameter: str, size: float) -> None:
    lab(tmp_path)
    put = {"effect": effect, "channels": ["gyro2"], "runs": ["*"], "parameters": {parameter: size}}
    found = diagnosed(tmp_path, simulated(tmp_path, [put]))
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert (cause["effect"], cause["channels"]) == (effect, ["gyro2"])
    stated = cause["parameters"][parameter]
    assert abs(stated["value"] - size) < max(3.0 * stated["std"], 0.02 * size)
