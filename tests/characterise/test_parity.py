"""Failures put into simulated runs, found by the parity checks; a good campaign gives no alarm."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.calibrate.noise import gyro_noise
from fogreduce.calibrate.readings import read_campaign
from fogreduce.characterise.parity import check_run
from fogreduce.estimate.uncertainty import StatedErrors


def alarms(bench, effects, runs=("1-xp",), **options):
    readings = read_campaign(bench.simulate(effects, runs, **options), bench.calibrations)
    noise = [gyro_noise(readings, i) for i in range(4)]
    stated = [StatedErrors.of(one.run, one.record) for one in readings]
    return [check_run(one, noise, errors) for one, errors in zip(readings, stated, strict=True)]


def entry(effect, gyro, **parameters):
    return {"effect": effect, "channels": [f"gyro{gyro}"], "runs": ["1-xp"], "parameters": parameters}


def test_good_runs_give_no_alarm(bench) -> None:
    for seed in range(3):
        options = ["--draw-uncertainties", "--seed", str(seed)]
        found = alarms(bench, [], ("1-xp", "3-yp", "7-st"), options=options)
        assert [one for run in found for one in run] == []


def test_earths_wave_in_a_turn_is_no_noise(bench) -> None:
    """30 deg/s: Earth's rate changes by 5 deg/h within a bin; white noise of a sample is 0.48 deg/h."""
    found = read_campaign(bench.simulate([], ("y-steps",)), bench.calibrations)
    (one,) = found
    scatter = 3600 * one.scatter / np.abs(one.facts.scale_factor)[:, None]
    np.testing.assert_allclose(np.sqrt(np.mean(scatter**2, axis=1)), 60 * 0.002 * 4, rtol=0.1)
    assert alarms(bench, [], ("x-steps", "y-steps", "z-steps")) == [[], [], []]


@pytest.mark.parametrize("gyro", [1, 2, 4])
def test_a_step_is_found_in_time_and_the_known_motion_says_which_gyro(bench, gyro) -> None:
    (found,) = alarms(bench, [entry("bias_step", gyro, deg_h=3.0, time_s=40.0)])
    step = next(one for one in found if one.check == "step")
    assert step.since_s == pytest.approx(40.0, abs=3.0)
    assert step.alarm_s - 40.0 < 15.0
    assert step.gyro == gyro - 1
    assert step.isolated_by == "known motion"


def test_a_wrong_scale_factor_shows_from_the_start(bench) -> None:
    (found,) = alarms(bench, [entry("scale_factor_error", 3, ppm=30000.0)])
    level = next(one for one in found if one.check == "level")
    assert level.gyro == 2


def test_noise_that_is_another_gyros_own_is_told_by_its_scatter(bench, tmp_path) -> None:
    """A burst and a stuck output, put into a good run's scatter by hand."""
    from dataclasses import replace

    (one,) = read_campaign(bench.simulate([], ("1-xp",)), bench.calibrations)
    noise = [gyro_noise([one], i) for i in range(4)]
    scatter = one.scatter.copy()
    scatter[1, 30:36] *= 2.0
    scatter[2, 50:] *= 0.1
    found = check_run(replace(one, scatter=scatter), noise, StatedErrors.of(one.run, one.record))
    assert [(alarm.gyro, "burst" in alarm.what) for alarm in found] == [(1, True), (2, False)]
    assert [alarm.since_s for alarm in found] == pytest.approx([one.time_s[30], one.time_s[50]], abs=1.1)
