"""What is unknown stands in the stead of causes that together do what one thing does."""

from __future__ import annotations

from pathlib import Path

import pytest
from bench_lab import diagnosed, lab, simulated


@pytest.mark.parametrize(
    ("effect", "channels", "parameters", "place"),
    [
        # a turned mount is an axis off at every gyro, each as one rotation has it
        ("mount_rotation", ["table"], {"mrad": [0.15, 0.2, 0.1]}, "table"),
        # a walk is a smooth process and flicker
        ("rate_random_walk", ["gyro1"], {"deg_h_sqrt_h": 4.0}, "gyro1"),
    ],
)
def test_causes_that_do_together_what_one_thing_does_are_none(
    tmp_path: Path, effect: str, channels: list[str], parameters: dict, place: str
) -> None:
    lab(tmp_path)
    put = [{"effect": effect, "channels": channels, "runs": ["*"], "parameters": parameters}]
    out = diagnosed(tmp_path, simulated(tmp_path, put), "--without", effect)
    assert (out["verdict"], out["causes"]) == ("unexplained", [])
    assert out["where"][0]["channels"] == [place]
