"""The control chart's centre and limits."""

import math

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from fogreduce.pages.control import FEWEST_RUNS, control


def test_without_errors_it_is_shewharts_chart_by_the_median_range() -> None:
    """Moving ranges all 1: their median over 0.954 is the standard deviation (ISO 7870-2's d4 for pairs)."""
    found = control([0.0, 1.0] * 6, [0.0] * 12)
    assert found.centre == 0.5
    assert found.extra == pytest.approx(1 / 0.954, rel=1e-3)
    assert found.limits[0] == pytest.approx((0.5 - 3 / 0.954, 0.5 + 3 / 0.954), rel=2e-3)
    assert found.out == ()


def test_noise_alone_has_no_scatter_beyond_and_few_runs_outside() -> None:
    rng = np.random.default_rng(1)
    errors = rng.uniform(0.5, 2.0, 4000)
    found = control(errors * rng.standard_normal(4000), errors)
    # The median range of 4000 has a relative error of 2 %, so t^2 / s^2 is below some 8 %.
    assert found.extra < 0.3
    assert len(found.out) < 4000 * 0.0027 * 2.5  # 10.8 expected, 3.3 their standard deviation
    assert not found.moved


def test_scatter_from_run_to_run_is_found_beside_errors_of_every_size() -> None:
    rng = np.random.default_rng(2)
    errors = rng.uniform(0.1, 2.0, 4000)
    values = 5.0 + np.hypot(errors, 0.7) * rng.standard_normal(4000)
    found = control(values, errors)
    assert found.extra == pytest.approx(0.7, rel=0.1)
    assert found.centre == pytest.approx(5.0, abs=0.1)
    wide, narrow = found.limits[int(np.argmax(errors))], found.limits[int(np.argmin(errors))]
    assert wide[1] - wide[0] > 2 * (narrow[1] - narrow[0])


def test_one_strange_run_is_outside_and_does_not_widen_the_limits() -> None:
    rng = np.random.default_rng(3)
    values = rng.uniform(-1.0, 1.0, 40).tolist()
    before = control(values, [0.3] * 40)
    values[20] = 1000.0
    after = control(values, [0.3] * 40)
    assert after.out == (20,)
    assert after.extra < 1.3 * before.extra


def test_a_level_that_moved_is_said() -> None:
    values = np.random.default_rng(4).standard_normal(60) + np.repeat([0.0, 3.0], 30)
    assert control(values, [0.1] * 60).moved


def test_few_runs_have_a_centre_only() -> None:
    found = control([1.0, 2.0, 4.0], [0.1] * 3)
    assert (found.centre, found.limits, found.extra, found.out) == (2.0, None, None, ())
    assert control([3.0], [0.0]).centre == 3.0


def test_runs_that_are_all_equal_lie_within() -> None:
    found = control([2.5] * FEWEST_RUNS, [0.0] * FEWEST_RUNS)
    assert (found.extra, found.out, found.longest) == (0.0, (), 0)


numbers = st.floats(-1e3, 1e3).map(lambda value: round(value, 3))


@settings(deadline=None)  # the machine may be busy
@example(runs=[(0.0, 0.0), (1.0, 1e-160)] * 5)
@given(st.lists(st.tuples(numbers, st.floats(0.0, 10.0)), min_size=FEWEST_RUNS, max_size=30))
def test_whatever_the_runs_limits_are_finite_about_the_centre(runs) -> None:
    values, errors = zip(*runs, strict=True)
    found = control(values, errors)
    assert found.limits is not None
    for (low, high), error in zip(found.limits, errors, strict=True):
        assert math.isfinite(low)
        assert low <= found.centre <= high
        assert high - low >= 6 * error * (1 - 1e-9) - 1e-9
