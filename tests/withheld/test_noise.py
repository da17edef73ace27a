"""Noise by the contract's definitions, and the clairvoyant's covariance of it."""

import numpy as np
import pytest

from withheld.chain.noise import band_limited, flicker, random_walk
from withheld.clairvoyant.covariance import block_covariance, flicker_lags

REPEATS = 60


def overlapping_allan(values, m):
    sums = np.concatenate([[0.0], np.cumsum(values)])
    means = (sums[m:] - sums[:-m]) / m
    return np.sqrt(0.5 * np.mean((means[m:] - means[:-m]) ** 2))


@pytest.mark.parametrize("rate", [16.0, 100.0])
def test_flicker_is_flat_at_its_level(rate):
    rng = np.random.default_rng(1)
    runs = [flicker(8192, rate, rng) for _ in range(REPEATS)]
    flat = np.sqrt(2 * np.log(2) / np.pi)
    for m in (16, 128, 512):
        found = np.sqrt(np.mean([overlapping_allan(one, m) ** 2 for one in runs]))
        # 60 runs of at least 8 independent pairs: 1 / sqrt(2 * 480) = 3 %; discreteness: below 2 %
        assert found == pytest.approx(flat, rel=0.08)


def test_flicker_reaches_down_to_a_hundred_thousandth_of_a_hertz():
    rng = np.random.default_rng(2)
    values = np.array([flicker(512, 1.0, rng) for _ in range(2000)])
    # variance of a sample: the density from 1e-5 Hz to half a hertz, ln(0.5e5) / pi
    assert np.mean(values**2) == pytest.approx(np.log(0.5e5) / np.pi, rel=0.05)


def test_random_walk_grows_as_the_contract_says():
    rng = np.random.default_rng(3)
    ends = np.array([random_walk(3601, 1.0, rng)[-1] for _ in range(3000)])
    assert ends.std() == pytest.approx(1.0, rel=0.04)  # K sqrt(1 h); 1 / sqrt(6000) = 1.3 %
    assert random_walk(10, 1.0, rng)[0] == 0.0


def test_band_limited_noise_stays_in_its_band():
    values = band_limited(4096, 64.0, 5.0, 10.0, np.random.default_rng(4))
    power = np.abs(np.fft.rfft(values)) ** 2
    frequency = np.fft.rfftfreq(4096, 1 / 64.0)
    outside = (frequency < 4.9) | (frequency > 10.1)
    assert power[outside].sum() < 1e-12 * power.sum()
    assert values.std() == pytest.approx(1.0, rel=0.1)


def test_covariance_of_flicker_s_block_means():
    rng = np.random.default_rng(5)
    blocks = np.array([flicker(1024, 16.0, rng).reshape(64, 16).mean(axis=1) for _ in range(1500)])
    sample = blocks.T @ blocks / len(blocks)
    lags = flicker_lags(64, 1.0)
    for lag in (0, 1, 5, 40):
        # the variance at lag 0 is about 3.6; averaged over diagonals its error is dominated by the slow part
        assert np.mean(np.diagonal(sample, lag)) == pytest.approx(lags[lag], rel=0.08)
    # differences are free of the slow part
    assert np.mean((blocks[:, 1:] - blocks[:, :-1]) ** 2) == pytest.approx(2 * (lags[0] - lags[1]), rel=0.03)


def test_covariance_of_a_walk_s_block_means():
    rng = np.random.default_rng(6)
    blocks = np.array([random_walk(3200, 1.0, rng).reshape(8, 400).mean(axis=1) for _ in range(4000)])
    expected = block_covariance(8, 400.0, 0.0, 0.0, 1.0, 0.0)
    assert blocks.T @ blocks / len(blocks) == pytest.approx(expected, abs=0.08 * expected.max())


def test_white_noise_s_block_means():
    # N deg/sqrt(h) over one second: variance N^2 / (1/3600 h)
    assert block_covariance(3, 1.0, 0.002, 0.0, 0.0, 0.0) == pytest.approx(np.eye(3) * 0.002**2 * 3600)
