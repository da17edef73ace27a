"""The error that rounding leaves in a mean: limits, and against rounded draws."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.special import ndtri

from fogreduce.estimate.rounding import correlation_time, systematic_variance


def test_without_noise_it_is_uniform_over_a_step() -> None:
    """A rounding error uniform over a step has the variance q^2 / 12."""
    assert systematic_variance(0.5, 0.0) == pytest.approx(0.25 / 12)
    assert systematic_variance(0.5, 0.5 / math.sqrt(12)) == pytest.approx(0.25 / 12, rel=1e-3)


@pytest.mark.parametrize("noise", [0.1, 0.2, 0.3, 0.4])
def test_against_rounded_draws(noise: float) -> None:
    """The mean error of rounded values at 400 places between two steps: its variance over the places.

    The values are the 20 000 quantiles of the noise."""
    places = (np.arange(400) + 0.5) / 400
    draws = noise * ndtri((np.arange(20_000) + 0.5) / 20_000)
    rounded = np.rint(places[:, None] + draws)
    variance = np.var((rounded - draws).mean(axis=1) - places)
    found = systematic_variance(1.0, math.sqrt(noise**2 + 1 / 12))
    assert found == pytest.approx(variance, rel=0.02)


def test_noise_of_a_step_leaves_nothing() -> None:
    assert systematic_variance(1e-7, 1e-7 * math.sqrt(1 + 1 / 12)) == 0.0
    assert systematic_variance(0.0, 1.0) == 0.0


def test_a_value_that_moves_by_four_steps() -> None:
    """Four periods of a sawtooth in 400 s: like itself for a quarter of one."""
    assert correlation_time(1.0, 4.0, 400.0) == pytest.approx(25.0)
    assert correlation_time(1.0, 0.1, 400.0) == pytest.approx(100.0)
