"""A converter's error within the noise, told from drift."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.gap.converter import codes, converter_findings

SECONDS, SECOND, SIGMA = 3000, 32, 25e-6


def evidence(drift: float, error: float) -> float:
    """Ln B at one gyro that turns once: drift over minutes, an error that repeats every 240 microvolts."""
    generator = np.random.default_rng(4)
    t = (np.arange(SECONDS * SECOND) + 0.5) / SECOND
    swings = np.interp(
        t, np.arange(0.0, SECONDS + 200.0, 100.0), generator.standard_normal(SECONDS // 100 + 2)
    )
    e = SIGMA * generator.standard_normal(t.size) + drift * swings
    volts = 3.7e-4 * np.sin(2.0 * np.pi * t / SECONDS) + e
    shown = error * np.sin(2.0 * np.pi * volts / 2.4e-4)
    middle = np.arange(SECONDS) + 0.5
    slow = np.column_stack([np.cos(np.pi * m * middle / SECONDS) for m in range(7)])
    held = codes(volts + shown, e + shown, SECOND, slow)
    assert held is not None
    (found,) = converter_findings([[held]], 1, frozenset({"adc_nonlinearity"}), np.array([1e-7]))
    return found.log_b


@pytest.mark.parametrize("drift", [0.0, 6e-6])
def test_drift_of_a_long_run_is_no_error_of_the_converter(drift: float) -> None:
    assert evidence(drift, 0.0) < 2.0


def test_an_error_shows_beside_drift() -> None:
    assert evidence(6e-6, 2e-6) > 20.0
