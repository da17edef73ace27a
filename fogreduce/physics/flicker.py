"""Synthesis of flicker noise (bias instability) at any sample rate, for as long as one asks, in flat memory.

The density ``1 / (pi f)`` (for B = 1 deg/h) begins at 1e-5 Hz, ages below the sample rate, so that no single
filter can make it. It is the sum of three independent parts, which meet where first-order processes, whose
share of 1/f is ``(2 / pi) atan(f / corner)``, take over:

bottom
    white noise, a sample every 50 s or so, through a long filter: all that the other parts leave, with the
    cut at 1e-5 Hz; joined by straight lines;
middle
    a sum of stationary first-order processes with corners a factor of three apart, drawn exactly on every
    32nd sample (4th, at low rates) and joined by straight lines;
fast
    white noise at the sample rate through a filter: what the middle leaves up to half the sample rate, its
    straight lines made up for.

Filters are symmetric, of finite length, and applied to whole blocks (overlap-save). The start is a draw from
the stationary process: nothing builds up. What comes out has the density defined within 1.5 % from 3e-5 Hz to
half the sample rate (`density_made`, tested), and less than 5 % of it below 5e-6 Hz.
"""

from __future__ import annotations

import math
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fogreduce.physics.noise import BLOCK, LOWEST_FLICKER_HZ

Array = NDArray[np.float64]
Spectrum = NDArray[np.complex128]

_FAST_TAPS = 4097
_FAST_TRANSFORM = BLOCK + _FAST_TAPS - 1
_SPLIT = 1.6e-3  # where middle and fast meet, as a fraction of the sample rate

_STRIDE = 32  # samples between points of the middle; at rates below the next line's, so many
_LOW_RATE_HZ, _LOW_RATE_STRIDE = 0.5, 4
_SPACING = 3.0  # ratio of neighbouring corners in the middle

_BOTTOM_STEP_S = 50.0
_BOTTOM_TAPS = 16385
_BOTTOM_TRANSFORM = 32768
_BOTTOM_POINTS = 160.0  # points of the bottom in 1 / (frequency at which bottom and middle meet)

#: Below this sample rate [Hz] the fast filter reaches down to 1e-5 Hz by itself.
_ALL_FAST_BELOW_HZ = 0.0128


class FlickerSource:
    """Flicker of B = 1 deg/h, block after block.

    Parameters
    ----------
    sample_rate_hz : float
        0.01 Hz or more.
    generator : numpy.random.Generator
        Where all draws come from.
    """

    def __init__(self, sample_rate_hz: float, generator: np.random.Generator) -> None:
        self._fast = _Filtered(_fast_response(sample_rate_hz), _FAST_TAPS, _FAST_TRANSFORM, generator)
        self._slow = None
        if sample_rate_hz >= _ALL_FAST_BELOW_HZ:
            self._slow = _Slow(sample_rate_hz, generator)

    def next_block(self) -> Array:
        """The next `BLOCK` samples [deg/h]."""
        flicker = self._fast.next_block()
        if self._slow is not None:
            flicker += self._slow.next_block()
        return flicker


class _Filtered:
    """White noise through a symmetric filter, `transform` - `taps` + 1 samples at a time."""

    def __init__(self, response: Spectrum, taps: int, transform: int, generator: np.random.Generator) -> None:
        self._response, self._kept, self._generator = response, taps - 1, generator
        self._noise = np.empty(transform)
        generator.standard_normal(out=self._noise[-self._kept :])

    def next_block(self) -> Array:
        noise, kept = self._noise, self._kept
        noise[:kept] = noise[-kept:]
        self._generator.standard_normal(out=noise[kept:])
        spectrum = np.fft.rfft(noise)
        spectrum *= self._response
        filtered: Array = np.fft.irfft(spectrum, len(noise))[kept:]
        return filtered


