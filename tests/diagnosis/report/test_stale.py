"""When the page of a diagnosis points to a derivation of the record."""

from __future__ import annotations

import pytest

from fogreduce.diagnosis.report.stale import is_stale, way_out


def off(effect: str, gyro: int, *, runs: str = "*", probability: float = 1.0) -> dict:
    return {"effect": effect, "channels": [f"gyro{gyro}"], "runs": [runs], "probability": probability}


def tension(effect: str, gyro: int, sigma: float) -> dict:
    return {"effect": effect, "channels": [f"gyro{gyro}"], "runs": ["*"], "sigma": sigma}


@pytest.mark.parametrize(
    ("causes", "tensions", "stale"),
    [
        ([off("bias_offset", 1), off("scale_factor_error", 2)], [], True),
        ([off("bias_offset", 1), off("scale_factor_error", 1)], [], False),  # of one gyro
        ([off("bias_offset", 1), off("bias_offset", 2, runs="1-xp")], [], False),  # of one run
        ([off("bias_offset", 1), off("bias_offset", 2, probability=0.3)], [], False),
        ([off("bias_ramp", 1), off("bias_ramp", 2)], [], False),  # nothing that a record holds
        ([], [tension("axis_misalignment", 1, 4.0), tension("bias_offset", 3, -3.5)], True),
        ([], [tension("axis_misalignment", 1, 2.0), tension("bias_offset", 3, -2.5)], False),
    ],
)
def test_two_gyros_in_all_runs(causes, tensions, stale) -> None:
    document = {"campaign": "a<b", "causes": causes, "tension": tensions}
    assert is_stale(document) is stale
    assert ("derive-calibration a&lt;b" in way_out(document)) is stale
