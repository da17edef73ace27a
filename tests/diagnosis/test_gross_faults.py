"""A gross fault is one cause: what is left of it at the full rate is no line, and no moving base."""

from __future__ import annotations

from pathlib import Path

import pytest
from bench_lab import RECORD, diagnosed, lab, simulated


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
    # fast enough that Earth's rate, seen turning, is no straight line over a second
    lab(tmp_path, rates=(25.0, -25.0, 25.0, -25.0, 0.5, 0.0))
    found = diagnosed(tmp_path, simulated(tmp_path, [fault]))
    assert found["verdict"] == "explained"
    assert [(c["effect"], c["channels"]) for c in found["causes"]] == [(fault["effect"], fault["channels"])]


@pytest.mark.parametrize("late_s", [1.19, -0.6])
def test_a_late_start_is_found_in_whatever_second_it_falls(tmp_path: Path, late_s: float) -> None:
    lab(tmp_path)
    found = diagnosed(tmp_path, simulated(tmp_path, [put("start_offset", "table", s=late_s)]))
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert cause["effect"] == "start_offset"
    assert cause["probability"] > 0.9
    stated = cause["parameters"]["s"]
    assert abs(stated["value"] - late_s) < min(3.0 * stated["std"], 1.0 / 64.0)
    assert found["closure"]["fraction"] > 0.99


def test_a_start_a_few_samples_late_is_no_burst_of_spurious_counts(tmp_path: Path) -> None:
    lab(tmp_path)
    late = simulated(tmp_path, [put("start_offset", "table", s=0.0224)])
    found = diagnosed(tmp_path, late, "--only-runs", "r0")
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert "start_offset" in [rival["effect"] for rival in cause["group"]]


def test_a_gyro_that_rests_in_every_run_shares_no_noise(tmp_path: Path) -> None:
    lab(tmp_path, rates=(10.0, 10.0, 10.0, 10.0, 10.0, 10.0))
    found = diagnosed(tmp_path, simulated(tmp_path, [put("saturation", "gyro3", volts=0.1)]))
    assert [c["effect"] for c in found["causes"]] == ["saturation"]


def test_steps_as_wide_as_the_noise_are_lost_bits_alone(tmp_path: Path) -> None:
    lab(tmp_path)
    found = diagnosed(tmp_path, simulated(tmp_path, [put("lost_bits", "gyro2", bits=8)]))
    assert found["verdict"] == "explained"
    assert [(c["effect"], c["channels"]) for c in found["causes"]] == [("lost_bits", ["gyro2"])]


def test_an_exchange_that_no_name_stands_for_is_seen_where_it_is(tmp_path: Path) -> None:
    record = {**RECORD, "scale_factor_V_per_deg_s": [0.075, -0.09, 0.05, 0.075]}
    lab(tmp_path, record)
    exchange = simulated(tmp_path, [put("channel_swap", "gyro2", **{"with": "gyro3"})])
    found = diagnosed(tmp_path, exchange, "--without", "channel_swap")
    assert found["verdict"] in ("unexplained", "partly_explained")
    assert found["where"][0]["channels"] == ["gyro2", "gyro3"]


def test_what_the_unknown_explains_far_better_is_not_explained(tmp_path: Path) -> None:
    lab(tmp_path)
    clipped = simulated(tmp_path, [put("saturation", "gyro4", volts=0.36)])
    found = diagnosed(tmp_path, clipped, "--without", "saturation")
    assert found["verdict"] in ("unexplained", "partly_explained")
    assert found["unknown_probability"] > 0.9


def test_a_delay_that_only_jumps_show_is_known_to_a_sample(tmp_path: Path) -> None:
    lab(tmp_path)
    for k, run in enumerate(sorted((tmp_path / "plan" / "runs").glob("*/run.yaml"))):
        text = run.read_text()
        start, end = text.index("profile:"), text.index("orientation:")
        steps = "".join(
            f"\n  - {{rate_deg_s: {rate}, duration_s: 30.0}}" for rate in (0.0, 9.0 + k, 3.0, 0.0)
        )
        run.write_text(text[:start] + "profile:" + steps + "\n" + text[end:])
    delay = simulated(tmp_path, [put("latency", "gyro1", ms=2.0)])
    found = diagnosed(tmp_path, delay, "--only-runs", "r0")
    assert [(c["effect"], c["channels"]) for c in found["causes"]] == [("latency", ["gyro1"])]
    stated = found["causes"][0]["parameters"]["ms"]
    assert abs(stated["value"] - 2.0) < 2.0 * stated["std"] < 2.0 * 1000.0 / 64.0


@pytest.mark.parametrize("share", [0.2, pytest.param(0.45, marks=pytest.mark.slow)])
def test_many_spurious_counts_are_spikes(tmp_path: Path, share: float) -> None:
    lab(tmp_path, duration_s=40.0)
    found = diagnosed(tmp_path, simulated(tmp_path, [put("spikes", "gyro2", fraction=share)]))
    assert found["verdict"] == "explained"
    assert [(c["effect"], c["channels"]) for c in found["causes"]] == [("spikes", ["gyro2"])]
    stated = found["causes"][0]["parameters"]["fraction"]
    assert abs(stated["value"] - share) < 3.0 * stated["std"] < 0.1


@pytest.mark.parametrize("kind", ["threshold", "subtractive"])
def test_a_dead_zone_wider_than_a_slow_run_turns(tmp_path: Path, kind: str) -> None:
    lab(tmp_path, rates=(10.0, -10.0, 0.4, -0.7, 0.5, 0.0))
    wide = put("dead_zone", "gyro2", deg_h=900.0, kind=kind)
    found = diagnosed(tmp_path, simulated(tmp_path, [wide]))
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert (cause["effect"], cause["channels"]) == ("dead_zone", ["gyro2"])
    assert cause["parameters"]["kind"]["value"] == kind
    assert cause["probability"] > 0.99
    size = cause["parameters"]["deg_h"]
    # between the rates of two runs every threshold does the same
    assert abs(size["value"] - 900.0) < 3.0 * size["std"] < 900.0


@pytest.mark.parametrize("off_deg", [90.0, pytest.param(-150.0, marks=pytest.mark.slow)])
def test_a_heading_however_far_off_is_one_cause(tmp_path: Path, off_deg: float) -> None:
    lab(tmp_path)
    found = diagnosed(tmp_path, simulated(tmp_path, [put("heading_error", "table", deg=off_deg)]))
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert (cause["effect"], cause["probability"] > 0.99) == ("heading_error", True)
    size = cause["parameters"]["deg"]
    assert abs(size["value"] - off_deg) < 3.0 * size["std"] < 3.0
