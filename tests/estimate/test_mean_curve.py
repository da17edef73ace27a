"""The mean curve: by hand, against other solvers and other precision, and its errors by experiment."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.optimize import curve_fit

from fogreduce.estimate.mean_curve import (
    CurveBasis,
    CurveFit,
    CurveSums,
    amplitude_and_phase,
    curve,
    curve_integral,
    integral_terms,
)

PAPER = (0.0621, -2.4e-4, 1.3, 0.0, 1.8e-7)  # a, b, d of an x axis like Table 5's, e


def fitted(
    time_s: np.ndarray, values: np.ndarray, rate_deg_s: float, stop_s: float, start_s: float = 0.0
) -> CurveFit:
    basis = CurveBasis.of(start_s, stop_s, rate_deg_s)
    sums = CurveSums(basis, 1)
    sums.add(basis.columns(time_s), values[None], None)
    fit = sums.fit(0)
    assert fit is not None
    return fit


# -------------------------------------------------------------------------------------- by hand


@pytest.mark.parametrize("rate", [0.06, -0.06, 10.0, -3.0])
@pytest.mark.parametrize("start", [0.0, 1500.0])
def test_a_curve_without_noise_is_found_again(rate: float, start: float) -> None:
    """Both senses, from t = 0 and in a later segment; to 1e-12 of the largest term, e t being of order
    1e-3."""
    stop = start + 6000.0
    time_s = np.linspace(start, stop, 20_000, endpoint=False)
    a, b, d, e = 0.0621, 2.4e-4, -2.2, 1.8e-7
    c = math.radians(rate)
    fit = fitted(time_s, a + b * np.sin(c * time_s + d) + e * time_s, rate, stop, start)
    expected = np.array([a, b * math.sin(d), b * math.cos(d), e])
    np.testing.assert_allclose(fit.theta, expected, rtol=1e-9, atol=1e-12 * a)
    assert amplitude_and_phase(fit.theta, fit.covariance)[2] == pytest.approx(d, abs=1e-9)
    assert (fit.records, fit.has_sine, fit.rate_rad_s) == (20_000, True, c)


def test_a_standstill_has_a_straight_line_only() -> None:
    time_s = np.arange(1000.0)
    fit = fitted(time_s, 3.0 + 0.25 * time_s, 0.0, 1000.0)
    np.testing.assert_allclose(fit.theta, [3.0, 0.0, 0.0, 0.25], atol=1e-12)
    assert not fit.has_sine
    assert not fit.covariance[1:3].any()


def test_straight_line_errors_by_hand() -> None:
    """Values 0, 1, 0, 1, 0 at t = 0 ... 4: mean 0.4, slope 0, residual sum of squares 1.2, so sigma^2 = 0.4
    on 5 - 2 degrees of freedom; variance of the slope 0.4 / 10, of the offset at t = 0 0.4 (1/5 + 4/10)."""
    fit = fitted(np.arange(5.0), np.array([0.0, 1.0, 0.0, 1.0, 0.0]), 0.0, 5.0)
    np.testing.assert_allclose(fit.theta, [0.4, 0.0, 0.0, 0.0], atol=1e-15)
    assert fit.sigma**2 == pytest.approx(0.4)
    np.testing.assert_allclose(np.diag(fit.covariance), [0.24, 0.0, 0.0, 0.04], atol=1e-15)


def test_a_turn_too_short_for_a_sine_says_so() -> None:
    """1e-5 deg/s for 100 s, a thousandth of a degree: sine and parabola cannot be told apart in doubles."""
    assert not CurveBasis.of(0.0, 100.0, 1e-5).has_sine
    assert CurveBasis.of(0.0, 100.0, 0.06).has_sine


def test_records_that_do_not_determine_a_curve_give_none() -> None:
    basis = CurveBasis.of(0.0, 6000.0, 0.06)
    sums = CurveSums(basis, 2)
    assert sums.fit(0) is None
    time_s = np.arange(4.0)
    sums.add(basis.columns(time_s), np.ones((2, 4)), None)
    assert sums.fit(0) is None  # four records, four parameters: no scatter
    many = np.full(500, 17.0)
    sums.add(basis.columns(many), np.ones((2, 500)), None)
    assert sums.fit(1) is None  # all but four at one instant


@pytest.mark.parametrize(
    ("p", "q", "b", "d"),
    [
        (0.0, 2.0, 2.0, 0.0),
        (2.0, 0.0, 2.0, math.pi / 2),
        (-2.0, 0.0, 2.0, -math.pi / 2),
        (0.0, -2.0, 2.0, math.pi),
        (-0.0, -2.0, 2.0, math.pi),  # -pi is not in (-pi, pi]
        (3.0, -4.0, 5.0, math.atan2(3.0, -4.0)),
    ],
)
def test_amplitude_and_phase_by_hand(p: float, q: float, b: float, d: float) -> None:
    """p = b sin d, q = b cos d; with independent errors of 0.1 in both, b's is 0.1 and d's 0.1 / b."""
    covariance = np.diag([0.0, 0.01, 0.01, 0.0])
    found = amplitude_and_phase(np.array([0.0, p, q, 0.0]), covariance)
    np.testing.assert_allclose(found, [b, 0.1, d, 0.1 / b], rtol=1e-15)


@pytest.mark.parametrize("rate", [0.0, 1e-9, 1e-3, -0.2])
def test_integrals_against_quadrature(rate: float) -> None:
    theta = np.array([0.3, -0.2, 0.5, 1e-3, rate])
    for time_s in (0.0, 1.0, 300.0):
        expected, _ = quad(lambda t: curve(np.array([t]), theta)[0], 0.0, time_s, epsabs=1e-12, limit=200)
        assert curve_integral(np.array([time_s]), theta)[0] == pytest.approx(expected, rel=1e-11, abs=1e-12)
    assert integral_terms(np.array([0.0]), rate).any() == np.False_


# -------------------------------------------------------------------- other solvers, other precision


@pytest.mark.parametrize("rate", [0.06, 0.5, -10.0])
def test_against_levenberg_marquardt_with_the_rate_held(rate: float) -> None:
    """scipy's scaled MINPACK fit of eq. 7, c held: both agree to 1e-9 of each parameter, and in the errors.

    MINPACK stops where the sum of squares changes by less than a rounding error, some 1e-6 of a standard
    error from the minimum; one last step without damping takes it there. Errors differ by the curvature of
    eq. 7.
    """
    generator = np.random.default_rng(1)
    time_s = np.arange(0.0, 6000.0, 0.5)
    c = math.radians(rate)

    def model(t: np.ndarray, a: float, b: float, d: float, e: float) -> np.ndarray:
        return a + b * np.sin(c * t + d) + e * t

    truth = (3.0e-3, 2.5e-4, -1.5, -8e-9)
    values = model(time_s, *truth) + generator.normal(0.0, 3e-5, time_s.size)
    start = (truth[0] * 1.1, truth[1] * 0.9, truth[2] + 0.1, truth[3] * 2)

    def slopes(t: np.ndarray, a: float, b: float, d: float, e: float) -> np.ndarray:
        return np.array([np.ones_like(t), np.sin(c * t + d), b * np.cos(c * t + d), t]).T

    found, covariance = curve_fit(
        model, time_s, values, start, jac=slopes, method="lm", diag=1 / np.abs(truth), xtol=1e-15, ftol=1e-15
    )
    found = found + np.linalg.lstsq(slopes(time_s, *found), values - model(time_s, *found), rcond=None)[0]
    fit = fitted(time_s, values, rate, 6000.0)
    b, b_err, d, d_err = amplitude_and_phase(fit.theta, fit.covariance)
    ours = np.array([fit.theta[0], b, d, fit.theta[3]])
    errors = np.array([math.sqrt(fit.covariance[0, 0]), b_err, d_err, math.sqrt(fit.covariance[3, 3])])
    np.testing.assert_allclose(ours, found, rtol=1e-9)
    np.testing.assert_allclose(errors, np.sqrt(np.diag(covariance)), rtol=1e-6)


def in_long_double(time_s: np.ndarray, values: np.ndarray, c: float) -> np.ndarray:
    """theta by orthogonalisation (Gram and Schmidt, twice) in 64 bits of mantissa, straight from eq. 7."""
    t = time_s.astype(np.longdouble)
    phase = t * np.longdouble(c)
    columns = [np.ones_like(t), np.cos(phase), np.sin(phase), t]
    basis, triangle = [], np.zeros((4, 4), np.longdouble)
    for k, column in enumerate(columns):
        rest = column.copy()
        for _ in range(2):
            for j, unit in enumerate(basis):
                part = unit @ rest
                triangle[j, k] += part
                rest = rest - part * unit
        triangle[k, k] = np.sqrt(rest @ rest)
        basis.append(rest / triangle[k, k])
    target = values.astype(np.longdouble)
    parts = []
    for unit in basis:
        parts.append(unit @ target)
        target = target - parts[-1] * unit
    theta = np.zeros(4, np.longdouble)
    for k in range(3, -1, -1):
        theta[k] = (parts[k] - triangle[k, k + 1 :] @ theta[k + 1 :]) / triangle[k, k]
    return theta


@pytest.mark.skipif(np.finfo(np.longdouble).eps > 1e-18, reason="long double is no longer than double here")
@pytest.mark.parametrize("turned_deg", [360.0, 90.0, 18.0, 6.0])
def test_short_turns_against_extended_precision(turned_deg: float) -> None:
    """Ill-conditioned: over 6 degrees, cosine, sine and line differ by 1e-5 of themselves.

    The yardstick's own error is 1e-19 x condition. Ours: rounding of the columns, 1e-16 x condition of the
    raw columns, relative to the largest coefficient, thirty times over for accumulation.
    """
    duration = 6000.0
    rate = turned_deg / duration
    c = math.radians(rate)
    time_s = np.linspace(0.0, duration, 5000, endpoint=False)
    generator = np.random.default_rng(2)
    values = 0.06 + 2e-4 * np.sin(c * time_s + 1.0) + 1e-7 * time_s + generator.normal(0, 3e-4, time_s.size)
    truth = in_long_double(time_s, values, c)
    fit = fitted(time_s, values, rate, duration)
    raw = np.array([np.ones_like(time_s), np.cos(c * time_s), np.sin(c * time_s), time_s / duration])
    condition = np.linalg.cond(raw)
    scale = np.abs(truth[:3]).max() * np.array([1, 1, 1, 1 / duration])
    assert np.abs((fit.theta - truth) / scale).max() < 30 * np.finfo(float).eps * condition
    # What is drawn and integrated, the curve itself, loses nothing.
    t = time_s.astype(np.longdouble)
    smooth = truth[0] + truth[1] * np.cos(c * t) + truth[2] * np.sin(c * t) + truth[3] * t
    own = 1e-15 * np.abs(truth[:3]).max()  # rounding in the evaluation of large terms that cancel
    np.testing.assert_allclose(curve(time_s, fit.with_rate), smooth.astype(float), atol=1e-12 + 4 * own)


# ------------------------------------------------------------------------------- blocks and masks


def test_blocks_of_any_size_give_the_same() -> None:
    generator = np.random.default_rng(4)
    time_s = np.arange(30_000) / 128
    values = generator.normal([[3e-3], [-7.0]], [[3e-5], [1.0]], (2, time_s.size))
    basis = CurveBasis.of(0.0, time_s[-1], 1.0)
    fits = []
    for block in (30_000, 4096, 1000, 7):
        sums = CurveSums(basis, 2)
        for start in range(0, time_s.size, block):
            part = slice(start, start + block)
            sums.add(basis.columns(time_s[part]), values[:, part], None)
        fits.append([sums.fit(channel) for channel in range(2)])
    for other in fits[1:]:
        for one, same in zip(fits[0], other, strict=True):
            assert one is not None
            assert same is not None
            scale = np.sqrt(np.diag(one.covariance))
            assert np.abs((one.theta - same.theta) / scale).max() < 1e-9
            assert same.sigma == pytest.approx(one.sigma, rel=1e-12)
            np.testing.assert_allclose(
                same.theta, one.theta, rtol=1e-12, atol=1e-12 * np.abs(one.theta).max()
            )


def test_unusable_values_are_as_if_they_were_not_there() -> None:
    """NaN, spikes and all: a mask a channel, against a fit to what is left."""
    generator = np.random.default_rng(5)
    time_s = np.arange(5000.0)
    values = generator.normal(1.0, 1e-3, (3, time_s.size))
    usable = generator.random(values.shape) > 0.01
    usable[:, 0] = False  # the very first one, too
    values[~usable] = generator.choice([np.nan, 1e9], (~usable).sum())
    kept = values.copy()
    basis = CurveBasis.of(0.0, 5000.0, 0.06)
    sums = CurveSums(basis, 3)
    for start in range(0, 5000, 1000):
        part = slice(start, start + 1000)
        sums.add(basis.columns(time_s[part]), values[:, part], usable[:, part])
    np.testing.assert_array_equal(values, kept)
    for channel in range(3):
        there = usable[channel]
        alone = fitted(time_s[there], values[channel, there], 0.06, 5000.0)
        fit = sums.fit(channel)
        assert fit is not None
        assert fit.records == alone.records == there.sum()
        np.testing.assert_allclose(fit.theta, alone.theta, rtol=1e-9, atol=1e-13)
        np.testing.assert_allclose(fit.covariance, alone.covariance, rtol=1e-8)


def test_an_offset_far_above_the_noise_costs_no_digits() -> None:
    """Squares of 1e6 with noise of 1e-3 would leave no digit of sigma, were the offset not taken away
    first."""
    generator = np.random.default_rng(6)
    time_s = np.arange(10_000.0)
    noise = generator.normal(0, 1e-3, time_s.size)
    plain, far = fitted(time_s, noise, 0.06, 1e4), fitted(time_s, noise + 1e6, 0.06, 1e4)
    assert far.sigma == pytest.approx(plain.sigma, rel=1e-6)  # 1e6 itself carries noise of 1e-10


# --------------------------------------------------------------------------------- its errors


@pytest.mark.parametrize(("rate", "channels"), [(0.06, 4), (0.0, 2)])
def test_stated_errors_are_the_scatter_of_repeated_fits(rate: float, channels: int) -> None:
    """2000 records of white noise, fitted anew: the scatter is known to 1 / sqrt(4000), and four of that
    is 6.3 %.

    b, d are compared in their small-error form; b is 30 of its errors, so that curvature adds 1 in 2000.
    """
    draws, sigma = 2000, 0.05
    generator = np.random.default_rng(7)
    time_s = np.arange(0.0, 6000.0, 20.0)
    truth = np.array([1.0, 0.08, -0.1, 1e-5, math.radians(rate)])
    basis = CurveBasis.of(0.0, 6000.0, rate)
    sums = CurveSums(basis, draws)
    smooth = curve(time_s, truth)
    sums.add(basis.columns(time_s), smooth + generator.normal(0, sigma, (draws, time_s.size)), None)
    fits = [sums.fit(draw) for draw in range(draws)]
    rows, stated = [], []
    for fit in fits:
        assert fit is not None
        errors = [math.sqrt(fit.covariance[0, 0]), math.sqrt(fit.covariance[3, 3])]
        row = [fit.theta[0], fit.theta[3]]
        if channels == 4:
            b, b_err, d, d_err = amplitude_and_phase(fit.theta, fit.covariance)
            row, errors = [*row, b, d], [*errors, b_err, d_err]
        rows.append(row)
        stated.append(errors)
    ratio = np.std(rows, axis=0) / np.mean(stated, axis=0)
    np.testing.assert_allclose(ratio, 1.0, atol=4 / math.sqrt(2 * draws))
    assert np.mean([fit.sigma for fit in fits if fit]) == pytest.approx(sigma, rel=0.005)
