"""Errors that allow for noise of unknown size: by experiment, with truths drawn from outside the model."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.linalg import toeplitz

from fogreduce.estimate.coloured import ColouredNoise, combined, unit_forms
from fogreduce.estimate.curve_terms import drift_terms
from fogreduce.estimate.mean_curve import CurveBasis
from fogreduce.estimate.noise_grid import NoiseGrid, likelihood
from fogreduce.estimate.noise_posterior import NoisePosterior, posteriors
from fogreduce.physics.noise import flicker_covariance

GYROS = 4


def bins_of_noise(
    runs: int, bins: int, period_s: float, noise: ColouredNoise, generator: np.random.Generator
) -> np.ndarray:
    """Means over bins of white noise, flicker by its exact covariance, and a walk in eight steps a bin."""
    values = generator.normal(size=(runs, bins)) * math.sqrt(noise.white / period_s)
    if noise.walk:
        steps = generator.normal(size=(runs, 8 * bins)) * math.sqrt(noise.walk * period_s / 8)
        values += np.cumsum(steps, axis=1).reshape(runs, bins, 8).mean(axis=2)
    if noise.flicker:
        covariance = toeplitz(flicker_covariance(math.sqrt(noise.flicker), period_s, bins))
        root = np.linalg.cholesky(covariance + 1e-12 * covariance[0, 0] * np.eye(bins))
        values += generator.normal(size=(runs, bins)) @ root.T
    return values


class Design:
    """One turn or part of it at 0.06 deg/s, in bins."""

    def __init__(self, duration_s: float, bins: int) -> None:
        self.period_s = duration_s / bins
        basis = CurveBasis.of(0.0, duration_s, 0.06)
        self.columns = basis.columns((np.arange(bins) + 0.5) * self.period_s)
        rows = np.linalg.inv(self.columns @ self.columns.T) @ self.columns
        terms = drift_terms(0.0, duration_s, basis.rate_rad_s) / duration_s
        self.drift = terms @ basis.to_theta @ rows
        self.forms = unit_forms(self.drift[None], self.period_s)
        self.grid = NoiseGrid.of(duration_s, self.period_s)

    def errors(self, values: np.ndarray, stated: ColouredNoise | None) -> np.ndarray:
        """Standard errors of the drifts of one unit's gyros."""
        found = likelihood(self.grid, self.columns, values, self.period_s)
        each = (
            [None, None] if stated is None else [np.full(GYROS, stated.flicker), np.full(GYROS, stated.walk)]
        )
        known = posteriors(self.grid, found, *each)
        return np.sqrt([combined(self.forms, gyro.mean)[0, 0] for gyro in known])


#: deg/h, white noise of 0.002 deg/sqrt(h); flicker of 0.03 deg/h; walks of 0.1, 1, 10 deg/h/sqrt(h).
WHITE = (60 * 0.002) ** 2
KINDS = {
    "white": ColouredNoise(WHITE, 0.0, 0.0),
    "flicker": ColouredNoise(WHITE, 0.03**2, 0.0),
    "walk 0.1": ColouredNoise(WHITE, 0.0, 0.1**2 / 3600),
    "walk 1": ColouredNoise(WHITE, 0.0, 1.0 / 3600),
    "walk 10": ColouredNoise(WHITE, 0.0, 100.0 / 3600),
}


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("duration_s", "bins"), [(300.0, 600), (6000.0, 1500)])
def test_a_record_that_states_its_noise(kind: str, duration_s: float, bins: int) -> None:
    """200 units of four gyros: 95 % of the 800 drifts within, to three of their standard errors (0.8 %); the
    errors at most 1.1 of the actual ones."""
    design, noise = Design(duration_s, bins), KINDS[kind]
    values = bins_of_noise(200 * GYROS, bins, design.period_s, noise, np.random.default_rng(11))
    errors = np.array([design.errors(v, noise) for v in values.reshape(200, GYROS, bins)]).ravel()
    covered = np.mean(np.abs(values @ design.drift) < 1.96 * errors)
    assert covered == pytest.approx(0.95, abs=3 * math.sqrt(0.95 * 0.05 / 800))
    assert errors.mean() < 1.1 * math.sqrt(combined(design.forms, noise)[0, 0])


@pytest.mark.parametrize("kind", ["white", "walk 1"])
def test_the_errors_of_a_few_units(kind: str) -> None:
    """30 units of 300 s, with a record and without: the mean variance is the actual one within 25 %."""
    design, noise = Design(300.0, 300), KINDS[kind]
    values = bins_of_noise(30 * GYROS, 300, 1.0, noise, np.random.default_rng(12))
    actual = combined(design.forms, noise)[0, 0]
    for stated in (noise, None):
        variance = np.mean([design.errors(v, stated) ** 2 for v in values.reshape(30, GYROS, 300)])
        assert variance == pytest.approx(actual, rel=0.25 if stated else 0.4)


def test_a_record_that_is_wrong_is_overruled() -> None:
    """The record says no walk; the gyros wander by 10 deg/h/sqrt(h), which 300 s show."""
    design = Design(300.0, 300)
    values = bins_of_noise(GYROS, 300, 1.0, KINDS["walk 10"], np.random.default_rng(13))
    errors = design.errors(values, KINDS["white"])
    actual = math.sqrt(combined(design.forms, KINDS["walk 10"])[0, 0])
    assert errors == pytest.approx(np.full(GYROS, actual), rel=0.3)


def test_without_colour_it_is_least_squares() -> None:
    """White noise, a record that says so: the error is sigma |weights|, by the residuals' sigma; a tenth more
    at most for the record that may no longer hold."""
    design = Design(600.0, 600)
    values = np.random.default_rng(14).normal(size=(GYROS, 600))
    stated = ColouredNoise(1.0, 0.0, 0.0)
    basis, _ = np.linalg.qr(design.columns.T)
    left = values - (values @ basis) @ basis.T
    sigma = np.sqrt((left**2).sum(axis=1) / 596)
    ratio = design.errors(values, stated) / (sigma * np.linalg.norm(design.drift))
    assert (ratio > 0.98).all()
    assert (ratio < 1.1).all()


def test_the_curve_in_the_values_makes_no_difference() -> None:
    design = Design(300.0, 300)
    values = np.random.default_rng(15).normal(size=(GYROS, 300))
    moved = values + np.random.default_rng(16).normal(size=(GYROS, 4)) @ design.columns * 100.0
    np.testing.assert_allclose(design.errors(moved, None), design.errors(values, None), rtol=1e-6)


def test_no_noise_at_all() -> None:
    """Values that lie on the curve have no error, and a gyro among others that is silent has none either."""
    design = Design(300.0, 300)
    assert design.errors(np.zeros((GYROS, 300)), None).tolist() == [0.0] * GYROS
    values = np.random.default_rng(17).normal(size=(GYROS, 300))
    values[1] = 0.0
    errors = design.errors(values, None)
    assert errors[1] == 0.0
    assert (errors[[0, 2, 3]] > 0.0).all()


def test_in_another_unit() -> None:
    """In volts of 2 V/(deg/h) the coefficients are four times as large, their covariance sixteen times."""
    found = NoisePosterior(ColouredNoise(1.0, 2.0, 3.0), np.eye(3)).scaled(4.0)
    assert found.mean == ColouredNoise(4.0, 8.0, 12.0)
    assert found.variance_of(np.array([1.0, 0.0, 0.0])) == 16.0
