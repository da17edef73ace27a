"""Priors of sizes: realistic ranges of every effect, and what they favour."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.evidence import Fit
from fogreduce.diagnosis.inference.sizes import believed, size_scales, width_believed
from fogreduce.effects.table import EFFECTS


@pytest.mark.parametrize(
    "effect", [e for e in EFFECTS.values() if any(p.off is not None for p in e.parameters)]
)
def test_every_effect_with_a_size_states_its_realistic_range(effect) -> None:
    first = effect.parameters[0]
    assert first.realistic is not None
    assert 0.0 < first.realistic[0] < first.realistic[1]


def test_weights_are_a_probability_and_most_lies_within_the_range() -> None:
    scales, logs = size_scales((0.1, 20.0))
    weights = np.exp(logs)
    assert weights.sum() == pytest.approx(1.0)
    assert weights[(scales >= 0.1) & (scales <= 20.0)].sum() > 0.6


def test_a_size_a_hundred_times_too_large_is_paid_for() -> None:
    """A size drawn from the mixture's density: at 100 times the range's end far less likely than within."""
    scales, logs = size_scales((0.1, 20.0))

    def density_in_log(x: float) -> float:
        return x * float(np.sum(np.exp(logs) * np.exp(-0.5 * (x / scales) ** 2) / scales))

    assert density_in_log(2000.0) < 0.02 * density_in_log(2.0)


@pytest.mark.parametrize(("deg_h", "is_it"), [(400.0, True), (-400.0, True), (3000.0, False)])
def test_a_bias_of_more_than_a_hundred_times_the_range_is_not_believed(deg_h: float, is_it: bool) -> None:
    one = Candidate(
        "bias_offset",
        ("gyro1",),
        ("*",),
        slice(0, 1),
        np.ones((1, 1, 1)),
        ({},),
        ("deg_h",),
        np.full((1, 1), 0.5),
    )
    assert believed(Fit(one, 0.0, 0, 0.0, np.array([deg_h / 0.5]), np.eye(1))) is is_it


@pytest.mark.parametrize(("deg_h", "is_it"), [(1900.0, True), (2100.0, False)])
def test_no_dead_zone_a_hundred_times_as_wide_as_units_show_is_believed(deg_h: float, is_it: bool) -> None:
    columns, grid = np.zeros((2, 1, 1)), ({"deg_h": deg_h, "kind": "threshold"},)
    wide = Candidate("dead_zone", ("gyro1",), ("*",), slice(0, 2), columns, grid, (), np.ones((1, 1)), True)
    assert width_believed(wide, 0) is is_it
