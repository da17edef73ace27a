"""A curve against the commanded rate: by hand, and its chances against draws."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fogreduce.estimate.rate_difference import RateDifference, over_segments, rate_difference

WHOLE_TURN = 2 * math.pi / 100.0


def of(theta: list[float], noise: np.ndarray, stated: np.ndarray, **changes) -> RateDifference:
    told = {"rate_rad_s": WHOLE_TURN, "has_sine": True, "span_s": (0.0, 100.0), "commanded": 3.6} | changes
    return rate_difference(np.array(theta), noise, stated, **told)


def test_a_whole_turn_by_hand() -> None:
    """Over a whole turn the sine has no mean and e adds e T / 2: 3.6 + 0.01 + 1e-4 * 50 deg/s."""
    noise, stated = np.diag([9e-6, 1e-8, 1e-8, 0.0]), np.diag([16e-6, 0.0, 0.0, 0.0])
    found = of([3.61, 3e-4, 4e-4, 1e-4], noise, stated)
    assert found.measured == pytest.approx(3.615, rel=1e-12)
    assert found.difference == pytest.approx(0.015, rel=1e-9)
    assert (found.noise, found.stated, found.error) == pytest.approx((3e-3, 4e-3, 5e-3))
    assert found.sigma == pytest.approx(3.0, rel=1e-9)
    assert (found.sine, found.sine_err, found.sine_sigma) == pytest.approx((5e-4, 1e-4, 5.0))


def test_half_a_turn_keeps_the_mean_of_its_sine() -> None:
    """The mean of q sin over half a turn is 2 q / pi."""
    found = of([0.0, 0.0, 1.0, 0.0], np.eye(4), np.eye(4), span_s=(0.0, 50.0), commanded=0.0)
    assert found.measured == pytest.approx(2 / math.pi, rel=1e-12)


def test_a_standstill_has_no_sine() -> None:
    found = of([1e-3, 0.0, 0.0, 0.0], 1e-8 * np.eye(4), 0 * np.eye(4), rate_rad_s=0.0, has_sine=False)
    assert math.isnan(found.sine)
    assert len(found.chances) == 1


def test_no_error_at_all() -> None:
    """What is exact and right is 0 sigma off; what is exact and wrong endlessly many."""
    nothing = np.zeros((4, 4))
    right, wrong = (of([a, 0.0, 0.0, 0.0], nothing, nothing) for a in (3.6, 3.7))
    assert right.sigma == pytest.approx(0.0)
    assert wrong.sigma == math.inf
    assert min(wrong.chances) == 0.0


def test_chances_are_those_of_draws() -> None:
    """Of 20 000 draws, 5 % and 1 % are as unlikely as that, to four standard errors."""
    generator = np.random.default_rng(4)
    root = generator.normal(size=(4, 4)) * np.array([[1e-3], [1e-3], [1e-3], [1e-5]])
    covariance = root @ root.T
    draws = generator.multivariate_normal([3.6, 0, 0, 0], covariance, 20_000, method="svd")
    chances = np.array([of(list(draw), 0.3 * covariance, 0.7 * covariance).chances for draw in draws])
    for level in (0.05, 0.01):
        share = (chances < level).mean(axis=0)
        assert share == pytest.approx([level] * 2, abs=4 * math.sqrt(level / 20_000))


def test_the_whole_run_by_hand() -> None:
    """Segments of 100 and 300 s count by their lengths; the errors are those that are given."""
    parts = [RateDifference(100.0, 2.0, 1.0, 0.3, 0.1), RateDifference(300.0, -2.0, -1.0, 0.2, 0.3)]
    whole = over_segments(parts, 0.3, 0.4)
    assert (whole.duration_s, whole.measured, whole.commanded) == (400.0, -1.0, -0.5)
    assert whole.error == pytest.approx(0.5)
