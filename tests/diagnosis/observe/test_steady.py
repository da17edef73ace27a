"""Which effects the full rate is held against."""

from __future__ import annotations

from fogreduce.diagnosis.observe.data import steady
from fogreduce.effects.selection import Action, action


def put(effect: str, channel: str, **parameters: object) -> Action:
    return action(effect, [channel], ["r1"], parameters, 3)


def test_no_filter_and_nothing_that_a_temperature_log_drives() -> None:
    turned = put("rotation_sense", "table")
    slow = put("temperature_rate_bias", "gyro1", deg_h_per_degC_per_min=20.0)
    filtered = put("low_pass", "gyro2", time_constant_ms=5.0)
    assert steady([slow, turned, filtered]) == [turned]
