"""What pieces show of a filter and of drifts, against averages of processes made here sample by sample."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from fogreduce.diagnosis.observe.full_rate import FIRST_LINE, PIECE, straightened
from fogreduce.diagnosis.which.full_rate.pieces import filter_gains, shown_drift

RATE, PIECES = 100.0, 6000
FREQUENCY = np.fft.rfftfreq(PIECE)[FIRST_LINE:-1]


def shown(samples: NDArray[np.float64]) -> NDArray[np.float64]:
    """Averaged spectrum of a stream's pieces: white noise of variance s^2 has s^2 in every line."""
    cut = straightened(samples[: PIECES * PIECE].reshape(PIECES, PIECE))
    window = np.sqrt(2.0) * np.sin(np.pi * (np.arange(PIECE) + 0.5) / PIECE)
    lines = np.fft.rfft(cut * window, axis=1)[:, FIRST_LINE:-1]
    return np.mean(np.abs(lines) ** 2, axis=0) / PIECE


@pytest.mark.parametrize("tau_ms", [3.0, 30.0, 100.0])
def test_a_filter_leaks_as_it_does(tau_ms: float) -> None:
    """The filter of docs/effects.md, written here as its recursion."""
    v = np.random.default_rng(1).standard_normal(PIECES * PIECE)
    x = 10.0 / tau_ms
    q = np.exp(-x)
    g = (1.0 - q) / x
    y = np.zeros(len(v))
    driven = (1.0 - g) * v + (g - q) * np.concatenate([[0.0], v[:-1]])
    state = 0.0
    for k, one in enumerate(driven.tolist()):
        state = q * state + one
        y[k] = state
    expected = filter_gains(np.array([tau_ms]), RATE, FREQUENCY)[0, 0]
    # a mean of 6,000 exponential deviates scatters by 1.3 %
    assert np.max(np.abs(shown(y) / expected - 1.0)) < 0.06


def test_noise_whose_correlation_is_a_power_of_the_lag() -> None:
    """Of variance 1 in: ``(1 - q)^2 / (1 - q^2)`` out sample by sample; of continuous noise ``x / 2``."""
    tau_ms = 1e3 / RATE / 1.2
    x, q = 1.2, np.exp(-1.2)
    e = np.random.default_rng(3).standard_normal(PIECES * PIECE)
    y, state = np.empty(len(e)), 0.0
    for k, one in enumerate(((1.0 - q) * e).tolist()):
        state = q * state + one
        y[k] = state
    _, one_pole, folded = filter_gains(np.array([tau_ms]), RATE, FREQUENCY)[:, 0]
    assert np.max(np.abs(shown(y) / one_pole - 1.0)) < 0.06
    variance = x / 2.0
    assert np.allclose(folded / one_pole, variance * (1.0 + q) / (1.0 - q), rtol=1e-9)


def test_a_walk_is_shown_as_its_increments_make_it() -> None:
    """K / 60 sqrt(dt) deg/h a step, as the catalogue of effects states it."""
    steps = np.random.default_rng(2).standard_normal(PIECES * PIECE) * 20.0 / 60.0 / np.sqrt(RATE)
    expected = shown_drift(RATE, FREQUENCY, 0.0, 20.0)
    assert np.max(np.abs(shown(np.cumsum(steps)) / expected - 1.0)) < 0.1
