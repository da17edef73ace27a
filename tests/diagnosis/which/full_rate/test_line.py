"""A line's numbers."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.which.full_rate.line import Line, frequency_std


def test_a_line_of_some_runs_has_their_amplitude_and_share_of_the_gain() -> None:
    by_run = {"r1": (3.0, 0.1), "r2": (5.0, 0.1), "r3": (4.0, 0.2)}
    whole = Line(("gyro1",), ("*",), 17.0, 0.001, 4.0, 0.06, None, 90.0, 100.0, 0.25, 6, True, True, by_run)
    one = whole.of(["r2"])
    assert one is not None
    assert (one.deg_h, one.std) == pytest.approx((5.0, 0.1))
    assert one.gain == pytest.approx(100.0 * 4.0 / 9.0)
    assert whole.of(["r9"]) is None


def test_a_frequency_is_known_to_cramer_and_rao_s_bound_or_to_how_a_line_drifts() -> None:
    # S = 2 sqrt(gain / 2): Rife and Boorstyn 1974, sqrt(6) / (pi S T) with S^2 = 2 gain
    faint, strong = frequency_std(100.0, 8.0), frequency_std(100.0, 1e12)
    assert faint == pytest.approx(np.hypot(np.sqrt(12.0) / (2.0 * np.pi * 4.0), 100.0 * strong) / 100.0)
    # a drift from one such error below the mean to one above it departs from the steady line by as much as an
    # effect may depart from its shape
    t = np.linspace(-50.0, 50.0, 10001)
    drifting = np.exp(2j * np.pi * 0.5 * (2.0 * strong / 100.0) * t**2)
    steady = drifting.mean()
    assert np.sqrt(np.mean(np.abs(drifting - steady) ** 2)) == pytest.approx(priors.DEPARTURE, rel=0.01)
