"""Propagation of uncertainty: the worked examples of the GUM (JCGM 100:2008), and Student's quantiles."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import t as student

from fogreduce.estimate.propagation import (
    correlations,
    coverage_factor,
    from_sources,
    propagated,
    standard_uncertainties,
    student_95,
)

# Table H.2: five sets of simultaneous observations of voltage [V], current [A] and phase [rad].
VOLTAGE = np.array([5.007, 4.994, 5.005, 4.990, 4.999])
CURRENT = np.array([19.663, 19.639, 19.640, 19.685, 19.678]) * 1e-3
PHASE = np.array([1.0456, 1.0438, 1.0468, 1.0428, 1.0433])

# Table H.6: a thermometer's readings [degC] and corrections [degC], with the reference at 20 degC.
READING = np.array([21.521, 22.012, 22.512, 23.003, 23.507, 23.999, 24.513, 25.002, 25.503, 26.010, 26.511])
CORRECTION = -np.array([0.171, 0.169, 0.166, 0.159, 0.164, 0.165, 0.156, 0.157, 0.159, 0.161, 0.160])


def impedance(x: np.ndarray) -> np.ndarray:
    """Resistance, reactance and impedance (H.2.2)."""
    voltage, current, phase = x
    return voltage / current * np.array([math.cos(phase), math.sin(phase), 1.0])


def impedance_jacobian(x: np.ndarray) -> np.ndarray:
    voltage, current = x[:2]
    resistance, reactance, whole = impedance(x)
    return np.array(
        [
            [resistance / voltage, -resistance / current, -reactance],
            [reactance / voltage, -reactance / current, resistance],
            [whole / voltage, -whole / current, 0.0],
        ]
    )


def test_gum_h2_impedance() -> None:
    """Table H.4: R 127.732(70), X 219.85(30), Z 254.26(24) ohm; r -0.59, -0.49, +0.99."""
    observations = np.array([VOLTAGE, CURRENT, PHASE])
    x = observations.mean(axis=1)
    covariance = propagated(impedance_jacobian(x), np.cov(observations) / 5)
    np.testing.assert_allclose(impedance(x), [127.732, 219.847, 254.260], atol=5e-4)
    np.testing.assert_allclose(standard_uncertainties(covariance), [0.071, 0.295, 0.236], atol=6e-4)
    r = correlations(covariance)
    np.testing.assert_allclose([r[0, 1], r[0, 2], r[1, 2]], [-0.588, -0.485, 0.993], atol=6e-4)


def test_its_derivatives_are_differences() -> None:
    x = np.array([5.0, 0.0197, 1.04])
    steps = np.diag(1e-6 * x)
    numeric = [(impedance(x + s) - impedance(x - s)) / (2 * s.sum()) for s in steps]
    np.testing.assert_allclose(impedance_jacobian(x), np.array(numeric).T, rtol=1e-8, atol=1e-6)


def straight_line() -> tuple[np.ndarray, np.ndarray, float]:
    """Intercept and slope of the corrections against (reading - 20 degC) as a matrix times them; scatter."""
    columns = np.array([np.ones(READING.size), READING - 20.0])
    estimator = np.linalg.inv(columns @ columns.T) @ columns
    left = CORRECTION - (estimator @ CORRECTION) @ columns
    return estimator, left, math.sqrt(left @ left / (READING.size - 2))


def test_gum_h3_straight_line() -> None:
    """H.3.3 and H.3.4: -0.1712(29) degC, 0.00218(67), r -0.930; at 30 degC -0.1494(41) degC."""
    estimator, _, scatter = straight_line()
    line = estimator @ CORRECTION
    covariance = propagated(estimator, scatter**2 * np.eye(READING.size))
    assert (np.abs(line - [-0.1712, 0.00218]) < [5e-5, 5e-6]).all()
    assert (np.abs(standard_uncertainties(covariance) - [0.0029, 0.00067]) < [5e-5, 5e-6]).all()
    assert correlations(covariance)[0, 1] == pytest.approx(-0.930, abs=5e-4)
    at_30 = np.array([[1.0, 10.0]])
    assert (at_30 @ line)[0] == pytest.approx(-0.1494, abs=5e-5)
    assert standard_uncertainties(propagated(at_30, covariance))[0] == pytest.approx(0.0041, abs=5e-5)


def test_gum_h3_with_a_systematic_error() -> None:
    """An error of 0.005 degC common to all readings: the intercept's 0.00577, by hand hypot(0.0029, 0.005);
    the slope's stays."""
    estimator, _, scatter = straight_line()
    random = propagated(estimator, scatter**2 * np.eye(READING.size))
    common = from_sources(np.full((1, READING.size), 0.005))
    errors = standard_uncertainties(random + propagated(estimator, common))
    assert errors[0] == pytest.approx(0.00577, abs=1e-5)
    assert errors[1] == pytest.approx(standard_uncertainties(random)[1], rel=1e-9)


def test_rounding_below_zero_is_no_uncertainty() -> None:
    assert standard_uncertainties(np.diag([-1e-30, 4.0])).tolist() == [0.0, 2.0]
    assert np.isnan(correlations(np.diag([0.0, 4.0]))[0, 1])


@pytest.mark.parametrize("freedom", [3.0, 4.0, 6.5, 10.0, 100.0, 1e9])
def test_students_quantile_against_scipy(freedom: float) -> None:
    assert student_95(freedom) == pytest.approx(student.ppf(0.975, freedom), rel=2e-3)


@pytest.mark.parametrize("relative", [0.1, 1.0, 2.0])
def test_a_coverage_factor_covers_95_percent(relative: float) -> None:
    """A normal value whose variance is itself drawn, of mean 1 and variance `relative`^2, from the inverse
    gamma law that makes a t distribution: of 400 000, 95 % lie within, to four standard errors and 0.2 %."""
    generator = np.random.default_rng(3)
    shape = 2.0 + 1.0 / relative**2
    variance = (shape - 1.0) / generator.gamma(shape, size=400_000)
    values = generator.normal(size=variance.size) * np.sqrt(variance)
    covered = np.mean(np.abs(values) < coverage_factor(1.0, relative**2))
    assert covered == pytest.approx(0.95, abs=4 * math.sqrt(0.95 * 0.05 / values.size) + 2e-3)


def test_a_known_variance_has_the_normal_factor() -> None:
    assert coverage_factor(2.0, 0.0) == pytest.approx(1.95996, abs=1e-5)
    assert coverage_factor(0.0, 0.0) == pytest.approx(1.95996, abs=1e-5)