class _Slow:
    """Middle and bottom, which share the points between which straight lines are drawn."""

    def __init__(self, sample_rate_hz: float, generator: np.random.Generator) -> None:
        self._generator = generator
        plan = _Plan.of(sample_rate_hz)
        decay = 2.0 * np.pi * plan.corners_hz * plan.stride / sample_rate_hz
        points = BLOCK // plan.stride
        self._between = np.arange(plan.stride) / plan.stride
        self._decayed = np.exp(-np.outer(decay, np.arange(1, points + 1)))
        self._kick = np.sqrt(-np.expm1(-2.0 * decay))[:, None] / self._decayed
        self._sigma = math.sqrt(plan.variance)
        self._state = generator.standard_normal(len(decay))
        self._bottom = _Filtered(
            _bottom_response(plan.bottom_step_s), _BOTTOM_TAPS, _BOTTOM_TRANSFORM, generator
        )
        self._every = plan.bottom_stride
        self._drawn = self._bottom.next_block()
        self._point = 0  # the block's first point, counted from the first of `_known`

    def next_block(self) -> Array:
        ends = self._middle()
        ends += self._bottom_at(len(ends))
        lines = np.multiply.outer(np.diff(ends), self._between)
        lines += ends[:-1, None]
        return lines.ravel()

    def _middle(self) -> Array:
        """At the block's points: x[j] = a x[j - 1] + sqrt(1 - a^2) w[j], as a^j (x[0] + sum kicks / a^i)."""
        paths = self._generator.standard_normal(self._decayed.shape)
        paths *= self._kick
        np.cumsum(paths, axis=1, out=paths)
        paths += self._state[:, None]
        paths *= self._decayed
        ends = np.concatenate(([self._state.sum()], paths.sum(axis=0)))
        self._state = paths[:, -1].copy()
        return self._sigma * ends

    def _bottom_at(self, count: int) -> Array:
        """The bottom at the block's points; the last one is the next block's first."""
        index, part = np.divmod(self._point + np.arange(count), self._every)
        while index[-1] + 1 >= len(self._drawn):
            behind = int(index[0])
            self._drawn = np.concatenate((self._drawn[behind:], self._bottom.next_block()))
            self._point -= behind * self._every
            index -= behind
        self._point += count - 1
        left = self._drawn[index]
        bottom: Array = left + (self._drawn[index + 1] - left) * (part / self._every)
        return bottom


class _Plan:
    """How the parts share the spectrum at one sample rate.

    Attributes
    ----------
    corners_hz : (cells,) array
        Corners of the middle, each in the middle of its cell of ln f.
    variance : float
        Of each process of the middle [(deg/h)^2]: its cell's width, over pi.
    meet_hz, split_hz : float
        Where bottom and middle, middle and fast meet.
    stride : int
        Samples between points of the middle.
    bottom_stride : int
        Points of the middle in a step of the bottom.
    bottom_step_s : float
    """

    def __init__(self, sample_rate_hz: float) -> None:
        self.stride = _STRIDE if sample_rate_hz >= _LOW_RATE_HZ else _LOW_RATE_STRIDE
        self.bottom_stride = max(1, round(_BOTTOM_STEP_S * sample_rate_hz / self.stride))
        self.bottom_step_s = self.bottom_stride * self.stride / sample_rate_hz
        self.meet_hz = 1.0 / (_BOTTOM_POINTS * self.bottom_step_s)
        self.split_hz = _SPLIT * sample_rate_hz
        width = math.log(self.split_hz / self.meet_hz)
        cells = math.ceil(width / math.log(_SPACING))
        self.corners_hz = self.meet_hz * np.exp(width * (np.arange(cells) + 0.5) / cells)
        self.variance = width / cells / math.pi

    @staticmethod
    @cache
    def of(sample_rate_hz: float) -> _Plan:
        return _Plan(sample_rate_hz)


def _first_order_share(frequency_hz: Array, lowest_hz: float) -> Array:
    """Share of 1/f that first-order processes with corners from `lowest_hz` up make.

    One of corner g and variance v has the density ``v (2 / pi) g / (g^2 + f^2)``; with a variance of dg/g in
    each dg, all those from `lowest_hz` up sum to ``(2 / pi) atan(f / lowest_hz) / f``. In place of a
    continuum of corners, a spacing of three makes a ripple of ``4 exp(-pi^2 / ln 3)`` = 0.05 %.
    """
    return 2.0 / np.pi * np.arctan(frequency_hz / lowest_hz)


def _middle_densities(frequency_hz: Array, sample_rate_hz: float) -> tuple[Array, Array]:
    """One-sided densities [1/Hz] of the middle: as continuous processes, and as made, on points and lines.

    On points a step T apart the density repeats every 1/T; lines drawn at each of m samples a step multiply
    it by ``(D(f) / m)^4``, D the Dirichlet kernel ``sin(pi f T) / sin(pi f T / m)`` (a triangle: two boxes).
    """
    plan = _Plan.of(sample_rate_hz)
    step = plan.stride / sample_rate_hz
    square = np.sin(np.pi * frequency_hz * step) ** 2
    continuous, grid = np.zeros_like(frequency_hz), np.zeros_like(frequency_hz)
    for corner in plan.corners_hz:
        continuous += 2.0 / np.pi * corner / (corner**2 + frequency_hz**2)
        a = math.exp(-2.0 * math.pi * corner * step)
        grid += 2.0 * step * (1.0 - a) * (1.0 + a) / ((1.0 - a) ** 2 + 4.0 * a * square)
    box = np.sinc(frequency_hz * step) / np.sinc(frequency_hz / sample_rate_hz)
    return plan.variance * continuous, plan.variance * grid * box**4


