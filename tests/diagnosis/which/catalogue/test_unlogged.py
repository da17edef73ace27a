"""What a temperature without a log does: told from a random walk, unknown where the catalogue lacks it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from bench_lab import diagnosed, lab, simulated

from fogreduce.diagnosis.observe.blocks import Blocks
from fogreduce.diagnosis.which.catalogue.unlogged import unlogged_covariance
from fogreduce.metadata.yaml12 import load_yaml

TEMPERATURES = ("temperature_bias", "temperature_rate_bias", "temperature_scale_factor")


def put(effect: str, channel: str, **parameters: object) -> dict:
    return {"effect": effect, "channels": [channel], "runs": ["*"], "parameters": parameters}


def unlogged(root: Path, effects: list[dict]) -> Path:
    """A campaign in which temperatures swing, whose logs are lost."""
    lab(root, duration_s=200.0)
    random, time = np.random.default_rng(8), np.arange(202.0)
    for run in sorted((root / "plan" / "runs").iterdir()):
        drift, phase = random.normal(0.0, 0.8), random.uniform(0.0, 2.0 * np.pi)
        sensor = 25.0 + drift * time / 300.0 + 0.4 * np.sin(2.0 * np.pi * time / 330.0 + phase)
        rows = "".join(f"{t:g},{s + 6.0:.4f},{s:.4f}\n" for t, s in zip(time, sensor, strict=True))
        (run / "temperature.csv").write_text("time_s,electronics_degC,sensor_degC\n" + rows)
        with (run / "run.yaml").open("a") as file:
            file.write("temperature: temperature.csv\n")
    campaign = simulated(root, effects)
    for run in sorted((campaign / "runs").iterdir()):
        lines = (run / "run.yaml").read_text().splitlines(keepends=True)
        (run / "run.yaml").write_text("".join(x for x in lines if not x.startswith("temperature:")))
    return campaign


def test_warmth_is_told_from_a_random_walk(tmp_path: Path) -> None:
    campaign = unlogged(tmp_path, [put("temperature_bias", "gyro2", deg_h_per_degC=0.8)])
    found = diagnosed(tmp_path, campaign)
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert cause["effect"] in TEMPERATURES
    assert cause["channels"] == ["gyro2"]
    assert cause["parameters"] == {}
    # what has no numbers cannot be simulated
    assert load_yaml(tmp_path / "out-bench" / "simulator.yaml")["effects"] == []


def test_a_gap_that_no_few_features_hold_is_measured(tmp_path: Path) -> None:
    """A scale factor that goes with the temperature swings in each run for itself."""
    campaign = unlogged(tmp_path, [put("temperature_scale_factor", "gyro2", ppm_per_degC=12.0)])
    found = diagnosed(tmp_path, campaign)
    assert [c["effect"] for c in found["causes"]] == ["temperature_scale_factor"]
    assert found["closure"]["before"] > 100.0
    assert found["verdict"] == "explained"


def test_without_its_name_it_is_unknown(tmp_path: Path) -> None:
    campaign = unlogged(tmp_path, [put("temperature_bias", "gyro2", deg_h_per_degC=0.8)])
    found = diagnosed(tmp_path, campaign, *(x for name in TEMPERATURES for x in ("--without", name)))
    assert found["verdict"] == "unexplained"
    assert found["where"][0]["channels"] == ["gyro2"]


def test_a_random_walk_stays_one(tmp_path: Path) -> None:
    campaign = unlogged(tmp_path, [put("rate_random_walk", "gyro2", deg_h_sqrt_h=3.0)])
    (cause,) = diagnosed(tmp_path, campaign)["causes"]
    assert (cause["effect"], cause["channels"]) == ("rate_random_walk", ["gyro2"])


def test_the_rate_is_the_slope_of_the_warmth() -> None:
    time = np.arange(0.0, 300.0)
    blocks = Blocks(1.0, len(time), time, np.arange(len(time)))
    warmth, warming = (unlogged_covariance(f"{kind} 80.0", blocks) for kind in ("warmth", "warming"))
    for covariance in (warmth, warming):
        assert np.linalg.eigvalsh(covariance)[0] > -1e-9 * np.abs(covariance).max()
    slope = np.gradient(np.gradient(warmth, axis=0), axis=1) * 3600.0
    np.testing.assert_allclose(slope[2:-2, 2:-2], warming[2:-2, 2:-2], rtol=0.01, atol=1e-4)
