"""Series of white noise, flicker and random walk whose Allan variance is known exactly."""

from __future__ import annotations

from functools import cache

import numpy as np

NOISES = {"white": 0, "flicker": -1, "walk": -2}
_ALIASES = 50
_PERIODS = 8  # of a series, in which flicker repeats itself


@cache
def _powers(size: int) -> np.ndarray:
    """Variance of each frequency of means of 1/f noise that repeats after `_PERIODS` times the series."""
    f = np.arange(1, size * _PERIODS // 2 + 1) / (size * _PERIODS)
    return sum(np.sinc(f + k) ** 2 / abs(f + k) for k in range(-_ALIASES, _ALIASES + 1)) / (size * _PERIODS)


def make(noise: str, size: int, generator: np.random.Generator) -> np.ndarray:
    """Means over neighbouring intervals of a unit white noise, flicker or random walk."""
    steps = generator.normal(size=size)
    if noise == "white":
        return steps
    if noise == "walk":  # half a step into the interval on average, and the bridge within it
        before = np.concatenate(([0.0], np.cumsum(steps[:-1])))
        return before + steps / 2 + generator.normal(size=size) / np.sqrt(12)
    powers = _powers(size)
    parts = generator.normal(size=(2, powers.size)) * np.sqrt(powers / 2)
    spectrum = np.concatenate(([0.0], parts[0] + 1j * parts[1]))
    return np.fft.irfft(spectrum * size * _PERIODS / np.sqrt(2))[:size]


def allan_variance(noise: str, size: int, factor: int) -> float:
    """What its Allan variance is."""
    if noise == "white":
        return 1 / factor
    if noise == "walk":
        return factor / 3
    f = np.arange(1, size * _PERIODS // 2 + 1) / (size * _PERIODS)
    response = 2 * np.sin(np.pi * f * factor) ** 4 / (factor * np.sin(np.pi * f)) ** 2
    return float(np.sum(_powers(size) * response))
