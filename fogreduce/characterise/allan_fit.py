"""Noise coefficients Q, N, B, K, R (IEEE 952) from an Allan variance, in one generalised least-squares fit.

Allan variances at neighbouring averaging times rest on the same samples: the fit weights them by their whole
covariance, computed from the noise itself (`allan_covariance`) and so iterated. What is fitted are the
coefficients' squares, in which the variance is linear. They are left free to come out negative: a square of
no more than its uncertainty says that the record does not show that noise, and a fit that is kept from saying
so is biased in the other coefficients too.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.characterise.allan_covariance import TERMS, covariance
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.physics.noise import (
    flicker_allan,
    quantization_allan,
    ramp_allan,
    walk_allan,
    white_allan,
)

Array = NDArray[np.float64]

_ROUNDS = 8
_SETTLED = 1e-4  # change of the model's variances that ends the rounds
_ONE_SIDED_95 = 1.6448536269514722
_SIGNIFICANT = 2.0  # standard deviations of its square that a coefficient must differ from 0 by


@dataclass(frozen=True)
class Term:
    """One kind of noise: symbol, name, unit, and the Allan deviation [deg/h] of a coefficient of 1."""

    symbol: str
    name: str
    unit: str
    deviation: Callable[[Array], Array]


#: The same order as `allan_covariance.TERMS`.
NOISES = (
    Term("Q", "quantization", "arcsec", lambda tau_s: quantization_allan(1.0, tau_s)),
    Term("N", "angle random walk", "deg/sqrt(h)", lambda tau_s: SECONDS_PER_HOUR * white_allan(1.0, tau_s)),
    Term("B", "bias instability", "deg/h", lambda tau_s: np.full_like(tau_s, flicker_allan(1.0))),
    Term("K", "rate random walk", "deg/h/sqrt(h)", lambda tau_s: walk_allan(1.0, tau_s)),
    Term("R", "rate ramp", "deg/h^2", lambda tau_s: ramp_allan(1.0, tau_s)),
)
assert len(NOISES) == len(TERMS)


@dataclass(frozen=True)
class Coefficient:
    """A noise coefficient.

    Attributes
    ----------
    square, square_error : float
        As fitted, with one standard deviation, in the square of the unit; it may be negative.
    """

    noise: Term
    square: float
    square_error: float

    @property
    def value(self) -> float:
        """The coefficient; NaN where its square is not positive."""
        return math.sqrt(self.square) if self.square > 0 else math.nan

    @property
    def error(self) -> float:
        """One standard deviation of it, noise only."""
        return self.square_error / (2.0 * self.value)

    @property
    def upper_95(self) -> float:
        """What it does not exceed, with a probability of 95 %."""
        return math.sqrt(max(0.0, self.square) + _ONE_SIDED_95 * self.square_error)

    @property
    def significant(self) -> bool:
        """Whether the record shows it: its square differs from 0 by two standard deviations."""
        return self.square > _SIGNIFICANT * self.square_error


def fit_noise_terms(
    factors: tuple[int, ...],
    interval_s: float,
    size: int,
    variance: Array,
    scale: Array,
    terms: str = "QNBKR",
) -> list[Coefficient]:
    """Fit the coefficients.

    Parameters
    ----------
    factors : tuple of int
        Averaging times in intervals, k of them; more than there are terms.
    interval_s : float
        The interval [s].
    size : int
        Number of intervals of the series.
    variance : (k,) array
        Overlapping Allan variance [(deg/h)^2].
    scale : (k,) array
        By how much an Allan variance scatters more than that of a series without gaps (1 = as much).
    terms : str
        Symbols of those that are fitted.

    Returns
    -------
    list of Coefficient
        In the order of `NOISES`. Uncertainties are those of the noise found, in this record.
    """
    from scipy.optimize import nnls

    chosen = [k for k, noise in enumerate(NOISES) if noise.symbol in terms]
    tau_s = np.array(factors, float) * interval_s
    columns = np.array([NOISES[k].deviation(tau_s) ** 2 for k in chosen]).T
    at_one = np.array([NOISES[k].deviation(np.array([interval_s]))[0] ** 2 for k in chosen])
    # A start: relative errors by the number of means.
    weight = np.sqrt(size / np.array(factors)) / np.maximum(variance, 1e-12 * variance.max())
    units = columns.max(axis=0)
    model = nnls(columns / units * weight[:, None], variance * weight)[0] / units
    for _ in range(_ROUNDS):
        found = np.zeros(len(NOISES))
        found[chosen] = model * at_one
        matrix = covariance(factors, size, found) * np.outer(scale, scale)
        spread = np.sqrt(np.diag(matrix))
        lower = np.linalg.cholesky(matrix / np.outer(spread, spread) + 1e-9 * np.eye(len(factors)))
        white = np.linalg.solve(lower, columns / spread[:, None])
        target = np.linalg.solve(lower, variance / spread)
        units = np.sqrt((white**2).sum(axis=0))
        before, model = columns @ model, nnls(white / units, target)[0] / units
        if np.max(np.abs(columns @ model / before - 1.0)) < _SETTLED:
            break
    inverse = np.linalg.inv((white / units).T @ (white / units))
    squares = inverse @ ((white / units).T @ target) / units
    errors = np.sqrt(np.diag(inverse)) / units
    return [
        Coefficient(NOISES[k], float(square), float(error))
        for k, square, error in zip(chosen, squares, errors, strict=True)
    ]


def model_variance(coefficients: list[Coefficient], tau_s: Array) -> Array:
    """Allan variance [(deg/h)^2] of the coefficients at `tau_s` (k,), negative squares taken as they are."""
    found = np.zeros_like(tau_s)
    for one in coefficients:
        found += one.square * one.noise.deviation(tau_s) ** 2
    return found
