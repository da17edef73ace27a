"""Noise of a gyro (IEEE 952 terms, capture contract): synthesis, spectral density and Allan deviation.

Angle random walk
    White noise of N deg/sqrt(h): N / 60 sqrt(rate) deg/s a sample.
Bias instability
    Flicker of B deg/h: one-sided density B^2 / (pi f) from 1e-5 Hz up.
Rate random walk
    K deg/h/sqrt(h): steps of K / 60 sqrt(dt) deg/h every dt seconds, from 0 at the run's start.

Quantization
    White noise of Q arcsec in the angle: differences of it in the rate.
Rate ramp
    R deg/h a hour; no noise, but an Allan deviation shows it.

Units: white noise [deg/s]; the others [deg/h], as their coefficients are. Flicker is synthesised
in `fogreduce.physics.flicker`.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.physics.special import cosine_integral

Array = NDArray[np.float64]

#: Flicker has no power below this frequency [Hz] (capture contract).
LOWEST_FLICKER_HZ = 1e-5

#: Samples that the streaming sources (`WalkSource`, `FlickerSource`) hand out at a time.
BLOCK = 12288


# ------------------------------------------------------------------------------------- white noise


def white_sigma(n_deg_sqrt_h: float | Array, sample_rate_hz: float) -> float | Array:
    """Standard deviation a sample [deg/s] of angle random walk N [deg/sqrt(h)]: ``N / 60 sqrt(rate)``."""
    return n_deg_sqrt_h / 60.0 * math.sqrt(sample_rate_hz)


def white_coefficient(sigma_deg_s: float | Array, sample_rate_hz: float) -> float | Array:
    """Angle random walk N [deg/sqrt(h)] of white noise [deg/s] a sample; inverse of `white_sigma`."""
    return sigma_deg_s * 60.0 / math.sqrt(sample_rate_hz)


def white_density(n_deg_sqrt_h: float) -> float:
    """One-sided density [(deg/s)^2/Hz], at all frequencies: ``2 (N / 60)^2``."""
    return 2.0 * (n_deg_sqrt_h / 60.0) ** 2


def white_allan(n_deg_sqrt_h: float, tau_s: Array) -> Array:
    """Allan deviation [deg/s] at averaging times `tau_s` [s]: ``N / (60 sqrt(tau))``."""
    return n_deg_sqrt_h / 60.0 / np.sqrt(tau_s)


# ------------------------------------------------------------------------------------- random walk


def walk_density(k_deg_h_sqrt_h: float | Array, frequency_hz: Array) -> Array:
    """One-sided density [(deg/h)^2/Hz] of a rate random walk: ``2 (K / 60)^2 / (2 pi f)^2``."""
    density: Array = 2.0 * (k_deg_h_sqrt_h / 60.0) ** 2 / (2.0 * np.pi * frequency_hz) ** 2
    return density


def walk_allan(k_deg_h_sqrt_h: float, tau_s: Array) -> Array:
    """Allan deviation [deg/h] of a rate random walk: ``K / 60 sqrt(tau / 3)``."""
    return k_deg_h_sqrt_h / 60.0 * np.sqrt(tau_s / 3.0)


class WalkSource:
    """A rate random walk of K = 1 deg/h/sqrt(h), block after block; the first sample is 0."""

    def __init__(self, sample_rate_hz: float, generator: np.random.Generator) -> None:
        self._step = 1.0 / (60.0 * math.sqrt(sample_rate_hz))
        self._generator = generator
        self._at: float | None = None

    def next_block(self) -> Array:
        """The next `BLOCK` samples [deg/h]."""
        walk = self._generator.standard_normal(BLOCK)
        walk *= self._step
        if self._at is None:
            walk[0] = 0.0
        else:
            walk[0] += self._at
        np.cumsum(walk, out=walk)
        self._at = float(walk[-1])
        return walk


# ------------------------------------------------------------------------------------------ flicker


def flicker_density(b_deg_h: float | Array, frequency_hz: Array) -> Array:
    """One-sided density [(deg/h)^2/Hz] of flicker as it is defined: ``B^2 / (pi f)``."""
    density: Array = b_deg_h**2 / (np.pi * frequency_hz)
    return density


def flicker_allan(b_deg_h: float) -> float:
    """The flat of flicker's Allan deviation [deg/h]: ``sqrt(2 ln 2 / pi) B``."""
    return math.sqrt(2.0 * math.log(2.0) / math.pi) * b_deg_h


def flicker_covariance(b_deg_h: float, step_s: float, lags: int) -> Array:
    """Covariance [(deg/h)^2] of flicker's means over neighbouring steps of `step_s`, at lags 0 to `lags` - 1.

    A density ``B^2 / (pi f)`` from f0 = 1e-5 Hz up has the autocovariance ``-B^2 / pi Ci(2 pi f0 tau)``; that
    of means is the second difference of its second integral. With x = 2 pi f0 tau that is, up to a constant,
    ``x^2 / 2 Ci(x) - x sin(x) / 2 - sin(x / 2)^2``.
    """
    x0 = 2.0 * math.pi * LOWEST_FLICKER_HZ * step_s
    x: Array = x0 * np.arange(1, lags + 1, dtype=np.float64)
    integral = np.zeros(lags + 2)  # at lags -1, 0, 1 ... lags; even, and 0 at 0
    integral[2:] = x**2 / 2.0 * cosine_integral(x) - x * np.sin(x) / 2.0 - np.sin(x / 2.0) ** 2
    integral[0] = integral[2]
    covariance: Array = -(b_deg_h**2) / math.pi / x0**2 * np.diff(integral, 2)
    return covariance


# ------------------------------------------------------------------------ quantization, rate ramp


def quantization_allan(q_arcsec: float, tau_s: Array) -> Array:
    """Allan deviation [deg/h] of quantization: ``sqrt(3) Q / tau`` (an arcsec a second is a deg/h)."""
    return math.sqrt(3.0) * q_arcsec / tau_s


def ramp_allan(r_deg_h2: float, tau_s: Array) -> Array:
    """Allan deviation [deg/h] of a rate ramp: ``R tau / sqrt(2)``."""
    return r_deg_h2 * tau_s / SECONDS_PER_HOUR / math.sqrt(2.0)
