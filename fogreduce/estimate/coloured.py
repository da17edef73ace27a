"""Coloured noise (IEEE 952: white noise, flicker, random walk): Allan variance, and what it moves.

The covariance of a least-squares curve, or of any other linear function of a run's bins, under that noise.
It includes noise only, not the stated uncertainties of calibration and site.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.allan_variance import Series, overlapping
from fogreduce.physics.noise import flicker_allan, flicker_covariance

Array = NDArray[np.float64]

#: Allan variance of flicker of bias instability 1, whatever the averaging time.
FLICKER_FLAT = flicker_allan(1.0) ** 2
_LONGEST_PART = 8  # averaging times go up to this part of the record
_ROUNDS = 4
_ROUNDING = 1e-20
_ALIKE = 1e-12  # determinant below which columns cannot be told apart


@dataclass(frozen=True)
class ColouredNoise:
    """Variance coefficients, in the data's unit: white [unit^2 s], flicker B^2 [unit^2], walk [unit^2/s]."""

    white: float
    flicker: float
    walk: float

    def allan_variance(self, tau_s: Array) -> Array:
        """Allan variance at averaging times [s]."""
        white, flicker, walk = unit_allan_variances(tau_s)
        return self.white * white + self.flicker * flicker + self.walk * walk


def unit_allan_variances(tau_s: Array) -> Array:
    """(3, k): of white noise, flicker and walk whose coefficients are 1, at averaging times (k,) [s]."""
    return np.array([1 / tau_s, np.full_like(tau_s, FLICKER_FLAT), tau_s / 3])


def allan_variance(values: Array, period_s: float) -> tuple[Array, Array, Array]:
    """Overlapping Allan variance at octaves; gaps (NaN) do not bias it.

    Parameters
    ----------
    values : (m,) array
        Means over consecutive periods; NaN = none.
    period_s : float

    Returns
    -------
    tau_s, variance, freedom : (j,) arrays
        Averaging times [s], Allan variance, and a conservative number of degrees of freedom.
    """
    series, found, factor = Series(values), [], 1
    while factor <= max(1, values.size // _LONGEST_PART) and 2 * factor < values.size:
        one = overlapping(series, factor)
        if one.variance >= 0:
            found.append((factor * period_s, one.variance, max(1.0, one.windows / factor)))
        factor *= 2
    tau, variance, freedom = np.array(found).reshape(-1, 3).T
    return tau, variance, freedom


def fit_noise(tau_s: Array, variance: Array, freedom: Array) -> ColouredNoise:
    """White, flicker and walk that describe an Allan variance: weighted least squares, none negative."""
    columns = unit_allan_variances(tau_s).T
    # Below this part of the largest, a variance is rounding: it must not outweigh the others.
    floor = _ROUNDING * float(variance.max(initial=0.0))
    if floor == 0:
        return ColouredNoise(0.0, 0.0, 0.0)
    model = np.maximum(variance, floor)
    best = np.zeros(3)
    for _ in range(_ROUNDS):
        weight = np.sqrt(freedom) / model
        best = _not_negative(columns * weight[:, None], variance * weight)
        model = np.maximum(columns @ best, np.maximum(1e-3 * variance, floor))
    return ColouredNoise(*(float(value) for value in best))


def _not_negative(columns: Array, target: Array) -> Array:
    """Least squares with no negative coefficient, by trying every set of the three columns."""
    scale = np.sqrt((columns**2).sum(axis=0))
    unit = columns / scale
    products, aims = unit.T @ unit, unit.T @ target
    best, gained = np.zeros(columns.shape[1]), 0.0
    for size in range(1, columns.shape[1] + 1):
        for chosen in map(list, itertools.combinations(range(columns.shape[1]), size)):
            square = products[np.ix_(chosen, chosen)]
            if size > 1 and np.linalg.det(square) < _ALIKE:
                continue
            part = np.linalg.solve(square, aims[chosen])
            gain = float(part @ aims[chosen])
            if (part >= 0).all() and gain > gained * (1 + 1e-9):
                best, gained = np.zeros(columns.shape[1]), gain
                best[chosen] = part / scale[chosen]
    return best


def unit_forms(rows: Array, period_s: float) -> Array:
    """Covariance of linear functions of consecutive bins under unit noise of each kind.

    Parameters
    ----------
    rows : (k, m) array
        Each function's weight of each bin.
    period_s : float
        From bin to bin [s].

    Returns
    -------
    (3, k, k) array
        For white noise, flicker and a walk (from 0 at the first bin) whose coefficient is 1; `combined` adds
        them up for a `ColouredNoise`.
    """
    later = np.cumsum(rows[:, ::-1], axis=1)
    return np.array(
        [
            rows @ rows.T / period_s,
            _stationary_form(rows, flicker_covariance(1.0, period_s, rows.shape[1])),
            period_s * (later @ later.T),
        ]
    )


def combined(forms: Array, noise: ColouredNoise) -> Array:
    """Covariance under a noise: the unit forms (3, ...) times its coefficients."""
    covariance: Array = noise.white * forms[0] + noise.flicker * forms[1] + noise.walk * forms[2]
    return covariance


def correlated_covariance(rows: Array, variance: float, time_s: float, period_s: float) -> Array:
    """Covariance of linear functions of consecutive bins under an error that stays like itself for a time.

    Parameters
    ----------
    rows : (k, m) array
        Each function's weight of each bin.
    variance : float
        Of the error.
    time_s : float
        Its correlation time: its autocovariance is ``variance exp(-lag / time_s)``.
    period_s : float
        From bin to bin.
    """
    lag = np.arange(rows.shape[1]) * period_s
    return variance * _stationary_form(rows, np.exp(-lag / time_s))


def _stationary_form(columns: Array, covariance: Array) -> Array:
    """``Z C Z'`` for the autocovariance at lags of 0, 1, 2, ... bins."""
    m = columns.shape[1]
    size = 2 * m
    circle = np.fft.rfft(np.concatenate((covariance, [0.0], covariance[:0:-1])))
    spread = np.fft.irfft(np.fft.rfft(columns, size) * circle, size)[:, :m]
    return columns @ spread.T
