"""Two effects at once: both are named, and nothing unknown stands in for the second."""

from __future__ import annotations

from pathlib import Path

import pytest
from bench_lab import diagnosed, lab, simulated


def put(effect: str, channel: str, **parameters: object) -> dict:
    return {"effect": effect, "channels": [channel], "runs": ["*"], "parameters": parameters}


@pytest.mark.parametrize(
    "effects",
    [
        [put("bias_offset", "gyro4", deg_h=3.0), put("scale_factor_asymmetry", "gyro1", ppm=60.0)],
        [put("table_rate_error", "table", ppm=100.0), put("crosstalk", "gyro3", ppm=300.0, source="gyro1")],
        [put("bias_ramp", "gyro3", deg_h_per_h=100.0), put("bias_offset", "gyro4", deg_h=1.0)],
        [
            put("mount_rotation", "table", mrad=[0.0, 0.1, 0.1]),
            put("rate_random_walk", "gyro3", deg_h_sqrt_h=3.0),
        ],
        [
            put("base_motion", "table", deg_h=0.1, frequency_hz=9.3, axis=[0.6, 0.0, 0.8]),
            put("bias_instability", "gyro1", deg_h=0.2),
        ],
    ],
    ids=lambda effects: "-".join(one["effect"] for one in effects),
)
def test_both_are_named(tmp_path: Path, effects: list[dict]) -> None:
    lab(tmp_path)
    found = diagnosed(tmp_path, simulated(tmp_path, effects))
    assert found["verdict"] == "explained"
    for effect in effects:
        assert any(
            rival["effect"] == effect["effect"] and rival["channels"] == effect["channels"]
            for cause in found["causes"]
            for rival in cause["group"]
        )
    assert len(found["causes"]) == 2


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_a_heading_far_off_beside_two_lines(tmp_path: Path, seed: int) -> None:
    lab(tmp_path)
    effects = [
        put("heading_error", "table", deg=20.0),
        put("periodic_interference", "gyro2", deg_h=60.0, frequency_hz=29.7),
        put("periodic_interference", "gyro3", deg_h=60.0, frequency_hz=11.3),
    ]
    named_and_within(diagnosed(tmp_path, simulated(tmp_path, effects, seed=seed)), effects)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_a_line_and_an_offset_on_one_gyro(tmp_path: Path, seed: int) -> None:
    lab(tmp_path)
    effects = [
        put("periodic_interference", "gyro1", deg_h=5.0, frequency_hz=17.3),
        put("bias_offset", "gyro1", deg_h=1.0),
    ]
    named_and_within(diagnosed(tmp_path, simulated(tmp_path, effects, seed=seed)), effects)


def named_and_within(found: dict, effects: list[dict]) -> None:
    """Each named once and nothing else, its numbers within four standard deviations (once in 16000)."""
    assert found["verdict"] == "explained"
    stated = {(c["effect"], *c["channels"]): c["parameters"] for c in found["causes"]}
    assert set(stated) == {(e["effect"], *e["channels"]) for e in effects}
    assert len(found["causes"]) == len(effects)
    for effect in effects:
        for name, value in effect["parameters"].items():
            number = stated[effect["effect"], *effect["channels"]][name]
            assert abs(number["value"] - value) < 4.0 * number["std"]
