"""One weighted least-squares solution over all runs: bias and axis vector of each gyro, and the motion.

Unknowns are B and s of each gyro, azimuth of each run, latitude and table rate (each in its stated standard
deviations, with that as prior), and, where asked for, departures of shape. Turn-on biases are random with a
standard deviation of each gyro, found by restricted maximum likelihood (REML) with the record's as a weak
prior, so apart from noise within runs. Each gyro's B and s have as prior the present record, so wide that it
decides only what the campaign says nothing of.

Source: Searle, Casella and McCulloch, Variance Components (1992), chapter 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize

from fogreduce.calibrate.equations import DEPARTURE, MOTION, ONE, READING, SHAPE, SHAPES, Product
from fogreduce.constants import SECONDS_PER_HOUR

Array = NDArray[np.float64]

#: Prior about the present record: what is not known better than this is not determined by the campaign.
IGNORANCE_BIAS_DEG_H, IGNORANCE_SCALE_REL, IGNORANCE_AXIS_RAD = 1000.0, 0.05, 0.05
#: The record's turn-on bias is taken to be right within this factor (one standard deviation).
_TURN_ON_FACTOR = 2.0
#: Least turn-on bias [deg/h]: below it a logarithm says nothing.
_LEAST_TURN_ON = 1e-6
_WIDEST = 6.0  # of these standard deviations, searched on both sides
_SPREAD, _POINTS = 2.5, 21  # of ln turn-on bias about the best: where its posterior is summed up
_ROUNDS = 3
_SOURCES = 3  # azimuth, latitude, table rate


@dataclass(frozen=True)
class Layout:
    """Where each unknown stands.

    A gyro has B [deg/h], s (3) [deg/h per deg/s] and the shapes asked for; then azimuth of each run, latitude
    and table rate.
    """

    gyros: int
    runs: int
    shapes: tuple[str, ...] = ()

    @property
    def per_gyro(self) -> int:
        """Unknowns of a gyro."""
        return 4 + len(self.shapes)

    @property
    def size(self) -> int:
        """All unknowns."""
        return self.gyros * self.per_gyro + self.runs + 2

    def gyro(self, gyro: int) -> slice:
        """Unknowns of a gyro."""
        return slice(gyro * self.per_gyro, (gyro + 1) * self.per_gyro)

    def vector(self, gyro: int) -> slice:
        """Its s."""
        return slice(gyro * self.per_gyro + 1, gyro * self.per_gyro + 4)

    def motion(self, run: int) -> list[int]:
        """Azimuth of a run, latitude, table rate."""
        first = self.gyros * self.per_gyro
        return [first + run, first + self.runs, first + self.runs + 1]


@dataclass(frozen=True)
class Prior:
    """Present record as a wide prior, and its turn-on biases [deg/h].

    `axes` is (n, 3), G; `bias_deg_h` (n,), B in deg/h by the present scale factor; `turn_on_deg_h` (n,).
    """

    axes: Array
    bias_deg_h: Array
    turn_on_deg_h: Array


@dataclass(frozen=True)
class Solution:
    """What a campaign says.

    Attributes
    ----------
    layout : Layout
    values : (p,) array
        See `Layout`.
    information : (p, p) array
        Of the data and of the stated uncertainties of motion, the wide prior not in it.
    covariance : (p, p) array
        With the wide prior.
    turn_on_deg_h : (n,) array
        Standard deviation of the turn-on bias.
    turn_on_log_std : (n,) array
        Standard deviation of its logarithm.
    chi2, freedom : float
        Of what is left, turn-on biases as random.
    change : (p,) array
        Values less those of the present record, as readings of the equations are.
    """

    layout: Layout
    values: Array
    information: Array
    covariance: Array
    turn_on_deg_h: Array
    turn_on_log_std: Array
    chi2: float
    freedom: float
    change: Array


def solve(
    products: Sequence[Product],
    gyros: int,
    runs: int,
    prior: Prior,
    shapes: tuple[str, ...] = (),
    turn_on: Array | None = None,
) -> Solution:
    """The solution of a campaign.

    Parameters
    ----------
    products : sequence of Product
    gyros, runs : int
    prior : Prior
    shapes : tuple of str
        Departures to be fitted as well, of `equations.SHAPES`; the same for every gyro.
    turn_on : (n,) array or None
        Turn-on biases to be taken as they are [deg/h]; None: found.
    """
    layout = Layout(gyros, runs, shapes)
    mean, precision = _wide_prior(layout, prior)
    values = mean.copy()
    for _ in range(_ROUNDS):
        stack = _Stack.of([of_unknowns(one, layout, values) for one in products], layout)
        if turn_on is None:
            scatter, log_std = _turn_on(stack, layout, precision, prior)
        else:
            scatter, log_std = turn_on, np.zeros(gyros)
        information, right, square, _ = stack.summed(scatter)
        covariance = np.linalg.inv(information + precision).astype(np.float64)
        change = covariance @ right
        values = mean + change
    chi2 = square - float(change @ right)
    freedom = float(sum(one.bins for one in products) - gyros * layout.per_gyro)
    no_wide = information + np.diag(_motion_precision(layout))
    return Solution(layout, values, no_wide, covariance, scatter, log_std, chi2, freedom, change)


@dataclass(frozen=True)
class Small:
    """A product in terms of a gyro's unknowns (first), those of motion, and the reading (last).

    Attributes
    ----------
    product : Product
    where : (k,) array of int
        Where its unknowns stand in the layout.
    gram : (k + 1, k + 1) array
    """

    product: Product
    where: NDArray[np.intp]
    gram: Array


def of_unknowns(one: Product, layout: Layout, values: Array) -> Small:
    """The columns of motion put together with the present s, out of `values` (p,) of all unknowns."""
    s = values[layout.vector(one.gyro)]
    width = layout.per_gyro + _SOURCES + 1
    to = np.zeros((len(one.gram), width))
    to[ONE, 0] = 1.0
    to[MOTION, 1:4] = np.eye(3)
    first = SHAPE.start
    for k, shape in enumerate(layout.shapes):
        to[first + SHAPES.index(shape), 4 + k] = 1.0
    for source in range(_SOURCES):
        to[DEPARTURE.start + 3 * source : DEPARTURE.start + 3 * source + 3, layout.per_gyro + source] = s
    to[READING, -1] = 1.0
    gyro = layout.gyro(one.gyro)
    where = np.array([*range(gyro.start, gyro.stop), *layout.motion(one.run)])
    return Small(one, where, to.T @ one.gram @ to)


@dataclass(frozen=True)
class _Stack:
    """All products one upon the other, so that they are summed at once: the turn-on biases are tried often.

    `gyro` (m,), `gram` (m, k + 1, k + 1), `place` (m, k): where their unknowns stand in the layout.
    """

    gyro: NDArray[np.intp]
    gram: Array
    place: NDArray[np.intp]
    log_det: float
    size: int

    @classmethod
    def of(cls, small: Sequence[Small], layout: Layout) -> _Stack:
        return cls(
            np.array([one.product.gyro for one in small]),
            np.array([one.gram for one in small]),
            np.array([one.where for one in small]),
            sum(one.product.log_det for one in small),
            layout.size,
        )

    def summed(self, turn_on: Array) -> tuple[Array, Array, float, float]:
        """Information, right-hand side, square of the readings and ln det of their covariance.

        `turn_on` (n,): turn-on bias of each gyro [deg/h].
        """
        variance = turn_on[self.gyro] ** 2
        ones = self.gram[:, 0]
        # A bias common to a run's readings: V + tau^2 1 1' by Sherman and Morrison.
        less = (variance / (1 + variance * ones[:, 0]))[:, None, None]
        gram = self.gram - less * ones[:, :, None] * ones[:, None, :]
        cells = (self.place[:, :, None] * self.size + self.place[:, None, :]).ravel()
        information = np.asarray(np.bincount(cells, gram[:, :-1, :-1].ravel(), self.size**2), np.float64)
        right = np.asarray(np.bincount(self.place.ravel(), gram[:, :-1, -1].ravel(), self.size), np.float64)
        log_det = self.log_det + float(np.sum(np.log1p(variance * ones[:, 0])))
        return information.reshape(self.size, self.size), right, float(np.sum(gram[:, -1, -1])), log_det


def _turn_on(stack: _Stack, layout: Layout, precision: Array, prior: Prior) -> tuple[Array, Array]:
    """Turn-on bias of each gyro, and the standard deviation of its logarithm.

    The root of the posterior mean of its square, so that covariances are those averaged over what it may be.
    """
    expected = np.log(np.maximum(prior.turn_on_deg_h, _LEAST_TURN_ON))
    width = np.log(_TURN_ON_FACTOR)

    def cost(log_turn_on: Array) -> float:
        information, right, square, log_det = stack.summed(np.exp(log_turn_on))
        total = information + precision
        _, log_det_total = np.linalg.slogdet(total)
        left = square - float(right @ np.linalg.solve(total, right))
        return 0.5 * (log_det + log_det_total + left + float(np.sum(((log_turn_on - expected) / width) ** 2)))

    at_first = cost(expected)
    found = minimize(
        lambda log_turn_on: cost(log_turn_on) - at_first,
        expected,
        method="L-BFGS-B",
        bounds=[(value - _WIDEST * width, value + _WIDEST * width) for value in expected],
        options={"maxiter": 60, "eps": 1e-4},
    )
    grid = np.linspace(-_SPREAD, _SPREAD, _POINTS)
    mean_square, log_std = np.empty(layout.gyros), np.empty(layout.gyros)
    for i in range(layout.gyros):
        tried = found.x + grid[:, None] * (np.arange(layout.gyros) == i)
        costs = np.array([cost(one) for one in tried])
        weight = np.exp(costs.min() - costs)
        weight /= weight.sum()
        mean_square[i] = weight @ np.exp(2 * tried[:, i])
        log_std[i] = np.sqrt(weight @ (tried[:, i] - weight @ tried[:, i]) ** 2)
    return np.sqrt(mean_square), log_std


def _wide_prior(layout: Layout, prior: Prior) -> tuple[Array, Array]:
    """Mean and precision: the present record, wide; the stated uncertainties of motion."""
    mean, precision = np.zeros(layout.size), np.diag(_motion_precision(layout))
    for i in range(layout.gyros):
        start, vector = layout.gyro(i).start, layout.vector(i)
        mean[start] = prior.bias_deg_h[i]
        mean[vector] = SECONDS_PER_HOUR * prior.axes[i]
        precision[start, start] = IGNORANCE_BIAS_DEG_H**-2
        along = np.outer(prior.axes[i], prior.axes[i])
        across = np.eye(3) - along
        precision[vector, vector] = along / (SECONDS_PER_HOUR * IGNORANCE_SCALE_REL) ** 2
        precision[vector, vector] += across / (SECONDS_PER_HOUR * IGNORANCE_AXIS_RAD) ** 2
        for k in range(4, layout.per_gyro):
            precision[start + k, start + k] = 1e-12  # no prior worth the name: it keeps the matrix regular
    return mean, precision


def _motion_precision(layout: Layout) -> Array:
    """Ones at azimuth, latitude and table rate: they are in units of their stated standard deviations."""
    ones = np.zeros(layout.size)
    ones[layout.gyros * layout.per_gyro :] = 1.0
    return ones
