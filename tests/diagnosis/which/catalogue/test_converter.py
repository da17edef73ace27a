"""A converter's error that the noise does not sweep over: what block means keep of it is no further gap."""

from __future__ import annotations

from pathlib import Path

from bench_lab import diagnosed, lab, simulated


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
