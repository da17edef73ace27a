"""The next run: what it is to tell apart, what it takes, and what is said where there is nothing to tell."""

from __future__ import annotations

import numpy as np
import pytest
from bench_lab import diagnosed, lab, simulated

from fogreduce.diagnosis.next.design import confusion, separated_rivals, separation_squared
from fogreduce.diagnosis.next.runs import Proposal, as_input, lasting, proposals, temperature
from fogreduce.diagnosis.observe.capture import read_inputs
from fogreduce.metadata.bench import Bench, Chamber, Table

OFFSET = {"effect": "bias_offset", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h": 40.0}}


def test_confusion_is_that_of_chernoff() -> None:
    # two rivals, even odds, d apart: 1/4 exp(-d^2 / 8)
    separation = np.array([[0.0, 4.0], [4.0, 0.0]])
    assert confusion(separation, np.array([0.5, 0.5])) == pytest.approx(0.25 * np.exp(-2.0))


def test_a_rival_of_any_size_is_as_far_as_its_direction() -> None:
    # in one run both rivals change the same (10 sigma); in the next the one changes 10, the other nothing:
    # the best of (1, 1) and (c, 0) leaves 10 / sqrt(2)
    ten, nothing, sizes = np.array([[100.0]]), np.zeros((1, 1)), (np.ones(1), np.ones(1))
    today, new = [[ten, ten], [ten, ten]], [[ten, nothing], [nothing, nothing]]
    assert separation_squared(today, new, sizes) == pytest.approx(50.0)


def test_a_rival_of_free_direction_makes_any_one_run() -> None:
    # the second number shows in the next run alone: it can make there whatever the first rival does
    one, other = np.array([[10.0], [10.0]]), np.array([[10.0, 0.0], [0.0, 7.0]])
    parts = [(one[k : k + 1], other[k : k + 1]) for k in (0, 1)]
    today, new = ([[a.T @ b for b in part] for a in part] for part in parts)
    assert separation_squared(today, new, (np.ones(1), np.array([1.0, 0.5]))) == pytest.approx(0.0, abs=1e-6)


def test_what_is_not_told_apart_is_left() -> None:
    separation = np.array([[0.0, 9.0, 0.4], [9.0, 0.0, 9.0], [0.4, 9.0, 0.0]])
    assert separated_rivals(separation, np.array([0.5, 0.3, 0.2])) == (9.0, [0, 1])
    # five sigma are no separation to promise, but worth a longer run
    less = np.array([[0.0, 9.0, 5.0], [9.0, 0.0, 9.0], [5.0, 9.0, 0.0]])
    assert separated_rivals(less, np.array([0.5, 0.3, 0.2])) == (9.0, [0, 1])
    assert separated_rivals(less, np.array([0.5, 0.3, 0.2]), 3.0) == (5.0, [0, 1, 2])


def test_a_soak_is_weighed_where_temperature_matters_and_warms_the_sensor(tmp_path) -> None:
    lab(tmp_path)
    inputs = read_inputs(simulated(tmp_path, []), tmp_path / "cal")
    assert not any(p.soak_degC for p in proposals(inputs, soaks=False))
    soak = next(p for p in proposals(inputs, soaks=True) if p.soak_degC)
    log = temperature(inputs, soak)
    assert log is not None
    # 2 degC/min for the first of two minutes
    assert log.sensor_degC[-1] - log.sensor_degC[0] == pytest.approx(2.0)
    assert as_input(inputs, soak).scene.temperature is not None
    # without logs today, no steady one is asked for
    assert temperature(inputs, Proposal("x", "up", 0.0, 60.0)) is None


def test_the_next_run_stays_within_the_bench(tmp_path) -> None:
    lab(tmp_path)
    inputs = read_inputs(simulated(tmp_path, []), tmp_path / "cal")
    slow = Bench(table=Table(largest_rate_deg_s=4.0), chamber=None)
    runs = list(proposals(inputs, soaks=True, bench=slow))
    assert max(abs(p.rate_deg_s) for p in runs) == 4.0
    assert not any(p.soak_degC for p in runs)
    # 0.5 deg/s^2 for a twentieth of 120 s
    lazy = Bench(table=Table(largest_acceleration_deg_s2=0.5), chamber=Chamber(highest_degC=25.0))
    runs = list(proposals(inputs, soaks=True, bench=lazy))
    assert max(abs(p.rate_deg_s) for p in runs) == pytest.approx(3.0)
    longer = lasting(next(p for p in runs if p.soak_degC and p.rate_deg_s), 1200.0, inputs, lazy)
    # ten minutes would warm by 20 degC; the chamber ends 3 above the room's 22
    assert longer.soak_degC == pytest.approx(3.0)


def test_one_run_leaves_rivals_and_the_next_is_verified_to_separate_them(tmp_path) -> None:
    lab(tmp_path)
    bench = simulated(tmp_path, [OFFSET])
    found = diagnosed(tmp_path, bench, "--only-runs", "r0", "--verify-next")
    (cause,) = found["causes"]
    group = {(m["effect"], *m["channels"]) for m in cause["group"]}
    # one run at a constant rate cannot tell an offset from a scale factor
    assert {("bias_offset", "gyro2"), ("scale_factor_error", "gyro2")} <= group
    best = found["next_run"]
    assert best["expected_sigma"] > 3.0
    assert "bias_offset gyro2" in best["separates"]
    assert not set(best["separates"]) & set(best.get("leaves", []))
    truths = best["verified"]["truths"]
    assert [t["truth"] for t in truths] == best["separates"][:4]
    assert all(t["separated"] for t in truths)


def test_no_rivals_no_next_run(tmp_path) -> None:
    lab(tmp_path)
    dropouts = {"effect": "dropouts", "channels": ["gyro1"], "runs": ["*"], "parameters": {"fraction": 0.01}}
    found = diagnosed(tmp_path, simulated(tmp_path, [dropouts]), "--verify-next")
    assert all(len(cause["group"]) == 1 for cause in found["causes"])
    assert found["next_run"] is None
