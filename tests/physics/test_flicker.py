"""Flicker synthesis against its definition: density from 1e-5 Hz up, stationary from the first sample on."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fogreduce.physics import flicker, noise

RATES = [32.0, 128.0, 1000.0]


def generator(seed: int) -> np.random.Generator:
    return np.random.Generator(np.random.SFC64(seed))


def samples(source: flicker.FlickerSource, length: int) -> np.ndarray:
    return np.concatenate([source.next_block() for _ in range(-(-length // noise.BLOCK))])[:length]


@pytest.mark.parametrize("rate_hz", [0.01, 0.0128, 0.02, 0.1, 0.49, 0.5, *RATES, 10_000.0])
def test_the_density_is_the_one_defined(rate_hz: float) -> None:
    """By construction, no random numbers: within 1.5 % from 3e-5 Hz to half the sample rate."""
    f = np.geomspace(3e-5, rate_hz / 2, 300)
    ratio = flicker.density_made(rate_hz, f) / noise.flicker_density(1.0, f)
    assert ratio.min() > 0.985
    assert ratio.max() < 1.015


@pytest.mark.parametrize("rate_hz", RATES)
def test_the_cut_at_the_bottom_is_sharp(rate_hz: float) -> None:
    """Within 3 % from 1.5e-5 Hz up, below 5 % under 5e-6 Hz."""
    f = np.array([1e-7, 1e-6, 5e-6, 1.5e-5, 1.7e-5, 2e-5, 2.5e-5])
    ratio = flicker.density_made(rate_hz, f) / noise.flicker_density(1.0, f)
    assert np.all(ratio[:3] < 0.05)
    assert ratio[3:] == pytest.approx(np.ones(4), abs=0.03)


@pytest.mark.parametrize("rate_hz", RATES)
def test_the_power_below_a_hundredth_of_a_hertz(rate_hz: float) -> None:
    """From 1e-5 to 1e-2 Hz: ln(1e-2 / 1e-5) / pi."""
    f = np.geomspace(1e-8, 1e-2, 2_000)
    density = flicker.density_made(rate_hz, f)
    power = np.sum((density[1:] + density[:-1]) / 2 * np.diff(f))
    assert power == pytest.approx(math.log(1e3) / math.pi, rel=0.01)


def test_flicker_has_the_density_that_its_construction_says() -> None:
    """Periodograms under a Hann window: 200 x 8 values a band, so 2.5 % a deviation."""
    rate_hz, length = 128.0, 65536
    made = samples(flicker.FlickerSource(rate_hz, generator(1)), 200 * length).reshape(200, length)
    window = np.hanning(length)
    spectrum = np.abs(np.fft.rfft((made - made.mean(axis=1, keepdims=True)) * window)) ** 2
    density = 2 * spectrum.mean(axis=0) / rate_hz / np.sum(window**2)
    f = np.fft.rfftfreq(length, 1 / rate_hz)
    for low in (8, 32, 128, 512, 2048, 8192):
        band = slice(low, 2 * low)
        assert (density[band] / noise.flicker_density(1.0, f[band])).mean() == pytest.approx(1.0, abs=0.06)


def test_flicker_starts_stationary() -> None:
    """Over 400 runs the first samples vary as the last: nothing builds up (5 standard deviations of 7 %)."""
    first, last = [], []
    for seed in range(400):
        made = flicker.FlickerSource(128.0, generator(seed)).next_block()
        first.append(made[:32].mean())
        last.append(made[-32:].mean())
    assert np.std(first) / np.std(last) == pytest.approx(1.0, abs=0.25)
    # int of 1 / (pi f) from 1e-5 Hz to about 1 / (2 x 0.25 s): sqrt(ln(2e5) / pi) = 1.97
    assert np.std(first) == pytest.approx(1.97, rel=0.2)


def test_blocks_of_flicker_join_without_a_seam() -> None:
    """Steps across the borders of blocks are as large as any (300 borders: 4 standard deviations of 4 %)."""
    made = samples(flicker.FlickerSource(128.0, generator(2)), 301 * noise.BLOCK)
    steps = np.diff(made)
    borders = steps[noise.BLOCK - 1 :: noise.BLOCK]
    assert len(borders) == 300
    assert borders.std() / steps.std() == pytest.approx(1.0, abs=0.17)


def test_over_days_flicker_is_as_wide_as_it_should_be() -> None:
    """Means over 3e4 s, sampled at 0.1 Hz, 20 in a row in 60 runs: the covariance of the definition.

    Neighbours are correlated: 1200 means know a variance to some 6 %.
    """
    length, step = 3_000, 3e4
    blocks = [
        samples(flicker.FlickerSource(0.1, generator(seed)), 20 * length).reshape(20, length).mean(axis=1)
        for seed in range(60)
    ]
    expected = noise.flicker_covariance(1.0, step, 4)
    for lag in range(4):
        found = np.mean([np.mean(block[lag:] * block[: 20 - lag]) for block in blocks])
        assert (found - expected[lag]) / expected[0] == pytest.approx(0.0, abs=0.2)