@cache
def _fast_response(sample_rate_hz: float) -> Spectrum:
    """Transform of the fast part's filter."""
    frequency = _frequencies(sample_rate_hz, 4 * _FAST_TRANSFORM)
    if sample_rate_hz < _ALL_FAST_BELOW_HZ:
        density = (frequency >= LOWEST_FLICKER_HZ) / (np.pi * frequency)
    else:
        share = _first_order_share(frequency, _Plan.of(sample_rate_hz).split_hz)
        continuous, joined = _middle_densities(frequency, sample_rate_hz)
        density = share / (np.pi * frequency) + continuous - joined
    return _response(density, sample_rate_hz, _FAST_TAPS, _FAST_TRANSFORM)


@cache
def _bottom_response(step_s: float) -> Spectrum:
    """Transform of the bottom's filter: from 1e-5 Hz up what the middle leaves."""
    frequency = _frequencies(1.0 / step_s, 4 * _BOTTOM_TRANSFORM)
    share = 1.0 - _first_order_share(frequency, 1.0 / (_BOTTOM_POINTS * step_s))
    density = share * (frequency >= LOWEST_FLICKER_HZ) / (np.pi * frequency)
    return _response(density, 1.0 / step_s, _BOTTOM_TAPS, _BOTTOM_TRANSFORM)


def _frequencies(rate_hz: float, length: int) -> Array:
    """Those of a real transform [Hz], but for a first one above 0, where the densities are finite."""
    frequency = np.linspace(0.0, rate_hz / 2.0, length // 2 + 1)
    frequency[0] = 1e-3 * frequency[1]
    return frequency


def _response(density: Array, rate_hz: float, taps: int, transform: int) -> Spectrum:
    """Transform of the symmetric filter that gives white noise of variance 1 a one-sided density [1/Hz].

    White noise of variance 1 has the density 2 / rate. The filter's outer half is tapered, so that a sharp
    edge in the density rings little.
    """
    gain = np.sqrt(np.maximum(density, 0.0) * rate_hz / 2.0)
    whole = np.fft.irfft(gain)
    half = taps // 2
    outward = np.abs(np.arange(-half, half + 1)) / half
    taper = np.cos(np.pi / 2.0 * np.clip(2.0 * outward - 1.0, 0.0, 1.0)) ** 2
    whole = np.concatenate((whole[-half:], whole[: half + 1])) * taper
    response: Spectrum = np.fft.rfft(whole, transform)
    return response


def density_made(sample_rate_hz: float, frequency_hz: Array) -> Array:
    """One-sided density [(deg/h)^2/Hz] that `FlickerSource` has by construction, finite filters included."""
    fast = _gain(_fast_response(sample_rate_hz), _FAST_TAPS, frequency_hz / sample_rate_hz)
    density: Array = fast**2 * 2.0 / sample_rate_hz
    if sample_rate_hz >= _ALL_FAST_BELOW_HZ:
        density = density + _middle_densities(frequency_hz, sample_rate_hz)[1]
        step = _Plan.of(sample_rate_hz).bottom_step_s
        bottom = _gain(_bottom_response(step), _BOTTOM_TAPS, frequency_hz * step)
        box = np.sinc(frequency_hz * step) / np.sinc(frequency_hz / sample_rate_hz)
        density = density + bottom**2 * 2.0 * step * box**4
    return density


def _gain(response: Spectrum, taps: int, turns: Array) -> Array:
    """Gain of a symmetric filter, (N,), at frequencies as fractions of its rate."""
    filter_taps = np.fft.irfft(response)[:taps]
    half = taps // 2
    gain = np.full(len(turns), filter_taps[half])
    for k, turn in enumerate(turns):
        angles = 2.0 * np.pi * turn * np.arange(1, half + 1)
        gain[k] += 2.0 * np.cos(angles) @ filter_taps[half + 1 :]
    return gain
