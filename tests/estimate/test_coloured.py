"""Coloured residuals: Allan variance against allantools, its fit, and the errors that follow, by
experiment."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fogreduce.estimate.coloured import (
    FLICKER_FLAT,
    ColouredNoise,
    allan_variance,
    combined,
    fit_noise,
    unit_forms,
)
from fogreduce.estimate.mean_curve import CurveBasis


def test_allan_variance_by_hand() -> None:
    """0, 2, 0, 2: differences of neighbours 2, -2, 2; half their mean square is 2."""
    tau, variance, _ = allan_variance(np.array([0.0, 2.0, 0.0, 2.0]), 0.5)
    np.testing.assert_allclose((tau[0], variance[0]), (0.5, 2.0), rtol=1e-15)


@pytest.mark.parametrize("size", [64, 1000, 6000])
def test_allan_variance_against_allantools(size: int) -> None:
    allantools = pytest.importorskip("allantools")
    values = np.cumsum(np.random.default_rng(1).normal(size=size)) * 0.1
    tau, variance, _ = allan_variance(values, 0.25)
    taus, deviations, _, _ = allantools.oadev(values, rate=4.0, data_type="freq", taus=tau)
    np.testing.assert_allclose(taus, tau, rtol=1e-12)
    np.testing.assert_allclose(np.sqrt(variance), deviations, rtol=1e-9)
    assert tau[-1] <= size * 0.25 / 8 < 2 * tau[-1]  # octaves up to an eighth of the record


def test_gaps_are_left_out() -> None:
    """Of 0, 2, gap, 100, 102: only differences whose bins are all there, 2 and 2."""
    values = np.array([0.0, 2.0, np.nan, 100.0, 102.0])
    _, variance, _ = allan_variance(values, 1.0)
    assert variance[0] == pytest.approx(2.0)


def test_a_gap_of_a_few_bins_changes_little() -> None:
    """White noise, 2 % of the bins gone: the estimate moves by its own scatter at most, sqrt(3 / 5000) x
    4."""
    generator = np.random.default_rng(2)
    values = generator.normal(size=5000)
    whole = allan_variance(values, 1.0)[1]
    values[generator.random(values.size) < 0.02] = np.nan
    assert allan_variance(values, 1.0)[1][0] == pytest.approx(whole[0], rel=0.1)


@pytest.mark.parametrize(
    "coefficients", [(3.0, 0.0, 0.0), (3.0, 0.2, 0.0), (1.0, 0.05, 1e-4), (0.0, 0.3, 0.0)]
)
def test_an_exact_allan_variance_is_resolved(coefficients: tuple[float, float, float]) -> None:
    noise = ColouredNoise(*coefficients)
    tau = 2.0 ** np.arange(10)
    found = fit_noise(tau, noise.allan_variance(tau), 6000 / tau)
    np.testing.assert_allclose((found.white, found.flicker, found.walk), coefficients, rtol=1e-6, atol=1e-9)


def test_no_coefficient_is_ever_negative() -> None:
    """A variance that falls faster than white noise's 1 / tau would ask for a negative flicker."""
    tau = 2.0 ** np.arange(8)
    found = fit_noise(tau, 1 / tau**1.5, 1000 / tau)
    assert min(found.white, found.flicker, found.walk) >= 0
    assert found.white > 0


def test_allan_variance_of_the_model_by_hand() -> None:
    """IEEE 952: white N^2 / tau, flicker (2 ln 2 / pi) B^2, walk K^2 tau / 3."""
    noise = ColouredNoise(8.0, 3.0, 0.5)
    expected = 8.0 / 4 + 2 * math.log(2) / math.pi * 3.0 + 0.5 * 4 / 3
    assert noise.allan_variance(np.array([4.0]))[0] == pytest.approx(expected, rel=1e-15)
    assert pytest.approx(0.6643**2, rel=1e-4) == FLICKER_FLAT  # the 0.664 B of every text on the subject


def coefficient_covariance(columns: np.ndarray, noise: ColouredNoise, period_s: float) -> np.ndarray:
    """Covariance of least-squares coefficients under coloured noise."""
    return combined(unit_forms(np.linalg.inv(columns @ columns.T) @ columns, period_s), noise)


def test_white_noise_alone_gives_the_ordinary_covariance() -> None:
    """sigma^2 (Z Z')^-1, and for a mean over m bins sigma^2 / m."""
    columns = CurveBasis.of(0.0, 600.0, 0.5).columns(np.arange(600.0) + 0.5)
    covariance = coefficient_covariance(columns, ColouredNoise(4.0, 0.0, 0.0), 1.0)
    np.testing.assert_allclose(covariance, 4.0 * np.linalg.inv(columns @ columns.T), rtol=1e-10, atol=1e-15)


def test_a_random_walks_mean_by_hand() -> None:
    """Walk from 0 with steps of variance K^2 dt: its mean over T has variance K^2 T / 3."""
    ones = np.ones((1, 5000))
    covariance = coefficient_covariance(ones, ColouredNoise(0.0, 0.0, 0.01), 0.5)
    assert covariance[0, 0] == pytest.approx(0.01 * 2500 / 3, rel=1e-3)  # a sum for an integral: 1.5 / m
