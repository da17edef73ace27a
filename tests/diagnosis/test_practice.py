"""The five practice campaigns: two readings of the contract agree on what is wrong. Nothing was tuned on
them."""

from __future__ import annotations

from pathlib import Path

import pytest

from fogreduce.diagnosis.diagnose import diagnose

PRACTICE = Path("/work/shared/practice")

pytestmark = pytest.mark.skipif(not PRACTICE.is_dir(), reason="the practice campaigns are not here")


@pytest.mark.parametrize(
    ("number", "verdict", "cause", "gyro"),
    [
        (1, "no_gap", None, None),
        (2, "explained", "temperature_bias", "gyro3"),
        (3, "explained", "crosstalk", "gyro4"),
        (4, "explained", "spikes", "gyro4"),
        (5, "unexplained", None, "gyro1"),
    ],
)
def test_practice(number: int, verdict: str, cause: str | None, gyro: str | None) -> None:
    found = diagnose(PRACTICE / "campaigns" / f"practice-{number}", PRACTICE / "calibrations").document
    assert found["verdict"] == verdict
    if cause:
        assert (found["causes"][0]["effect"], found["causes"][0]["channels"]) == (cause, [gyro])
        assert len(found["causes"]) == 1
    if gyro:
        assert found["where"][0]["channels"] == [gyro]
