"""One gyro's residual as lines are looked for in it."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.diagnosis.which.full_rate.streams import Stream, noise_floor


def test_what_is_left_of_an_exact_line_is_nothing() -> None:
    left, _ = Stream(100.0, 5.0 * np.sin(2.0 * np.pi * 0.0137 * np.arange(12000) + 0.3)).without(1.37)
    assert np.max(np.abs(left.residual)) < 1e-6


def test_the_floor_follows_a_spectrum_and_not_its_lines() -> None:
    rng = np.random.default_rng(9)
    size = np.geomspace(10.0, 1.0, 20000)
    lines = size * (rng.standard_normal(20000) + 1j * rng.standard_normal(20000))
    lines[::500] *= 1000.0
    ratio = np.sqrt(noise_floor(lines, 1.0)) / size
    assert np.all(np.abs(ratio - 1.0) < 0.3)
    assert np.mean(ratio) == pytest.approx(1.0, abs=0.03)
