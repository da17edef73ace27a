"""The encoder against the command: rate, lag and ripple that were put in are found."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.estimate.encoder import compare_with_command
from fogreduce.physics.table_motion import Profile

PROFILE = Profile(np.array([10.0, 0.0, -5.0]), np.array([100.0, 50.0, 200.0]))
TIMES = np.arange(0.0, 351.0, 0.5)


def commanded(time_s: np.ndarray) -> np.ndarray:
    return np.degrees(PROFILE.angle_at(time_s))


def test_a_perfect_table() -> None:
    segments = compare_with_command(TIMES, 77.0 + commanded(TIMES), PROFILE, 0.5)
    assert [item.number for item in segments] == [1, 2, 3]
    for item, rate in zip(segments, (10.0, 0.0, -5.0), strict=True):
        assert item.commanded_deg_s == rate
        assert item.rate_deg_s == pytest.approx(rate, abs=1e-12)
        assert item.scatter_deg < 1e-10
        assert (item.lag_s == pytest.approx(0.0, abs=1e-10)) if rate else np.isnan(item.lag_s)


def test_a_late_table() -> None:
    """An encoder that is read 40 ms late shows the table 40 ms behind, whatever the sense."""
    delayed = commanded(np.maximum(TIMES - 0.04, 0.0))
    first, _, third = compare_with_command(TIMES, delayed, PROFILE, 0.5)
    assert first.lag_s == pytest.approx(0.04, abs=1e-9)
    assert third.lag_s == pytest.approx(0.04, abs=1e-9)


def test_a_table_that_is_off_its_rate() -> None:
    first, second, third = compare_with_command(TIMES, commanded(TIMES) * (1 + 50e-6), PROFILE, 0.5)
    assert first.rate_deg_s == pytest.approx(10.0 * (1 + 50e-6), rel=1e-12)
    assert second.rate_deg_s == pytest.approx(0.0, abs=1e-12)
    assert third.rate_deg_s == pytest.approx(-5.0 * (1 + 50e-6), rel=1e-12)


@pytest.mark.parametrize("harmonic", [1, 4, 8])
def test_a_ripple_of_the_angle(harmonic: int) -> None:
    """0.01 degrees at a harmonic of the angle: two and a half turns, so the line takes a little of it."""
    alpha = PROFILE.angle_at(TIMES)
    segments = compare_with_command(TIMES, commanded(TIMES) + 0.01 * np.cos(harmonic * alpha), PROFILE, 0.5)
    assert segments[0].ripple_harmonic == harmonic
    assert segments[0].ripple_deg == pytest.approx(0.01, rel=0.1)
    assert np.isnan(segments[1].ripple_deg)


def test_stated_errors_are_the_scatter_of_repeats() -> None:
    """500 noisy logs; scatter known to 3.2 %, four of that."""
    generator = np.random.default_rng(1)
    rows = []
    for _ in range(500):
        noisy = commanded(TIMES) + generator.normal(0, 1e-3, TIMES.size)
        noisy[0] = 0.0  # lag is relative to the angle at t = 0
        rows.append(compare_with_command(TIMES, noisy, PROFILE, 0.5)[0])
    for value, error in (("rate_deg_s", "rate_err_deg_s"), ("lag_s", "lag_err_s")):
        scatter = np.std([getattr(row, value) for row in rows])
        assert scatter == pytest.approx(np.mean([getattr(row, error) for row in rows]), rel=0.13)


def test_a_segment_with_few_rows_is_left_out() -> None:
    times = np.array([0.0, 50.0, 100.0, 150.0, *np.arange(151.0, 350.0)])
    assert [item.number for item in compare_with_command(times, commanded(times), PROFILE, 0.5)] == [3]
