"""Noise coefficients and stability of the longest stretch: intervals that hold what was drawn, or bounds."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from calibration_bench import BenchRun

from fogreduce.calibrate.derive import derive_from
from fogreduce.characterise.bias import bias_quantities
from fogreduce.characterise.definitions import Definitions
from fogreduce.characterise.noise import noise_quantities
from fogreduce.characterise.quantity import Quantity
from fogreduce.characterise.stretch import longest_stretch
from fogreduce.metadata.calibration import CalibrationRecord

B, K = 0.03, 0.3
HOURS = 4.0


def run_of(rate_deg_s: float, duration_s: float) -> BenchRun:
    return BenchRun("long", "x", [(rate_deg_s, duration_s)])


def quantities(run: BenchRun, record: CalibrationRecord, seed: int) -> list[dict[str, Quantity]]:
    found = derive_from([run.drawn(record, np.random.default_rng(seed))])
    return [{one.name: one for one in noise_quantities(found, gyro)} for gyro in range(4)]


def test_intervals_hold_what_was_drawn_and_what_is_not_seen_is_bounded(bench: Any) -> None:
    """8 campaigns of 4 gyros: of 32 intervals of 95 % 27 or more hold the truth (chance: 199 in 200)."""
    truth = {"quantization": 0.0, "bias_instability": B, "rate_random_walk": K, "rate_ramp": 0.0}
    held = dict.fromkeys(truth, 0)
    seen = 0
    for seed in range(8):
        for one in quantities(
            run_of(0.0, HOURS * 3600), bench.record(rate_random_walk_deg_h_sqrt_h=[K] * 4), seed
        ):
            for name, true in truth.items():
                quantity = one[name]
                assert quantity.low is not None
                assert quantity.high is not None
                held[name] += quantity.low <= true <= quantity.high
                assert (quantity.value == 0) == ("not seen" in quantity.note)
            seen += one["rate_random_walk"].value != 0
    assert min(held.values()) >= 27, held
    assert seen >= 16


def test_white_noise_alone_has_bounds_only(bench: Any) -> None:
    record = bench.record(bias_instability_deg_h=[0.0] * 4)
    for one in quantities(run_of(0.0, 600.0), record, 1):
        for name in ("quantization", "bias_instability", "rate_random_walk", "rate_ramp"):
            assert one[name].low == 0
            assert "bound" in one[name].note


def test_short_stretches_determine_none(bench: Any) -> None:
    for one in quantities(run_of(0.0, 200.0), bench.record(), 1):
        assert one["rate_ramp"].value is None
        assert one["rate_ramp"].needs


@pytest.mark.parametrize(("rate", "fitted"), [(0.0, 0), (1.0, 2), (0.01, 0)])
def test_a_tipped_axis_leaves_no_wave_in_the_noise(bench: Any, rate: float, fitted: int) -> None:
    """3 mrad of 15 deg/h: a wave of 0.03 deg/h where the table turns by half a circle and more."""
    one = run_of(rate, 600.0).drawn(bench.record(), np.random.default_rng(3))
    tipped = replace(one, raw=one.raw + 0.003 * one.facts.scale_factor[:, None] * one.motion[1])
    plain, found = (longest_stretch(derive_from([each]), 0) for each in (one, tipped))
    assert plain is not None
    assert found is not None
    assert found.fitted == fitted
    if fitted:
        np.testing.assert_allclose(np.diff(found.values), np.diff(plain.values), atol=1e-4)
        stabilities = [
            next(
                q
                for q in bias_quantities(derive_from([each]), 0, [], Definitions())
                if q.name == "bias_stability"
            )
            for each in (one, tipped)
        ]
        assert stabilities[1].value == pytest.approx(stabilities[0].value, rel=1e-3)
