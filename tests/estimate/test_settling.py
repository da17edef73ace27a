"""How long a table accelerates, from made-up ramps whose length is known."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.estimate.settling import settling_time_s

TIME_S = np.arange(0.0, 60.0, 1 / 64)


def ramp(length_s: float, rate: float, noise: float = 0.01) -> np.ndarray:
    scatter = np.random.default_rng(4).normal(0.0, noise, TIME_S.size)
    return rate * np.minimum(TIME_S / length_s, 1.0) + scatter


@pytest.mark.parametrize(("length_s", "rate"), [(2.0, 5.0), (0.5, -5.0), (10.0, 20.0)])
def test_a_ramp(length_s: float, rate: float) -> None:
    """To three means of a twentieth of a second, and not before its end but for what noise hides."""
    found = settling_time_s(TIME_S, ramp(length_s, rate), rate)
    assert length_s - 0.1 < found < length_s + 0.3


def test_a_table_that_turns_at_once_or_never_rests() -> None:
    assert settling_time_s(TIME_S, ramp(1e-6, 5.0), 5.0) == 0.0
    assert settling_time_s(TIME_S, ramp(1e3, 5.0), 5.0) == 0.0
    assert settling_time_s(TIME_S[:5], ramp(2.0, 5.0)[:5], 5.0) == 0.0
