"""A ring laser gyro's own recording: its heading is found beside its dither lines."""

from __future__ import annotations

import pytest

from fogreduce.diagnosis.diagnose import diagnose


@pytest.mark.slow
def test_heading_beside_the_lines_of_a_dithered_gyro(shared) -> None:
    """README of the recording: mean rates z of 1.250 and -0.726 with x up and down; half their difference
    over Earth's horizontal rate of 9.4 deg/h is a heading of 6.0 degrees.
    """
    root = shared / "real"
    found = diagnose(root / "campaigns/ln100", root / "calibrations").document
    (heading,) = [c for c in found["causes"] if c["effect"] == "heading_error"]
    stated = heading["parameters"]["deg"]
    assert abs(stated["value"] - 6.0) < 2.0 * stated["std"] < 3.0
    lines = [
        c["parameters"]["frequency_hz"]["value"] for c in found["causes"] if "frequency_hz" in c["parameters"]
    ]
    assert any(abs(hz - 29.92) < 0.1 for hz in lines)
