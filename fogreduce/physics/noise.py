"""Noise of a gyro (IEEE 952 terms, capture contract): synthesis, spectral density and Allan deviation.

Angle random walk
    White noise of N deg/sqrt(h): N / 60 sqrt(rate) deg/s a sample.
Bias instability
    Flicker of B deg/h: one-sided density B^2 / (pi f) from 1e-5 Hz up.
Rate random walk
    K deg/h/sqrt(h): steps of K / 60 sqrt(dt) deg/h every dt seconds, from 0 at the run's start.

Synthesis works on blocks of any length of record with a carried state, so that memory stays flat. Units:
white noise [deg/s]; flicker and random walk [deg/h], as their coefficients are.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Flicker has no power below this frequency [Hz] (capture contract).
LOWEST_FLICKER_HZ = 1e-5

#: Samples that the sources hand out at a time: a transform less the length of the flicker filter.
TRANSFORM = 16384
TAPS = 4097
BLOCK = TRANSFORM - (TAPS - 1)

_STRIDE = 32  # samples between points of the slow part of flicker
_SPLIT = 1.6e-3  # where flicker's slow and fast parts meet, as a fraction of the sample rate
_SPACING = 3.0  # ratio of neighbouring corner frequencies in the slow part


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


def walk_density(k_deg_h_sqrt_h: float, frequency_hz: Array) -> Array:
    """One-sided density [(deg/h)^2/Hz] of a rate random walk: ``2 (K / 60)^2 / (2 pi f)^2``."""
    return 2.0 * (k_deg_h_sqrt_h / 60.0) ** 2 / (2.0 * np.pi * frequency_hz) ** 2


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


def flicker_density(b_deg_h: float, frequency_hz: Array) -> Array:
    """One-sided density [(deg/h)^2/Hz] of flicker as it is defined: ``B^2 / (pi f)``."""
    return b_deg_h**2 / (np.pi * frequency_hz)


def flicker_allan(b_deg_h: float) -> float:
    """The flat of flicker's Allan deviation [deg/h]: ``sqrt(2 ln 2 / pi) B``."""
    return math.sqrt(2.0 * math.log(2.0) / math.pi) * b_deg_h


def lorentz_share(frequency_hz: Array, lowest_hz: float) -> Array:
    """Share of the density 1/f that first-order processes with corners from `lowest_hz` up make: from 0 to 1.

    A first-order process of corner g and variance v has the density ``v (2 / pi) g / (g^2 + f^2)``. With a
    variance of dg/g in each dg, all those from `lowest_hz` up sum to ``(2 / pi) atan(f / lowest_hz) / f``.
    """
    return 2.0 / np.pi * np.arctan(frequency_hz / lowest_hz)


def slow_corners_hz(sample_rate_hz: float) -> Array:
    """Corner frequencies of the first-order processes that make the slow part of flicker.

    Equally spaced in log f, each in the middle of its cell, the cells filling 1e-5 Hz to the split. In place
    of a continuum of corners, a spacing of three makes a ripple of 4 exp(-pi^2 / ln 3) = 0.05 %.
    """
    split = _split_hz(sample_rate_hz)
    octaves = math.log(split / LOWEST_FLICKER_HZ)
    cells = math.ceil(octaves / math.log(_SPACING))
    return LOWEST_FLICKER_HZ * np.exp(octaves * (np.arange(cells) + 0.5) / max(cells, 1))


def _split_hz(sample_rate_hz: float) -> float:
    return max(_SPLIT * sample_rate_hz, LOWEST_FLICKER_HZ)


class FlickerSource:
    """Flicker of B = 1 deg/h, block after block, for as long as one asks, in flat memory.

    The density ``1 / (pi f)`` is split in two at 1.6e-3 of the sample rate.

    - Slow: a sum of stationary first-order processes (`slow_corners_hz`), drawn exactly on every 32nd sample
      and joined by straight lines.
    - Fast: white noise through a symmetric filter of 4097 taps (overlap-save), whose gain is the root of
      what the slow part leaves of the density, joining lines included.

    Nothing is left of the run before: the start is a draw from the stationary process. Density: within 1 % of
    the definition from 1e-3 Hz up; the cut at 1e-5 Hz is rounded as ``(2 / pi) atan(f / 1e-5 Hz)``, the total
    power below any frequency far above it being that of a sharp one.
    """

    def __init__(self, sample_rate_hz: float, generator: np.random.Generator) -> None:
        self._generator = generator
        self._response = _fast_response(sample_rate_hz)
        corners = slow_corners_hz(sample_rate_hz)
        self._sigma = math.sqrt(_slow_variance(sample_rate_hz))
        points = BLOCK // _STRIDE
        decay = 2.0 * np.pi * corners * _STRIDE / sample_rate_hz
        self._kept = np.exp(-np.outer(decay, np.arange(1, points + 1)))
        self._kick = np.sqrt(-np.expm1(-2.0 * decay))[:, None] / self._kept
        self._slow = generator.standard_normal(len(corners))
        self._noise = np.empty(TRANSFORM)
        generator.standard_normal(out=self._noise[: TAPS - 1])

    def next_block(self) -> Array:
        """The next `BLOCK` samples [deg/h]."""
        self._generator.standard_normal(out=self._noise[TAPS - 1 :])
        spectrum = np.fft.rfft(self._noise)
        spectrum *= self._response
        fast: Array = np.fft.irfft(spectrum, TRANSFORM)[TAPS - 1 :]
        self._noise[: TAPS - 1] = self._noise[BLOCK:]
        if len(self._slow):
            fast += self._slow_block()
        return fast

    def _slow_block(self) -> Array:
        """x[j] = a x[j - 1] + sqrt(1 - a^2) w[j], as a^j (x[0] + sum of kicks / a^i), then straight lines."""
        paths = self._generator.standard_normal(self._kept.shape)
        paths *= self._kick
        np.cumsum(paths, axis=1, out=paths)
        paths += self._slow[:, None]
        paths *= self._kept
        ends = np.concatenate(([self._slow.sum()], paths.sum(axis=0)))
        ends *= self._sigma
        self._slow = paths[:, -1].copy()
        between = np.arange(_STRIDE) / _STRIDE
        lines = np.multiply.outer(np.diff(ends), between)
        lines += ends[:-1, None]
        return lines.ravel()


