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
    coefficient_covariance,
    fit_noise,
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


def flicker_noise(bins: int, generator: np.random.Generator) -> np.ndarray:
    """Flicker of B = 1 a second, straight from its definition: density 1 / (pi f) from 1e-5 Hz up, by
    transform.

    A piece out of 2^17 s, so that the transform's period does not show.
    """
    size = 2**17
    frequency = np.fft.rfftfreq(size, 1.0)
    density = np.where(frequency >= 1e-5, 1 / (np.pi * np.maximum(frequency, 1e-9)), 0.0)
    spectrum = generator.normal(size=(2, frequency.size)).T.copy().view(complex)[:, 0]
    # A line of variance S df has amplitudes of variance S df / 2 in cosine and in sine.
    return np.fft.irfft(spectrum * np.sqrt(density / size) * size / 2)[:bins]


@pytest.mark.parametrize("rate", [0.06, 0.0])
@pytest.mark.parametrize("flicker", [0.0, 1.0])
def test_stated_errors_are_the_scatter_of_repeated_runs(rate: float, flicker: float) -> None:
    """200 runs of 6000 s in bins of 1 s, white noise and flicker: each run is fitted, its residual's colour
    estimated, and each coefficient divided by the error that follows: these scatter by 1.

    The scatter of 200 is known to 5 %, but one run's colour to some 20 % only (the longest averaging times
    have a few degrees of freedom), and no coefficient is let below zero, so that white noise alone now and
    then passes for a little colour: 25 % is asked for. Errors of white noise alone would be out by a
    factor where there is flicker, which is checked too.
    """
    runs, bins, white = 200, 6000, 5.0
    generator = np.random.default_rng(8)
    basis = CurveBasis.of(0.0, 6000.0, rate)
    columns = basis.columns(np.arange(bins) + 0.5)
    inverse = np.linalg.inv(columns @ columns.T)
    found, stated = [], []
    for _ in range(runs):
        values = generator.normal(0.0, white, bins)
        if flicker:
            values += flicker * flicker_noise(bins, generator)
        beta = inverse @ (columns @ values)
        noise = fit_noise(*allan_variance(values - beta @ columns, 1.0))
        covariance = coefficient_covariance(columns, noise, 1.0)
        found.append(basis.to_theta @ beta)
        stated.append(np.sqrt(np.diag(basis.to_theta @ covariance @ basis.to_theta.T)))
    known = [0, 1, 2, 3] if rate else [0, 3]
    in_errors = np.array(found)[:, known] / np.array(stated)[:, known]
    np.testing.assert_allclose(in_errors.std(axis=0), 1.0, atol=0.25)
    if flicker:
        of_white_noise = white * math.sqrt((basis.to_theta @ inverse @ basis.to_theta.T)[0, 0])
        assert np.std(found, axis=0)[0] > 3 * of_white_noise
