"""Bias and scale factor against temperature, warm-up, and the windows in which a run is steadiest."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.noise import covariance
from fogreduce.calibrate.readings import Readings, residual_rates
from fogreduce.calibrate.shapes import Shape
from fogreduce.characterise.definitions import Definitions
from fogreduce.characterise.quantity import K95, Quantity, normal, undetermined
from fogreduce.constants import SECONDS_PER_HOUR

Array = NDArray[np.float64]

_SENSITIVITIES = {
    "bias_temperature": (
        "temperature_bias",
        "deg/h/degC",
        "a log of the sensors' temperature over degrees",
    ),
    "bias_electronics_temperature": (
        "electronics_bias",
        "deg/h/degC",
        "a log of the electronics over degrees",
    ),
    "bias_warming": ("warming_bias", "deg/h/(degC/min)", "a temperature log in which the rate changes"),
    "scale_factor_temperature": (
        *("temperature_scale_factor", "ppm/degC"),
        "a temperature log over some degrees while the table turns at some deg/s",
    ),
}
#: A sensitivity is stated where a change of 1 degC is known to so many of the turn-on biases or ppm.
_KNOWN = {"bias_temperature": 5.0, "bias_electronics_temperature": 5.0, "bias_warming": 20.0}
_PPM_KNOWN = 1e3
_LEAST_RUN_S = 600.0
_TIMES = 40  # of warm-up that are tried
_SIGNIFICANT = 16.0  # chi-square that an exponential must gain: of 40 tried, chance gains it in 1 of 100 runs
_LENGTHS = 24  # of windows


def temperature_quantities(
    found: Derivation, gyro: int, shapes: list[Shape], choices: Definitions
) -> list[Quantity]:
    """Of a gyro."""
    of = f"gyro{gyro + 1}"
    fitted = {one.name: one for one in shapes if one.gyro == gyro}
    quantities = []
    for name, (shape, unit, needs) in _SENSITIVITIES.items():
        item = fitted.get(shape)
        if item is not None and item.std < _KNOWN.get(name, _PPM_KNOWN):
            quantities.append(normal(name, of, unit, item.value, item.std))
        else:
            quantities.append(undetermined(name, of, unit, needs))
    return [*quantities, _warm_up(found, gyro, of, choices)]


@dataclass(frozen=True)
class WarmUp:
    """An exponential in a run: amplitude [deg/h] at its start, time constant [s], covariance of both."""

    amplitude: float
    time_s: float
    covariance: Array
    gain: float


def warm_up_of(one: Readings, noise: Array, values: Array) -> WarmUp | None:
    """The exponential that describes a gyro's residual best, ``c + A exp(-t / tau)``; or None.

    Parameters
    ----------
    one : Readings
    noise : (m, m) array
        Covariance of the values.
    values : (m,) array
        Residual rates [deg/h] of the bins that are there.
    """
    time_s = one.time_s[: values.size]
    lower = np.linalg.cholesky(noise)
    target = np.linalg.solve(lower, values)
    ones = np.linalg.solve(lower, np.ones(values.size))
    base = target - ones * (ones @ target) / (ones @ ones)
    best, least = None, float(base @ base)
    start = least
    for tau in np.geomspace(5 * one.bin_s, 0.5 * time_s[-1], _TIMES).tolist():
        columns = np.column_stack((ones, np.linalg.solve(lower, np.exp(-time_s / tau))))
        solved, *_ = np.linalg.lstsq(columns, target, rcond=None)
        left = target - columns @ solved
        if float(left @ left) < least:
            least, best = float(left @ left), (float(solved[1]), tau)
    if best is None:
        return None
    amplitude, tau = best
    fall = np.exp(-time_s / tau)
    jacobian = np.column_stack(
        (ones, np.linalg.solve(lower, fall), np.linalg.solve(lower, amplitude * fall * time_s / tau))
    )
    both = np.linalg.pinv(jacobian.T @ jacobian)[1:, 1:]
    return WarmUp(amplitude, tau, both, start - least)


def _warm_up(found: Derivation, gyro: int, of: str, choices: Definitions) -> Quantity:
    """Time until the bias stays within the band about its end value: ``tau ln(|A| / band)``."""
    band = choices.warm_up_band_deg_h
    longest = max(found.readings, key=lambda one: float(one.time_s[-1] - one.time_s[0]))
    if float(longest.time_s[-1]) < _LEAST_RUN_S:
        needs = f"a run from power-on of {_LEAST_RUN_S:g} s and more"
        return undetermined("warm_up", of, "s", needs)
    there = np.isfinite(longest.raw[gyro])
    values = residual_rates(longest)[gyro, there]
    fitted = warm_up_of(longest, covariance(longest, gyro, found.noise[gyro]), values)
    note = f"run {longest.facts.run_id}, band ±{band:g} deg/h; within it from the start where 0"
    if fitted is None or fitted.gain < _SIGNIFICANT:
        hidden = math.inf if fitted is None else K95 * math.sqrt(float(fitted.covariance[0, 0]))
        if hidden > band:
            return undetermined("warm_up", of, "s", f"a band of {hidden:.2g} deg/h or more: noise hides less")
        return Quantity("warm_up", of, "s", 0.0, 0.0, 0.0, note=note)
    ratio = abs(fitted.amplitude) / band
    if fitted.time_s > 0.45 * float(longest.time_s[-1]):
        return undetermined("warm_up", of, "s", "a longer run: the bias has not come to rest")
    if ratio <= 1:
        return Quantity("warm_up", of, "s", 0.0, 0.0, 0.0, note=note)
    slope = np.array([fitted.time_s / fitted.amplitude, fitted.time_s * math.log(ratio)])
    std = math.sqrt(float(slope @ fitted.covariance @ slope))
    value = fitted.time_s * math.log(ratio)
    return Quantity("warm_up", of, "s", value, max(0.0, value - K95 * std), value + K95 * std, note=note)


@dataclass(frozen=True)
class Windows:
    """Drift of a rate over windows of a run.

    Attributes
    ----------
    start_s, length_s : (a,), (b,) arrays
    drift_deg_h_per_h : (b, a) array
        Slope of the straight line through the residual rate within each window [deg/h/h]; NaN beyond the run.
    error : (b,) array
        Of white noise, by length.
    steadiest : (float, float)
        Start and length [s] of the longest window whose slope is within two of its errors of 0.
    """

    start_s: Array
    length_s: Array
    drift_deg_h_per_h: Array
    error: Array
    steadiest: tuple[float, float] | None


def steady_windows(one: Readings, values: Array, white_deg_sqrt_h: float) -> Windows:
    """The slope of a gyro's residual rate [deg/h] against start and length of the window."""
    there = np.isfinite(values)
    time_s, rate = one.time_s[there], values[there]
    whole = float(time_s[-1] - time_s[0])
    length = np.linspace(whole / _LENGTHS, whole, _LENGTHS)
    start = time_s[0] + np.arange(_LENGTHS) * whole / _LENGTHS
    slope = np.full((_LENGTHS, _LENGTHS), np.nan)
    for b, size in enumerate(length):
        for a, begin in enumerate(start):
            inside = (time_s >= begin) & (time_s <= begin + size * 1.000001)
            if begin + size > time_s[-1] + one.bin_s or inside.sum() < 4:
                continue
            t = (time_s[inside] - time_s[inside].mean()) / SECONDS_PER_HOUR
            slope[b, a] = t @ rate[inside] / (t @ t)
    hours = length / SECONDS_PER_HOUR
    error = white_deg_sqrt_h * math.sqrt(12) / hours**1.5
    steady = np.argwhere(np.abs(slope) < 2 * error[:, None])
    best = max(steady.tolist(), default=None)
    found = None if best is None else (float(start[best[1]]), float(length[best[0]]))
    return Windows(start, length, slope, error, found)
