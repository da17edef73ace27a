"""A filter of one pole: its two forms agree, and it falls by 3 dB where its bandwidth says."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.physics.low_pass import bandwidth_hz, of_samples, of_steps

EDGE = np.array([0.0, 0.3, 0.55, 1.0, 1.01])
V = np.array([2.0, -1.0, 4.0, 0.0, 3.0])


@pytest.mark.parametrize("tau", [0.003, 0.05, 0.7])
def test_steps_are_answered_as_fine_samples_are(tau: float) -> None:
    """Straight lines of 10 us in place of steps are off by half of it over tau, of steps of 5."""
    fine = np.arange(0, 150_000) * 1e-5
    v = V[np.searchsorted(EDGE, fine, side="right") - 1]
    np.testing.assert_allclose(of_steps(EDGE, V, tau, fine), of_samples(v, 1e-5, tau), atol=5 * 1e-5 / tau)


def test_a_step_is_an_exponential_by_hand_and_settled_before() -> None:
    time_s = np.array([-1.0, 0.2, 0.3, 0.3 + 0.1])
    expected = [2.0, 2.0, 2.0, -1.0 + 3.0 * np.exp(-1.0)]
    np.testing.assert_allclose(of_steps(EDGE, V, 0.1, time_s), expected, rtol=1e-12)


def test_blocks_follow_on_each_other() -> None:
    v = np.random.default_rng(1).standard_normal(100)
    whole = of_samples(v, 0.01, 0.02)
    first = of_samples(v[:40], 0.01, 0.02)
    np.testing.assert_allclose(of_samples(v[40:], 0.01, 0.02, (first[-1], v[39])), whole[40:], rtol=1e-12)


def test_the_gain_at_the_bandwidth_is_one_over_root_two() -> None:
    frequency = bandwidth_hz(0.01)
    time_s = np.arange(0, 200_000) * 1e-5
    wave = of_samples(np.sin(2 * np.pi * frequency * time_s), 1e-5, 0.01)[100_000:]
    assert np.abs(wave).max() == pytest.approx(np.sqrt(0.5), rel=1e-5)
    assert bandwidth_hz(frequency) == pytest.approx(0.01)
