"""Which gyro failed: faults put into drawn runs, and how often the right gyro is isolated, by what."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from calibration_bench import BenchRun

from fogreduce.calibrate.noise import GyroNoise
from fogreduce.calibrate.readings import Readings
from fogreduce.characterise.isolation import (
    DYNAMICS,
    KNOWN_MOTION,
    OWN_NOISE,
    OWN_OUTPUT,
    by_all_runs,
    by_dynamics,
    by_own_noise,
    isolated,
)
from fogreduce.characterise.parity import Alarm, check_campaign
from fogreduce.constants import SECONDS_PER_HOUR

#: Bin from which on a gyro fails: within the first turn.
FAILS = 50
RATES = (10.0, -10.0, 0.0)


def drawn(
    bench: Any, axes: str, generator: np.random.Generator, rates: tuple[float, ...] = RATES
) -> list[Readings]:
    """Runs about the axes, drawn from the record, the scatter within each bin too."""
    plans = [BenchRun(f"about-{axis}", axis, [(rate, 72.0) for rate in rates]) for axis in axes]
    runs = [plan.drawn(bench.record(), generator) for plan in plans]
    return [
        replace(one, scatter=one.scatter * np.sqrt(generator.chisquare(one.count - 1) / (one.count - 1)))
        for one in runs
    ]


def failed(
    one: Readings, fault: str, gyro: int, generator: np.random.Generator, fails: int = FAILS
) -> Readings:
    """The run with a gyro that fails from a bin on."""
    raw, count, scatter = one.raw.copy(), one.count.copy(), one.scatter.copy()
    scale, after = one.facts.scale_factor[gyro], slice(fails, None)
    rate = one.facts.axes[gyro] @ one.motion
    if fault == "step":  # of 3 deg/h
        raw[gyro, after] += scale * 3.0 / SECONDS_PER_HOUR
    elif fault == "stuck":  # readings that stay the same are left out of the bins
        raw[gyro, after], count[gyro, after] = np.nan, 0.0
    elif fault == "noise burst":  # twice the noise, for 8 s
        burst = slice(fails, fails + 8)
        extra = np.sqrt(3 / one.count[gyro, burst]) * scatter[gyro, burst]
        raw[gyro, burst] += extra * generator.standard_normal(8)
        scatter[gyro, burst] *= 2.0
    elif fault == "scale change":  # of 300 ppm: 11 deg/h at 10 deg/s
        raw[gyro, after] += scale * 3e-4 * rate[after]
    else:  # a scale factor that is wrong by 1 % from the start
        raw[gyro] += scale * 1e-2 * rate
    return replace(one, raw=raw, count=count, scatter=scatter)


def alarms_of(runs: list[Readings]) -> list[Alarm]:
    return check_campaign(runs, [GyroNoise(0.002, 0.03, 0.0, stated=True)] * 4)


@pytest.mark.parametrize("fault", ["step", "stuck", "noise burst", "scale change", "wrong scale"])
def test_the_right_gyro_is_isolated(bench: Any, fault: str) -> None:
    """12 faults of each kind, three a gyro, runs about x, y, z; the table's motion is not used in `alone`."""
    right, alone, wrong, seen, by = 0, 0, 0, 0, Counter[str]()
    for seed in range(12):
        generator = np.random.default_rng([3, seed])
        gyro = seed % 4
        runs = drawn(bench, "xyz", generator)
        which = range(3) if fault == "wrong scale" else range(1) if gyro != 1 else range(1, 2)
        for k in which:  # gyro 2 has no part in a turn about x
            runs[k] = failed(runs[k], fault, gyro, generator)
        alarms = alarms_of(runs)
        seen += bool(alarms)
        found = {alarm.gyro for alarm in alarms} - {None}
        right += found == {gyro}
        wrong += bool(found - {gyro})
        without = [[e for e in alarm.evidence if e.by != KNOWN_MOTION] for alarm in alarms]
        alone += {isolated(each)[0] for each in without} - {None} == {gyro}
        by.update(each for alarm in alarms for each in alarm.isolated_by.split(", ") if each)
    print(f"{fault}: seen {seen}, right {right}, wrong {wrong}, without known motion {alone}; {dict(by)}")
    assert seen == 12
    assert wrong <= 1
    assert right >= 11
    assert {
        "step": by[KNOWN_MOTION] >= 11,
        "stuck": by[OWN_OUTPUT] >= 12 and alone >= 11,
        "noise burst": by[OWN_NOISE] >= 11 and alone >= 11,
        "scale change": by[KNOWN_MOTION] >= 11,
        "wrong scale": by[DYNAMICS] >= 11 and alone >= 11,
    }[fault]


def test_a_scale_change_is_told_from_a_bias_by_the_rates_after_it(bench: Any) -> None:
    """Two rates before it, which fix what was there already, and two after it."""
    for fault, says in (("scale change", "a scale factor"), ("step", "a bias")):
        generator = np.random.default_rng(5)
        (one,) = drawn(bench, "x", generator, (10.0, -10.0, 10.0, -10.0))
        step = next(a for a in alarms_of([failed(one, fault, 0, generator, 180)]) if a.check == "step")
        assert next(e for e in step.evidence if e.by == DYNAMICS).says.endswith(says)


def test_one_rate_does_not_tell_a_scale_factor_from_a_bias() -> None:
    since = np.arange(20) >= 10
    found = by_dynamics(since * 5.0, np.ones(20), np.full(20, 10.0), since, np.full(4, 0.5))
    assert "look alike" in found.says
    assert found.odds.tolist() == [0.25] * 4


def test_turns_about_one_axis_leave_the_gyro_open_and_two_causes_fit_none() -> None:
    axes, row = np.eye(4)[:, :3] + 0.1, np.full(4, 0.5)
    motion = np.outer([10.0, -10.0, 0.0], [1.0, 1.0, 1.0])
    one = by_all_runs(0.5 * 1.8 * motion @ axes[0], np.full(3, 0.1), motion, axes, row)
    assert one.odds.max() < 0.5
    both = by_all_runs(np.array([5.0, 5.0, 9.0]), np.full(3, 0.1), motion, axes, row)
    assert both.odds.max() == 0
    assert "no one" in both.says


def test_own_noise_needs_bins_on_both_sides_and_a_change() -> None:
    generator = np.random.default_rng(1)
    count = np.full((4, 60), 16.0)
    scatter = np.sqrt(generator.chisquare(15, (4, 60)) / 15)
    parts = slice(0, 30), slice(30, 60)
    assert by_own_noise(scatter, count, slice(0, 0), parts[1]) is None
    even = by_own_noise(scatter, count, *parts)
    assert even is not None
    assert even.odds.max() < 0.5
    scatter[2, 30:] *= 1.3
    changed = by_own_noise(scatter, count, *parts)
    assert changed is not None
    assert isolated([changed]) == (2, OWN_NOISE)
