"""How far what a temperature drives may be from what its log makes of it."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bench_lab import lab

from fogreduce.datasets.logs import TemperatureLog
from fogreduce.diagnosis.inference.departures import departures
from fogreduce.diagnosis.inference.noise_model import Rows
from fogreduce.diagnosis.observe.capture import RunInput, read_inputs
from fogreduce.effects.selection import action

TIME = np.arange(0.0, 301.0)


def felt(run: int, late_s: float = 0.0) -> TemperatureLog:
    """A room's temperature in a run, as a coil follows it."""
    t = TIME - late_s
    swing = 0.4 * np.sin(2.0 * np.pi * t / 250.0 + run) + 0.3 * np.sin(2.0 * np.pi * t / 700.0 - run)
    return TemperatureLog(TIME, None, 25.0 + 0.002 * t + swing)


def logged(one: RunInput, log: TemperatureLog) -> RunInput:
    return replace(one, scene=replace(one.scene, temperature=log))


@pytest.fixture
def unit(tmp_path: Path) -> list[RunInput]:
    lab(tmp_path, duration_s=300.0, rate_hz=16.0)
    return read_inputs(tmp_path / "plan", tmp_path / "cal", need_capture=False)


@pytest.mark.parametrize("effect", ["temperature_bias", "temperature_rate_bias"])
@pytest.mark.parametrize(("noise_degC", "late_s", "left"), [(0.004, 0.0, 0.7), (0.0, 12.0, 0.15)])
def test_a_log_s_noise_and_a_late_coil_are_departures(
    unit: list[RunInput], effect: str, noise_degC: float, late_s: float, left: float
) -> None:
    parameter = {
        "temperature_bias": "deg_h_per_degC",
        "temperature_rate_bias": "deg_h_per_degC_per_min",
    }[effect]
    rng = np.random.default_rng(6)
    logs = [felt(k) for k in range(len(unit))]
    noisy = [replace(x, sensor_degC=x.sensor_degC + noise_degC * rng.standard_normal(301)) for x in logs]
    inputs = [logged(one, log) for one, log in zip(unit, noisy, strict=True)]
    coil = [logged(one, felt(k, late_s)) for k, one in enumerate(unit)]
    rows = Rows(tuple(one.scene.blocks.count for one in inputs), 4)
    one = action(effect, ["gyro2"], [x.facts.run_id for x in inputs], {parameter: 10.0}, 4)
    columns = departures(inputs, [one], 0, rows)
    true, said = (rows.stacked([x.scene.block_means([one]) for x in part]) for part in (coil, inputs))
    gap = true - said
    # each column's size has one standard deviation, under noise of a hundredth of the effect
    plain = rows.stacked([x.scene.block_means() for x in inputs])
    noise = 0.01 * float(np.std((said - plain)[rows.of(1)]))
    columns, gap = columns / noise, gap / noise
    fit = np.linalg.solve(columns.T @ columns + np.eye(columns.shape[1]), columns.T @ gap)
    assert np.linalg.norm(gap - columns @ fit) < left * np.linalg.norm(gap)
