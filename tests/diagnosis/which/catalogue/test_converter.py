"""A converter's error in block means: what they keep of one within the noise, and one far wider than it."""

from __future__ import annotations

from pathlib import Path

import pytest
from bench_lab import RECORD, diagnosed, lab, simulated, write_record, write_run


def test_what_is_slow_of_it_is_its_own_doing(tmp_path: Path) -> None:
    lab(tmp_path)
    put = {
        "effect": "adc_nonlinearity",
        "channels": ["gyro1"],
        "runs": ["*"],
        "parameters": {"volts": 5e-6, "period_volts": 2.2e-4},
    }
    found = diagnosed(tmp_path, simulated(tmp_path, [put]))
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert (cause["effect"], cause["channels"]) == ("adc_nonlinearity", ["gyro1"])


@pytest.mark.slow
def test_one_far_wider_than_the_noise_is_named_by_what_each_rate_reads(tmp_path: Path) -> None:
    """Each rate falls somewhere in the period: levels that no scale factor, axis or crosstalk makes."""
    write_record(tmp_path, RECORD)
    for k, (axis, rate) in enumerate(zip("xxyyzzzx", (10.0, -10.0) * 3 + (0.5, 0.0), strict=True)):
        write_run(tmp_path, f"r{k}", axis, [(rate, 120.0)], 4, 64.0)
    volts, period = 1e-4, 0.05
    put = {
        "effect": "adc_nonlinearity",
        "channels": ["gyro2"],
        "runs": ["*"],
        "parameters": {"volts": volts, "period_volts": period},
    }
    found = diagnosed(tmp_path, simulated(tmp_path, [put]))
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert (cause["effect"], cause["channels"]) == ("adc_nonlinearity", ["gyro2"])
    for name, value in put["parameters"].items():
        stated = cause["parameters"][name]
        assert abs(stated["value"] - value) < 4.0 * stated["std"]  # once in 16000
