"""A slow quantity out of a log with noise."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.effects.at import slope_around
from fogreduce.estimate.smooth import smoothed

T = np.arange(0.0, 401.0)
ROOM = 25.0 + 0.002 * T + 0.4 * np.sin(2 * np.pi * T / 300.0) + 0.3 * np.sin(2 * np.pi * T / 700.0 + 1.0)


def test_what_has_no_noise_stays() -> None:
    assert np.allclose(smoothed(ROOM), ROOM, atol=1e-9)
    assert np.allclose(smoothed(20.0 + 0.01 * T), 20.0 + 0.01 * T, atol=1e-9)
    assert np.allclose(smoothed(np.full(50, 21.5)), 21.5, atol=1e-12)
    assert smoothed(np.array([20.0, 21.0])).tolist() == [20.0, 21.0]


def test_white_noise_goes_from_values_and_slopes() -> None:
    """Of 4 mK, as a platinum sensor's readings have; slopes over 20 s are noisy by 0.0087 degC/min."""
    noisy = np.round(ROOM + 0.004 * np.random.default_rng(3).standard_normal(len(T)), 4)

    def slope(values: np.ndarray) -> np.ndarray:
        return 60.0 * slope_around(T, values, T, half_s=10.0)

    left = smoothed(noisy)
    assert np.std(left - ROOM) < 0.3 * np.std(noisy - ROOM)
    assert np.std(slope(left) - slope(ROOM)) < 0.6 * np.std(slope(noisy) - slope(ROOM))


def test_a_soak_that_begins_keeps_its_corner() -> None:
    soak = 20.0 + np.maximum(T - 200.0, 0.0) * 2.0 / 60.0
    noisy = soak + 0.004 * np.random.default_rng(4).standard_normal(len(T))
    assert np.max(np.abs(smoothed(noisy) - soak)) < 0.05
    assert smoothed(noisy)[300] == pytest.approx(soak[300], abs=0.01)