def flicker_covariance(b_deg_h: float, step_s: float, lags: int) -> Array:
    """Covariance [(deg/h)^2] of flicker's means over neighbouring steps of `step_s`, at lags 0 to `lags` - 1.

    The sum over first-order processes (`slow_corners_hz`) with corners from 1e-5 Hz to far above 1 / step.
    With x = 2 pi corner step, the mean over a step has the variance ``2 (x - 1 + exp(-x)) / x^2``, and two of
    them k steps apart the covariance ``exp(-x (k - 1)) ((1 - exp(-x)) / x)^2``.
    """
    rate_hz = 1e5 / step_s
    x = 2.0 * np.pi * slow_corners_hz(rate_hz)[:, None] * step_s
    k = np.arange(lags)
    mean = -np.expm1(-x) / x
    terms = np.exp(-x * np.maximum(k - 1, 0)) * mean**2
    # at lag 0, as a difference that does not lose its digits for small x
    terms[:, :1] = np.where(x > 1e-4, 2.0 * (x + np.expm1(-x)) / x**2, 1.0 - x / 3.0)
    total: Array = b_deg_h**2 * _slow_variance(rate_hz) * terms.sum(axis=0)
    return total


def _slow_densities(frequency_hz: Array, sample_rate_hz: float) -> tuple[Array, Array]:
    """One-sided densities [1/Hz] of the slow part for B = 1 deg/h: as continuous processes, and as made.

    A process known on a grid of step T and joined by straight lines drawn at each of m samples a step has the
    density of the grid's sequence, which repeats every 1/T, times ``(D(f) / m)^4``, D(f) being the Dirichlet
    kernel ``sin(pi f T) / sin(pi f T / m)`` (a triangle is two boxes of m samples).
    """
    step = _STRIDE / sample_rate_hz
    square = np.sin(np.pi * frequency_hz * step) ** 2
    continuous, grid = np.zeros_like(frequency_hz), np.zeros_like(frequency_hz)
    for corner in slow_corners_hz(sample_rate_hz):
        continuous += 2.0 / np.pi * corner / (corner**2 + frequency_hz**2)
        a = math.exp(-2.0 * math.pi * corner * step)
        grid += 2.0 * step * (1.0 - a) * (1.0 + a) / ((1.0 - a) ** 2 + 4.0 * a * square)
    box = np.sinc(frequency_hz * step) / np.sinc(frequency_hz * step / _STRIDE)
    variance = _slow_variance(sample_rate_hz)
    return variance * continuous, variance * grid * box**4


def _slow_variance(sample_rate_hz: float) -> float:
    """Variance [(deg/h)^2] of each slow process for B = 1 deg/h: its cell's share of ln f, over pi."""
    cells = max(len(slow_corners_hz(sample_rate_hz)), 1)
    return math.log(_split_hz(sample_rate_hz) / LOWEST_FLICKER_HZ) / cells / math.pi


@cache
def _fast_response(sample_rate_hz: float) -> NDArray[np.complex128]:
    """Transform of the fast part's filter, ready for overlap-save, for B = 1 deg/h."""
    fine = 16 * TRANSFORM
    frequency = np.linspace(0.0, sample_rate_hz / 2.0, fine // 2 + 1)
    frequency[0] = frequency[1] * 1e-3  # the density's limit at 0 is finite
    fast = lorentz_share(frequency, _split_hz(sample_rate_hz)) / (np.pi * frequency)
    slow, joined = _slow_densities(frequency, sample_rate_hz)
    left = np.maximum(fast + (slow - joined), 0.0)
    # White noise of variance 1 has the one-sided density 2 / rate.
    taps = np.fft.irfft(np.sqrt(left * sample_rate_hz / 2.0), fine)
    half = TAPS // 2
    return np.fft.rfft(np.concatenate((taps[-half:], taps[: half + 1])), TRANSFORM)


def flicker_density_made(sample_rate_hz: float, frequency_hz: Array) -> Array:
    """One-sided density [(deg/h)^2/Hz] that `FlickerSource` has by construction, for B = 1 deg/h."""
    taps = np.fft.irfft(_fast_response(sample_rate_hz), TRANSFORM)[:TAPS]
    half = TAPS // 2
    turn = 2.0 * np.pi * frequency_hz / sample_rate_hz
    gain = taps[half] + 2.0 * np.cos(np.outer(turn, np.arange(1, half + 1))) @ taps[half + 1 :]
    density: Array = gain**2 * 2.0 / sample_rate_hz + _slow_densities(frequency_hz, sample_rate_hz)[1]
    return density
