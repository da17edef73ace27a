"""The noise of a gyro within a run, as a covariance of its bins; what is not stated comes from the readings.

White noise is always measured, a record's own figure being from another day: from the differences of
neighbouring samples, or of bins where these differ by more than white noise would. Flicker and random walk,
which a campaign of short runs hardly shows, are the record's where it states them, else those of the Allan
variance of the residuals of all runs together.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import toeplitz

from fogreduce.calibrate.readings import Readings
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.estimate.coloured import allan_variance, fit_noise
from fogreduce.physics.noise import flicker_covariance

Array = NDArray[np.float64]

#: Fewer differences of neighbouring bins do not tell white noise.
_FEWEST_DIFFERENCES = 8
#: By so much flicker may raise the differences of bins of a second [relative].
_FLICKER_IN_BINS = 0.1


@dataclass(frozen=True)
class GyroNoise:
    """Noise of a gyro, IEEE 952 terms.

    Attributes
    ----------
    white_deg_sqrt_h, flicker_deg_h, walk_deg_h_sqrt_h : float
        Angle random walk, bias instability, rate random walk.
    stated : bool
        Whether flicker and walk are those of the calibration record.
    """

    white_deg_sqrt_h: float
    flicker_deg_h: float
    walk_deg_h_sqrt_h: float
    stated: bool


def gyro_noise(readings: Sequence[Readings], gyro: int) -> GyroNoise:
    """Noise of one gyro from all runs and the calibration record."""
    squares = differences = 0.0
    allan = []
    for one in readings:
        left = _residual_deg_h(one, gyro)
        steps = steps_between(one, left)
        squares += float(np.sum(steps**2)) * one.bin_s / 2
        differences += steps.size
        allan.append((allan_variance(_with_holes(one, left), one.bin_s), one.bin_s))
    # deg/h of bins of a second are deg/sqrt(h) over 60.
    of_bins = np.sqrt(squares / differences) / 60 if differences >= _FEWEST_DIFFERENCES else 0.0
    white = _of_samples(readings, gyro, of_bins, differences)
    noise = readings[0].record.noise
    if noise is not None and noise.bias_instability_deg_h is not None:
        walks = noise.rate_random_walk_deg_h_sqrt_h
        walk = 0.0 if walks is None else walks[gyro]
        return GyroNoise(float(white), noise.bias_instability_deg_h[gyro], walk, stated=True)
    tau, variance, freedom = (np.concatenate(parts) for parts in zip(*(a for a, _ in allan), strict=True))
    if tau.size == 0:
        return GyroNoise(float(white), 0.0, 0.0, stated=False)
    found = fit_noise(tau, variance, freedom)
    walk_deg_h_sqrt_h = float(np.sqrt(found.walk * SECONDS_PER_HOUR))
    return GyroNoise(float(white), float(np.sqrt(found.flicker)), walk_deg_h_sqrt_h, stated=False)


def steps_between(one: Readings, values: Array) -> Array:
    """Differences of values (m,) in neighbouring bins of a segment, as far as both are there."""
    next_to = (np.diff(one.place) == 1) & (np.diff(one.segment) == 0)
    steps = np.diff(values)
    return steps[next_to & np.isfinite(steps)]


def _of_samples(readings: Sequence[Readings], gyro: int, of_bins: float, differences: float) -> float:
    """White noise from sample to sample, which is better known, where bins agree that it is white.

    Noise of another kind shows where the two differ: then it is that of the bins, from which the solution is.
    """
    variance = steps = 0.0
    for one in readings:
        deg_h = SECONDS_PER_HOUR / one.facts.scale_factor[gyro]
        variance += one.step_square[gyro] * deg_h**2 / 2 / one.facts.sample_rate_hz
        steps += one.steps[gyro]
    if steps == 0 or of_bins == 0:
        return of_bins
    of_samples = float(np.sqrt(variance / steps)) / 60
    # The standard error of a white noise from m differences is sqrt(3 / m) / 2 of it.
    allowed = _FLICKER_IN_BINS + 4 * np.sqrt(3 / differences) / 2
    return of_samples if abs(of_bins / of_samples - 1) <= allowed else of_bins


def covariance(one: Readings, gyro: int, noise: GyroNoise) -> Array:
    """Covariance of a gyro's bins in a run by its noise [(deg/h)^2]; bins without a reading left out."""
    there = np.isfinite(one.raw[gyro])
    first = int(one.place[there][0])
    place = one.place[there] - first
    lags = int(place[-1]) + 1
    matrix = np.zeros((place.size, place.size))
    if noise.flicker_deg_h > 0:
        rows = toeplitz(flicker_covariance(noise.flicker_deg_h, one.bin_s, lags))
        matrix += rows[np.ix_(place, place)]
    if noise.walk_deg_h_sqrt_h > 0:
        since_s = (first + place + 0.5) * one.bin_s
        walked = noise.walk_deg_h_sqrt_h**2 * np.minimum.outer(since_s, since_s) / SECONDS_PER_HOUR
        matrix += walked - np.eye(place.size) * noise.walk_deg_h_sqrt_h**2 * one.bin_s / 6 / SECONDS_PER_HOUR
    full = one.facts.sample_rate_hz * one.bin_s
    white = (60 * noise.white_deg_sqrt_h) ** 2 / one.bin_s * full / np.maximum(one.count[gyro, there], 1)
    matrix[np.diag_indices_from(matrix)] += white
    return matrix


def _residual_deg_h(one: Readings, gyro: int) -> Array:
    """Reading less what the present record makes of the motion, less its mean in each segment [deg/h]."""
    facts = one.facts
    rate = (one.raw[gyro] - facts.bias[gyro]) / facts.scale_factor[gyro] - facts.axes[gyro] @ one.motion
    left = rate * SECONDS_PER_HOUR
    for k in np.unique(one.segment):
        inside = one.segment == k
        if np.isfinite(left[inside]).any():
            left[inside] -= np.nanmean(left[inside])
    return left


def _with_holes(one: Readings, values: Array) -> Array:
    """The bins at their places, NaN where there is none."""
    out = np.full(int(one.place[-1] - one.place[0]) + 1, np.nan)
    out[one.place - one.place[0]] = values
    return out
