"""The Levenberg-Marquardt fit against curves known beforehand, against the linear fit, and its errors."""

import math

import numpy as np
import pytest

from fogreduce.errors import FogreduceError
from fogreduce.estimate.levenberg_marquardt import fit_curve
from fogreduce.estimate.mean_curve import CurveBasis, CurveSums, curve

RATE_DEG_S = 0.06
RATE = math.radians(RATE_DEG_S)
STOP_S = 6000.0
#: a, p, q, e of the size that the paper's Table 4 gives for gyro 1: volts, and volts a second.
THETA = np.array([3.0e-3, -2.5e-4, 7.0e-7, -8.1e-10])
SIGMA = 33.4e-6  # noise of a sample of gyro 1 [V]: its printed errors over the whole record imply it


def times(records: int) -> np.ndarray:
    return np.arange(records) * (STOP_S / records)


def noisy(records: int, rate: float = RATE, seed: int = 3) -> tuple[np.ndarray, np.ndarray]:
    time_s = times(records)
    noise = np.random.default_rng(seed).normal(0.0, SIGMA, records)
    return time_s, curve(time_s, np.append(THETA, rate)) + noise


def linear(time_s, values):
    basis = CurveBasis.of(0.0, STOP_S, RATE_DEG_S)
    sums = CurveSums(basis, 1)
    for start in range(0, time_s.size, 4096):
        part = slice(start, start + 4096)
        sums.add(basis.columns(time_s[part]), values[None, part], None)
    return sums.fit(0)


@pytest.mark.parametrize("free_rate", [False, True])
def test_a_curve_without_noise_comes_back(free_rate):
    """Limit: no noise. Rounding of values of 3e-3 leaves 1e-12 of the largest parameter."""
    time_s = times(5000)
    rate = RATE * (1 + 2e-4 * free_rate)  # a table 200 ppm fast, where c may move
    fit = fit_curve(time_s, curve(time_s, np.append(THETA, rate)), RATE, free_rate=free_rate)
    np.testing.assert_allclose(fit.theta[:3], THETA[:3], rtol=0, atol=1e-12 * THETA[0])
    assert fit.theta[3] == pytest.approx(THETA[3], rel=1e-9)
    assert fit.theta[4] == pytest.approx(rate, rel=1e-9)


def test_equal_to_the_linear_fit_with_the_rate_held():
    """Two algorithms, one minimum: 1e-9 relative, parameters and their errors."""
    time_s, values = noisy(96_000)
    one, other = linear(time_s, values), fit_curve(time_s, values, RATE, free_rate=False)
    np.testing.assert_allclose(other.theta[:4], one.theta, rtol=1e-9)
    np.testing.assert_allclose(other.covariance[:4, :4], one.covariance, rtol=1e-9)
    assert other.sigma == pytest.approx(one.sigma, rel=1e-9)
    assert other.theta[4] == RATE
    assert not other.covariance[4].any()


def test_a_standstill_is_a_straight_line():
    """c = 0: a and e as numpy's own polynomial fit has them."""
    time_s, values = noisy(4000)
    fit = fit_curve(time_s, values, 0.0, free_rate=True)
    slope, offset = np.polyfit(time_s, values, 1)
    assert fit.theta[[0, 3]] == pytest.approx([offset, slope], rel=1e-9)
    assert not fit.theta[[1, 2, 4]].any()


def test_free_rate_covers_the_truth():
    """Chi square of the five parameters over 60 seeds: mean 5, standard deviation sqrt(10 / 60) = 0.41."""
    truth = np.append(THETA, RATE * 1.001)
    squares = []
    for seed in range(60):
        fit = fit_curve(*noisy(4000, truth[4], seed), RATE, free_rate=True)
        off = fit.theta - truth
        squares.append(off @ np.linalg.solve(fit.covariance, off))
    assert np.mean(squares) == pytest.approx(5.0, abs=4 * 0.41)


def test_freeing_the_rate_costs_precision():
    """A further parameter widens the errors of the others (5 %: their columns are at the fitted c)."""
    time_s, values = noisy(20_000)
    held = fit_curve(time_s, values, RATE, free_rate=False)
    free = fit_curve(time_s, values, RATE, free_rate=True)
    assert (np.diag(free.covariance)[:4] >= 0.95 * np.diag(held.covariance)[:4]).all()
    assert free.sigma == pytest.approx(held.sigma, rel=1e-3)


def test_too_few_records_are_refused():
    with pytest.raises(FogreduceError, match="5 records do not determine"):
        fit_curve(times(5), times(5), RATE, free_rate=False)


def test_records_that_cannot_tell_line_from_sine_are_refused():
    """A turn of 1e-5 rad: the sine is a straight line."""
    time_s, values = noisy(1000)
    with pytest.raises(FogreduceError, match="do not determine"):
        fit_curve(time_s, values, 1e-9, free_rate=False)
