"""A gross fault is one cause: what is left of it at the full rate is no line, and no moving base."""

from __future__ import annotations

from pathlib import Path

import pytest
from bench_lab import diagnosed, lab, simulated


def put(effect: str, channel: str, **parameters: object) -> dict:
    return {"effect": effect, "channels": [channel], "runs": ["*"], "parameters": parameters}


@pytest.mark.parametrize(
    "fault",
    [
        put("rotation_sense", "table"),
        put("polarity_error", "gyro2"),
        put("channel_swap", "gyro1", **{"with": "gyro4"}),
    ],
    ids=lambda one: one["effect"],
)
def test_it_is_named_alone(tmp_path: Path, fault: dict) -> None:
    lab(tmp_path, rates=(25.0, -25.0, 25.0, -25.0, 0.5, 0.0))
    found = diagnosed(tmp_path, simulated(tmp_path, [fault]))
    assert found["verdict"] == "explained"
    assert [(c["effect"], c["channels"]) for c in found["causes"]] == [(fault["effect"], fault["channels"])]
