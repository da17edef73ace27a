"""A converter's error within the noise, told from drift."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.diagnosis.which.full_rate.converter import codes, converter_findings

SECOND, SIGMA = 32, 25e-6


def evidence(seconds: int, drift: float, error: float) -> float:
    """Ln B at one gyro that turns once: drift over minutes, an error that repeats every 240 microvolts."""
    generator = np.random.default_rng(5)
    t = (np.arange(seconds * SECOND) + 0.5) / SECOND
    swings = np.interp(
        t, np.arange(0.0, seconds + 200.0, 100.0), generator.standard_normal(seconds // 100 + 2)
    )
    e = SIGMA * generator.standard_normal(t.size) + drift * swings
    volts = 3.7e-4 * np.sin(2.0 * np.pi * t / seconds) + e
    shown = error * np.sin(2.0 * np.pi * volts / 2.4e-4)
    middle = np.arange(seconds) + 0.5
    slow = np.column_stack([np.cos(np.pi * m * middle / seconds) for m in range(7)])
    held = codes(volts + shown, e + shown, SECOND, slow)
    assert held is not None
    (found,) = converter_findings([[held]], 1, frozenset({"adc_nonlinearity"}), np.array([1e-7]))
    return found.log_b


@pytest.mark.parametrize("seconds", [300, 3000])
@pytest.mark.parametrize("drift", [0.0, 6e-6, 11e-6])
def test_drift_is_no_error_of_the_converter(seconds: int, drift: float) -> None:
    assert evidence(seconds, drift, 0.0) < 2.0


@pytest.mark.parametrize(("seconds", "error"), [(300, 6e-6), (3000, 2e-6)])
def test_an_error_shows_beside_drift(seconds: int, error: float) -> None:
    assert evidence(seconds, 6e-6, error) > 20.0


def test_counts_in_wide_steps_say_nothing_of_codes() -> None:
    """Pulses of a third of the noise, as a ring laser gives them: voltages lie on a comb of their own."""
    rng = np.random.default_rng(11)
    noise = rng.standard_normal(20_000)
    assert codes(noise, noise, 100, np.ones((200, 1))) is not None
    pulses = np.round(noise * 3.0) / 3.0
    assert codes(pulses, pulses, 100, np.ones((200, 1))) is None
