"""The page: numbers with their errors, words for probabilities, drawings that hold what they should."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from fogreduce.diagnosis.report import svg
from fogreduce.diagnosis.report.figures import percent
from fogreduce.diagnosis.report.page import _number, _parameters


@pytest.mark.parametrize(
    ("value", "std", "text"),
    [
        (-0.26581, 0.01595, "-0.266 +- 0.016"),
        (-152168.0, 5319.0, "-152200 +- 5300"),
        (40.12, 1.04, "40.1 +- 1.0"),
        (5, 0.0, "5"),
        (1.5e-12, 1.2e-13, "1.5e-12 +- 1.2e-13"),
        ([0.1931, 0.0281], [0.0121, 0.0139], "[0.193 +- 0.012, 0.028 +- 0.014]"),
        ("gyro2", None, "gyro2"),
    ],
)
def test_numbers_to_what_their_errors_allow(value, std, text) -> None:
    assert _number(value, std) == text


def test_units_stand_with_sizes_and_what_is_far_off_is_said() -> None:
    cause = {"effect": "scale_factor_error", "parameters": {"ppm": {"value": -152168.0, "std": 5319.0}}}
    assert _parameters(cause, "V").startswith("-152200 +- 5300 ppm, (units of this class show ")


def test_no_probability_is_said_to_be_certain() -> None:
    assert percent(1.0) == "more than 99.9 %"
    assert percent(0.0) == "less than 0.1 %"
    assert percent(0.984) == "98.4 %"


def test_drawings_are_well_formed_and_lines_end_with_runs() -> None:
    values = np.arange(20.0)
    drawn = ET.fromstring(svg.traces([("gyro<1>", values, None)], [("a", 12), ("b", 8)], "deg/h", "x & y"))
    lines = [node for node in drawn.iter() if node.tag.endswith("polyline")]
    assert [len(line.get("points").split()) for line in lines] == [12, 8]
    cells = svg.grid(["gyro1", "gyro2"], ["a"], np.array([[9.0], [0.0]]), [["mean"], [""]], "map")
    words = [node.text for node in ET.fromstring(cells).iter() if node.tag.endswith("text")]
    assert words == ["a", "gyro1", "9 sigma", "mean", "gyro2"]
