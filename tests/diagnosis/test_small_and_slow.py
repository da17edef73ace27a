"""Units of one and two gyros, and logs with a sample every few seconds: what is said, what is left out."""

from __future__ import annotations

import json
from typing import Any

import pytest
from bench_lab import ONE_GYRO, RECORD, diagnosed, simulated, write_record, write_run

from fogreduce.cli.main import main

TWO = {
    **{k: v for k, v in RECORD.items() if k != "H"},
    "axes": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
    "scale_factor_V_per_deg_s": [0.075, 0.08],
    "bias_V": [1e-4, -2e-4],
    "uncertainty": {k: v[:2] for k, v in RECORD["uncertainty"].items()},
    "noise": {k: v[:2] for k, v in RECORD["noise"].items()},
}
TURNS = [("x", [(10.0, 120.0)]), ("x", [(-10.0, 120.0)]), ("y", [(10.0, 120.0)]), ("x", [(0.0, 120.0)])]
DWELLS = [(0.0, 300.0), (3.0, 30.0)] * 4 + [(0.0, 300.0)]
SLOW = [("x", DWELLS), ("y", [(-rate, seconds) for rate, seconds in DWELLS])]


def bench(root, record: dict, runs: list, rate_hz: float, effects: list[dict]):
    """A campaign of runs with any profile, simulated; csv-1 where it is slow."""
    write_record(root, record)
    kind = "csv-1" if rate_hz < 1.0 else "fogcap-1"
    for k, (axis, profile) in enumerate(runs):
        write_run(root, f"r{k}", axis, profile, len(record["bias_V"]), rate_hz, kind)
    return simulated(root, effects, "bench", 3)


def ramp(deg_h_per_h: float) -> dict[str, Any]:
    return {
        "effect": "bias_ramp", "channels": ["gyro1"], "runs": ["*"],
        "parameters": {"deg_h_per_h": deg_h_per_h},
    }  # fmt: skip


@pytest.mark.parametrize(
    ("record", "runs", "rate_hz"),
    [(ONE_GYRO, TURNS, 64.0), (TWO, TURNS, 64.0), (RECORD, SLOW, 0.2), (ONE_GYRO, SLOW[:1], 0.2)],
)
def test_nothing_wrong_is_no_gap_and_a_ramp_is_found(tmp_path, record, runs, rate_hz) -> None:
    nothing = diagnosed(tmp_path / "a", bench(tmp_path / "a", record, runs, rate_hz, []))
    assert nothing["verdict"] == "no_gap"
    found = diagnosed(tmp_path / "b", bench(tmp_path / "b", record, runs, rate_hz, [ramp(200.0)]))
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert ("bias_ramp", ["gyro1"]) in [(m["effect"], m["channels"]) for m in cause["group"]]
    page = (tmp_path / "b" / "out-bench" / "index.html").read_text()
    assert ("has no x, y and z" in page) == (len(record["bias_V"]) < 3)
    assert ("Too few samples for a spectrum" in page) == (rate_hz < 1.0)


def test_a_dwell_of_a_few_samples_is_no_burst_of_spikes(tmp_path) -> None:
    error = {
        "effect": "scale_factor_error", "channels": ["gyro1"], "runs": ["*"], "parameters": {"ppm": 2000.0}
    }  # fmt: skip
    found = diagnosed(tmp_path, bench(tmp_path, TWO, SLOW, 0.2, [error]))
    assert found["verdict"] == "explained"
    assert found["causes"][0]["effect"] == "scale_factor_error"


@pytest.mark.parametrize("seconds", [100.0, 300.0, 1700.0])
def test_the_shortest_of_logs(tmp_path, seconds) -> None:
    found = diagnosed(tmp_path, bench(tmp_path, ONE_GYRO, [("x", [(0.0, seconds)])], 0.01, []))
    assert found["verdict"] == "no_gap"
    arguments = ["--calibrations", str(tmp_path / "cal"), "--detectable", "--out", str(tmp_path / "out")]
    assert main(["diagnose", str(tmp_path / "plan"), *arguments]) == 0
    assert json.loads((tmp_path / "out" / "detectable.json").read_text())["effects"]


def slow_log(root, effects: list[dict]):
    """One standstill of 28 hours, a record every 50 s."""
    write_record(root, RECORD)
    write_run(root, "r0", "z", [(0.0, 2000 / 0.02)], 4, 0.02, "csv-1")
    return simulated(root, effects, "bench", 5)


def test_a_slow_log_with_nothing_wrong_is_no_gap(tmp_path) -> None:
    assert diagnosed(tmp_path, slow_log(tmp_path, []))["verdict"] == "no_gap"


def test_more_white_noise_than_the_record_states_is_that_in_a_slow_log_too(tmp_path) -> None:
    """And no temperature's doing, though nobody logged one."""
    gyros = ["gyro1", "gyro2", "gyro3"]
    louder = {
        "effect": "angle_random_walk", "channels": gyros, "runs": ["*"], "parameters": {"deg_sqrt_h": 4e-3}
    }  # fmt: skip
    found = diagnosed(tmp_path, slow_log(tmp_path, [louder]))
    assert found["verdict"] == "explained"
    assert sorted((c["effect"], c["channels"][0]) for c in found["causes"]) == [
        ("angle_random_walk", gyro) for gyro in gyros
    ]
    for cause in found["causes"]:
        level = cause["parameters"]["deg_sqrt_h"]
        assert abs(level["value"] - 4e-3) < 4.0 * level["std"]  # once in 16000
    assert "A log this slow shows noise levels" in (tmp_path / "out-bench" / "index.html").read_text()
