"""Averaged spectra say as much as they claim: their lines scatter as so many pieces would make them."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.signal import lfilter

from fogreduce.diagnosis.observe.full_rate import averaged_spectrum

RATE, SIZE, RUNS = 100.0, 12_000, 200


def scatter(streams: np.ndarray) -> np.ndarray:
    """Of the mean power of the lower and the upper half of the lines from run to run, over what the stated
    pieces make it.
    """
    pieces, frequency, power, _ = averaged_spectrum(streams, RATE)
    level = power / power.mean(axis=0)
    parts = np.array([part.mean(axis=1) for part in np.array_split(level, 2, axis=1)])
    return parts.std(axis=1) * np.sqrt(pieces * (len(frequency) / 2))


def test_of_white_noise() -> None:
    noise = np.random.default_rng(1).standard_normal((RUNS, SIZE))
    pieces, _, power, _ = averaged_spectrum(noise, RATE)
    # a standard deviation of 200 numbers scatters by 5 %
    assert np.all(np.abs(scatter(noise) - 1.0) < 0.2)
    assert pieces == pytest.approx(SIZE / 256, rel=0.02)
    # and so does the whole level: of 200 runs to 1 in 20 of their own scatter of 1.3 %
    assert power.mean() == pytest.approx(1.0, abs=4.0 * 0.013 / np.sqrt(RUNS))


@pytest.mark.parametrize("tau_ms", [30.0, 100.0, 200.0])
def test_of_a_steep_spectrum(tau_ms: float) -> None:
    """Edges of pieces let strong low lines leak into all high ones, which then rise and fall together."""
    q = np.exp(-1e3 / RATE / tau_ms)
    # a standard deviation of 200 numbers scatters by 5 %
    noise = np.random.default_rng(2).standard_normal((RUNS, SIZE))
    assert np.all(scatter(lfilter([1.0 - q], [1.0, -q], noise)) < 1.15)


@pytest.mark.parametrize("rate_hz", [0.1, 100.0])
def test_the_level_of_white_noise_is_right_in_pieces_of_few_lines_too(rate_hz: float) -> None:
    """Of a slow log's seven lines chance alone makes some pieces twice as strong as usual."""
    noise = np.random.default_rng(4).standard_normal((2, 100_000))
    pieces, _, power, _ = averaged_spectrum(noise, rate_hz)
    error = 1.0 / np.sqrt(pieces * power.shape[1])
    assert power.mean(axis=1) == pytest.approx(np.ones(2), abs=4.0 * error)


def test_a_piece_with_a_glitch_is_left_out() -> None:
    noise = np.random.default_rng(5).standard_normal((1, 20_000))
    noise[0, 5000:5003] += 40.0
    _, _, power, _ = averaged_spectrum(noise, 0.1)
    assert power.mean() == pytest.approx(1.0, abs=0.05)
