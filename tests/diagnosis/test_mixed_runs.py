"""Runs of one campaign that differ in rate, length or noise; noise that no record states; coarse steps."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from bench_lab import ONE_GYRO, RECORD, diagnosed, simulated, write_record, write_run


def campaign(
    root: Path,
    record: dict[str, Any],
    runs: list[tuple[str, float, float, float]],
    effects: list[dict[str, Any]] | None = None,
    volts_per_count: float = 1e-7,
    seed: int = 3,
) -> Path:
    """Runs of (axis, rate [deg/s], duration [s], sample rate [Hz]), simulated."""
    write_record(root, record)
    gyros = len(record["scale_factor_V_per_deg_s"])
    for k, (axis, rate, duration, hertz) in enumerate(runs):
        write_run(root, f"r{k}", axis, [(rate, duration)], gyros, hertz, "csv-1", volts_per_count)
    return simulated(root, effects or [], "bench", seed)


@pytest.mark.parametrize(
    ("record", "first", "second", "seconds"),
    [
        (RECORD, 64.0, 128.0, 60.0),
        (ONE_GYRO, 64.0, 128.0, 60.0),
        (RECORD, 10.0, 100.0, 100.0),
        (RECORD, 0.5, 1.0, 1000.0),
        (RECORD, 1.0, 1.001, 1000.0),
        (RECORD, 0.5, 1.0, 300.0),
    ],
)
def test_runs_at_two_rates_with_nothing_wrong(tmp_path, record, first, second, seconds) -> None:
    for name, hertz in (("a", (first, second)), ("b", (second, first))):
        runs = [(axis, 10.0, seconds, rate) for axis, rate in zip("xx", hertz, strict=True)]
        found = diagnosed(tmp_path / name, campaign(tmp_path / name, record, runs))
        assert found["verdict"] == "no_gap", found["where"]


def test_a_long_run_beside_a_short_one(tmp_path) -> None:
    runs = [("x", 10.0, 1000.0, 10.0), ("x", 0.0, 20.0, 10.0), ("y", -10.0, 3.0, 10.0)]
    assert diagnosed(tmp_path, campaign(tmp_path, RECORD, runs))["verdict"] == "no_gap"


def noisy(value: float, runs: list[str]) -> dict[str, Any]:
    return {
        "effect": "angle_random_walk",
        "channels": ["gyro1"],
        "runs": runs,
        "parameters": {"deg_sqrt_h": value},
    }


@pytest.mark.parametrize("record", [RECORD, ONE_GYRO])
def test_a_gyro_three_times_as_noisy_in_one_run(tmp_path, record) -> None:
    stated = 0.002 if record is RECORD else 0.05
    runs = [("x", 10.0, 60.0, 64.0), ("x", 0.0, 60.0, 64.0)]
    found = diagnosed(tmp_path, campaign(tmp_path, record, runs, [noisy(3.0 * stated, ["r1"])]))
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert (cause["effect"], cause["channels"], cause["runs"]) == ("angle_random_walk", ["gyro1"], ["r1"])
    number = cause["parameters"]["deg_sqrt_h"]
    assert number["value"] == pytest.approx(3.0 * stated, abs=3.0 * number["std"])


def ramp(deg_h_per_h: float) -> dict[str, Any]:
    return {
        "effect": "bias_ramp",
        "channels": ["gyro1"],
        "runs": ["*"],
        "parameters": {"deg_h_per_h": deg_h_per_h},
    }


def test_a_ramp_in_runs_at_two_rates(tmp_path) -> None:
    runs = [("x", 10.0, 60.0, 64.0), ("x", -10.0, 60.0, 128.0), ("y", 10.0, 60.0, 64.0)]
    found = diagnosed(tmp_path, campaign(tmp_path, RECORD, runs, [ramp(300.0)]))
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert (cause["effect"], cause["channels"]) == ("bias_ramp", ["gyro1"])


COARSE = {**ONE_GYRO, "scale_factor_V_per_deg_s": [1.0], "bias_V": [0.0]}
#: White noise of 0.3 deg/s a sample at 100 Hz: N = 0.3 x 60 / sqrt(100).
N = 1.8


def test_white_noise_of_a_coarse_converter_is_right_where_the_record_states_another(tmp_path) -> None:
    record = {**COARSE, "noise": {"angle_random_walk_deg_sqrt_h": [0.05]}}
    runs = [("x", 10.0, 60.0, 100.0), ("x", 0.0, 60.0, 100.0)]
    found = diagnosed(tmp_path, campaign(tmp_path, record, runs, [noisy(N, ["*"])], 0.05))
    (cause,) = found["causes"]
    number = cause["parameters"]["deg_sqrt_h"]
    assert cause["effect"] == "angle_random_walk"
    assert number["value"] == pytest.approx(N, abs=3.0 * number["std"])
    assert number["std"] < 0.02


def test_white_noise_that_no_record_states_is_estimated_and_said(tmp_path) -> None:
    runs = [("x", 10.0, 60.0, 100.0), ("x", 0.0, 60.0, 100.0)]
    found = diagnosed(tmp_path, campaign(tmp_path, COARSE, runs, [noisy(N, ["*"])], 0.05))
    assert found["verdict"] == "no_gap"
    (white,) = [one for one in found["assumed"] if one["key"] == "noise.angle_random_walk_deg_sqrt_h"]
    assert white["value"][0] == pytest.approx(N, rel=0.05)
    assert "captures" in white["reason"]
    keys = {one["key"] for one in found["assumed"]}
    assert {"uncertainty.bias_V", "uncertainty.turn_on_bias_deg_h", "uncertainty.axis_rad"} <= keys
    page = (tmp_path / "out-bench" / "index.html").read_text()
    assert "noise.angle_random_walk_deg_sqrt_h" in page
