"""Acceleration and magnetic sensitivity out of attitudes, a field that run.yaml states among them."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from calibration_bench import BenchRun

from fogreduce.calibrate.derive import Derivation, derive_from
from fogreduce.calibrate.equations import field, vertical
from fogreduce.calibrate.readings import Readings
from fogreduce.characterise.orientation import orientation_quantities
from fogreduce.characterise.quantities import report_shapes
from fogreduce.characterise.quantity import Quantity
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.effects.at import At, Place
from fogreduce.effects.gyro_bias import magnetic_bias
from fogreduce.effects.motion import Motion
from fogreduce.errors import BadInput

FIELD = [1.5, 20.0, -43.0]  # uT, east, north, up: some place at 48 deg north
PER_MT = (40.0, -25.0, 10.0, 60.0)
PER_G = 0.5


def campaign(stated: list[float] | None) -> list[BenchRun]:
    """Turns both ways about x, y, z, and standstills with each up and down, twice."""
    site = {} if stated is None else {"magnetic_field_uT": stated}
    turn = [(rate, 72.0) for rate in (10.0, -10.0, 0.0)]
    runs = [BenchRun(f"{axis}-turn", axis, turn, site=site) for axis in "xyz"]
    return runs + [
        BenchRun(f"{up}-still-{k}".strip("-"), up, [(0.0, 72.0)], site=site)
        for axis in "xyz"
        for up in (axis, f"-{axis}")
        for k in (1, 2)
    ]


def derived(bench: Any, runs: list[BenchRun], seed: int, true_field: list[float]) -> Derivation:
    generator = np.random.default_rng(seed)
    return derive_from([disturbed(run.drawn(bench.record(), generator), true_field) for run in runs])


def disturbed(one: Readings, true_field: list[float]) -> Readings:
    """With acceleration along x of the unit, and the field by the simulator's effect, in the readings."""
    facts, raw = one.facts, one.raw.copy()
    at_field = np.array(true_field) / 1e3
    motion = Motion.nominal(facts)
    for gyro, per_mt in enumerate(PER_MT):
        off = PER_G * vertical(one)[0] / SECONDS_PER_HOUR
        parameters = {"deg_h": per_mt * np.linalg.norm(at_field), "field_direction": at_field.tolist()}
        place = Place(facts.run_id, gyro, (gyro,), 4, lambda word: np.random.default_rng(0))
        angle = motion.angle_at(one.time_s)
        at = At(place, one.time_s, one.bin_s, motion, facts.axes[gyro], None, raw, angle)
        raw[gyro] += facts.scale_factor[gyro] * magnetic_bias(off, parameters, at)
    return replace(one, raw=raw)


def stated_of(found: Derivation, name: str) -> list[Quantity]:
    shapes = report_shapes(found)
    each = [one for gyro in range(4) for one in orientation_quantities(found, gyro, shapes)]
    return [one for one in each if one.name == name]


def test_the_field_of_the_report_is_that_of_the_simulator(bench: Any) -> None:
    found = derived(bench, campaign(FIELD)[:1], 1, FIELD)
    (one,) = found.readings
    seen = Motion.nominal(one.facts).seen(np.array(FIELD) / 1e3, one.facts.profile.angle_at(one.time_s))
    np.testing.assert_allclose(field(one), seen, rtol=1e-12, atol=1e-15)


def test_magnetic_and_acceleration_sensitivity_are_told_apart(bench: Any) -> None:
    """4 campaigns of 4 gyros: of 16 intervals 13 hold the truth at least, of acceleration 41 of 48."""
    held = told = 0
    for seed in range(4):
        found = derived(bench, campaign(FIELD), seed, FIELD)
        for one, true in zip(stated_of(found, "magnetic_sensitivity"), PER_MT, strict=True):
            assert one.value is not None
            assert one.std is not None
            assert one.std < 10.0  # deg/h/mT: 0.5 deg/h in Earth's field
            held += one.low <= true <= one.high
        for k, one in enumerate(stated_of(found, "acceleration_sensitivity")):
            told += one.low <= (PER_G if k % 3 == 0 else 0.0) <= one.high
    assert held >= 13
    assert told >= 41


@pytest.mark.parametrize("left", [0, 1])
def test_a_run_that_states_no_field_leaves_it_open(bench: Any, left: int) -> None:
    runs = campaign(FIELD)[:3] if left else campaign(None)[:3]
    runs += campaign(None)[3:] if left else []
    for one in stated_of(derived(bench, runs, 1, FIELD), "magnetic_sensitivity"):
        assert one.value is None
        assert "magnetic_field_uT" in one.needs


def test_a_field_that_is_none_is_refused(bench: Any) -> None:
    run = BenchRun("a", "x", [(0.0, 72.0)], site={"magnetic_field_uT": [1.0, 2.0]})
    with pytest.raises(BadInput, match="magnetic_field_uT"):
        run.drawn(bench.record(), np.random.default_rng(1))
