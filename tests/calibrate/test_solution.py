"""The normal equations against generalised least squares written out in full, and the record's parameters."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.calibrate.equations import DEPARTURE, MOTION, ONE, READING, SHAPES, Product
from fogreduce.calibrate.parameters import parameters_of
from fogreduce.calibrate.solution import (
    IGNORANCE_AXIS_RAD,
    IGNORANCE_BIAS_DEG_H,
    IGNORANCE_SCALE_REL,
    Layout,
    Prior,
    Solution,
    solve,
)
from fogreduce.physics.redundancy import projection

TURN_ON = 0.4


def made_up(generator):
    """One gyro in three runs of 40 bins: columns, readings and white noise of 0.5 deg/h."""
    runs = []
    for axis, rate in ((0, 5.0), (1, -3.0), (2, 2.0)):
        motion = np.full((3, 40), 0.003) + generator.normal(0, 1e-3, (3, 40))
        motion[axis] += rate
        columns = np.zeros((40, READING + 1))
        columns[:, ONE] = 1
        columns[:, MOTION] = motion.T
        columns[:, DEPARTURE] = generator.normal(0, 1e-5, (40, 9))
        columns[:, READING] = 7.0 + motion.T @ (3600 * np.array([0.6, 0.5, 0.62]))
        columns[:, READING] += generator.normal(0, TURN_ON) + generator.normal(0, 0.5, 40)
        runs.append(columns)
    return runs


def test_agrees_with_generalised_least_squares_in_full() -> None:
    runs = made_up(np.random.default_rng(1))
    axis = np.array([[0.61, 0.5, 0.615]])
    products = []
    for k, c in enumerate(runs):
        about = c.copy()  # the equations' readings are less what the present record makes of them
        about[:, READING] -= 6.0 + c[:, MOTION] @ (3600 * axis[0])
        products.append(Product(k, 0, (about.T @ about) / 0.25, 40 * np.log(0.25), 40))
    prior = Prior(axis, np.array([6.0]), np.array([TURN_ON]))
    found = solve(products, 1, 3, prior, turn_on=np.array([TURN_ON]))
    # In full: readings stacked, their covariance with the turn-on bias common to a run, priors as readings.
    s = found.values[1:4]
    design = np.zeros((120, 9))
    covariance = np.zeros((120, 120))
    reading = np.concatenate([c[:, READING] for c in runs])
    for k, c in enumerate(runs):
        rows = slice(40 * k, 40 * k + 40)
        design[rows, 0], design[rows, 1:4] = 1, c[:, MOTION]
        sources = c[:, DEPARTURE].reshape(40, 3, 3) @ s
        design[rows, 4 + k], design[rows, 7:9] = sources[:, 0], sources[:, 1:]
        covariance[rows, rows] = 0.25 * np.eye(40) + TURN_ON**2
    mean = np.array([6.0, *3600 * axis[0], 0, 0, 0, 0, 0])
    along = np.outer(axis[0], axis[0])
    wide = np.diag([IGNORANCE_BIAS_DEG_H**-2, 0, 0, 0, 1, 1, 1, 1, 1.0])
    wide[1:4, 1:4] = along / (3600 * IGNORANCE_SCALE_REL) ** 2
    wide[1:4, 1:4] += (np.eye(3) - along) / (3600 * IGNORANCE_AXIS_RAD) ** 2
    weight = np.linalg.inv(covariance)
    expected_covariance = np.linalg.inv(design.T @ weight @ design + wide)
    expected = mean + expected_covariance @ design.T @ weight @ (reading - design @ mean)
    assert found.values == pytest.approx(expected, rel=1e-7, abs=1e-7)
    assert np.allclose(found.covariance, expected_covariance, rtol=1e-6, atol=1e-12)


def test_parameters_go_with_their_derivatives() -> None:
    """The covariance of bias, scale factor and axis against finite differences of their definition."""
    layout = Layout(1, 1)
    generator = np.random.default_rng(2)
    half = generator.normal(0, 1, (layout.size, layout.size))
    values = np.array([30.0, 2000.0, -1500.0, 2600.0, 0, 0, 0])

    def solution(at):
        return Solution(layout, at, np.eye(7), half @ half.T, np.ones(1), np.ones(1), 0.0, 1.0, np.zeros(7))

    found = parameters_of(solution(values))

    def of(at):
        one = parameters_of(solution(at))
        return np.array(
            [one.bias_deg_h[0], one.scale_ratio[0] / found.scale_ratio[0], *(found.across[0] @ one.axes[0])]
        )

    steps = np.eye(7) * 1e-3
    jacobian = np.array([(of(values + step) - of(values - step)) / 2e-3 for step in steps]).T
    assert np.allclose(found.covariance, jacobian @ half @ half.T @ jacobian.T, rtol=1e-5)
    assert np.linalg.norm(found.axes[0]) == pytest.approx(1)


def test_h_by_noise_is_the_pseudo_inverse_where_noise_is_equal_and_quieter_where_not() -> None:
    axes = np.array([[1.0, 0, 0], [0, 1, 0], [0, 0, 1], [0.6, 0.0, 0.8]])
    assert projection(axes, [2.0] * 4) == pytest.approx(projection(axes))
    white = np.array([1.0, 1.0, 1.0, 10.0])
    by_noise, plain = projection(axes, white), projection(axes)
    assert by_noise @ axes == pytest.approx(np.eye(3), abs=1e-12)
    variance = [np.diag(h @ np.diag(white**2) @ h.T) for h in (by_noise, plain)]
    assert (variance[0] <= variance[1] + 1e-12).all()
    # A useless fourth gyro: three orthogonal ones remain, each axis with one gyro's noise.
    assert np.sqrt(variance[0]) == pytest.approx([1, 1, 1], abs=0.01)


def test_shapes_have_a_column_each() -> None:
    assert READING - DEPARTURE.stop == len(SHAPES)
