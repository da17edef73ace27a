"""The page: numbers with their errors, words for probabilities, drawings that hold what they should."""

from __future__ import annotations

import xml.etree.ElementTree as ET

import numpy as np
import pytest

from fogreduce.diagnosis.report.figures import waterfall
from fogreduce.diagnosis.report.page import links_back, runs_named
from fogreduce.diagnosis.report.words import announced, headline, percent, sizes
from fogreduce.pages import svg


def test_units_stand_with_sizes_and_what_is_far_off_is_said() -> None:
    cause = {"effect": "scale_factor_error", "parameters": {"ppm": {"value": -152168.0, "std": 5319.0}}}
    (said,) = sizes(cause, "V")
    assert said.startswith("\N{MINUS SIGN}152200 \N{PLUS-MINUS SIGN} 5300 ppm (units of this class show ")


def test_a_tip_is_a_size_and_a_direction_and_a_field_has_a_direction_in_the_room() -> None:
    tip = {"value": [0.3, 0.0, 0.4], "std": [0.4, 0.4, 0.4], "size": 0.5, "size_std": 0.021}
    tip["direction"] = [0.6, 0.0, 0.8]
    cause = {"effect": "axis_misalignment", "parameters": {"mrad": tip}}
    assert sizes(cause, "V") == ["0.500 \N{PLUS-MINUS SIGN} 0.021 mrad toward (0.60, 0.00, 0.80) in x, y, z"]
    field = {"value": [1.0, 0.0, -1.0], "std": None}
    cause = {
        "effect": "magnetic_bias",
        "parameters": {"deg_h": {"value": 1.0, "std": 0.1}, "field_direction": field},
    }
    assert sizes(cause, "V")[1] == "toward azimuth 90 deg, 45 deg down"


def test_a_group_is_announced_as_a_group() -> None:
    members = [
        {"effect": effect, "channels": ["gyro4"], "runs": ["*"], "probability": p}
        for effect, p in (("temperature_bias", 0.394), ("warm_up", 0.394), ("bias_ramp", 0.2))
    ]
    found = {"verdict": "explained", "mistakes": []}
    found["causes"] = [{**members[0], "group": members, "parameters": {}}]
    assert headline(found) == "one of 3 causes explains the gap; these runs cannot tell which"
    assert announced(found) == (
        "explained: one of temperature bias of gyro4 (39.4 %), warm up of gyro4 (39.4 %), "
        "bias ramp of gyro4 (20.0 %)"
    )
    found["causes"][0]["group"] = members[:1]
    assert headline(found) == "temperature bias of gyro4 explains the gap"


def test_no_probability_is_said_to_be_certain() -> None:
    assert percent(1.0) == "more than 99.9 %"
    assert percent(0.0) == "less than 0.1 %"
    assert percent(0.984) == "98.4 %"


def test_drawings_are_well_formed_and_lines_end_with_runs() -> None:
    values = np.arange(20.0)
    drawn = ET.fromstring(svg.traces([("gyro<1>", values, None)], [("a", 12), ("b", 8)], "deg/h", "x & y"))
    lines = [node for node in drawn.iter() if node.tag.endswith("polyline")]
    assert [len(line.get("points").split()) for line in lines] == [12, 8]
    # a slim map has no room for words, but for numbers
    slim = svg.grid(
        ["gyro1"], ["a", "b", "c", "d", "e", "f"], np.full((1, 6), 9.0), [["harmonic 1"] * 6], "m", 366
    )
    assert "harmonic" not in slim
    assert slim.count(">9<") == 6
    cells = svg.grid(["gyro1", "gyro2"], ["a"], np.array([[9.0], [0.0]]), [["mean"], [""]], "map")
    words = [node.text for node in ET.fromstring(cells).iter() if node.tag.endswith("text")]
    assert words == ["a", "gyro1", "9 sigma", "mean", "gyro2"]


def test_in_the_results_the_page_links_back_to_campaign_and_runs() -> None:
    found = {"campaign": "c", "runs": ["r<1>", "r2"]}
    assert 'href="../index.html"' in links_back(found)
    assert '<a href="../r2/index.html">r2</a>' in runs_named(found, True)
    assert runs_named(found, False) == "Runs: r&lt;1&gt;, r2."


def test_a_waterfall_goes_from_the_gap_down_to_noise() -> None:
    """0.7 and 0.28 of a gap of 900 over 100 of noise: bars end where the next ones begin."""
    kinds = [{"effect": "bias_offset", "cumulative": 0.7}, {"effect": "bias_ramp", "cumulative": 0.98}]
    closure = {"before": 1000.0, "expected_if_closed": 100.0, "fraction": 0.98, "std": 0.012, "kinds": kinds}
    causes = [{"effect": "bias_offset"}, {"effect": "bias_offset"}, {"effect": "bias_ramp"}]
    rows = waterfall({"closure": closure, "causes": causes})
    ends = [(row.start, row.end) for row in rows]
    expected = [(0.0, 1.0), (1.0, 0.37), (0.37, 0.118), (0.0, 0.1), (0.1, 0.118)]
    assert ends == [pytest.approx(pair) for pair in expected]
    assert [row.text for row in rows[1:3]] == ["\N{MINUS SIGN}70.0 %", "\N{MINUS SIGN}28.0 %"]
    assert rows[-1].text == "2.0 \N{PLUS-MINUS SIGN} 1.2 %"
    assert waterfall({"closure": closure, "causes": causes[:1]}) == []
    for width in (svg.WIDE, svg.SLIM):
        drawn = ET.fromstring(svg.steps(rows, "a waterfall", width, mark=0.1))
        bars = [r for r in drawn.iter("{http://www.w3.org/2000/svg}rect") if r.get("fill") == svg.AFTER]
        assert float(bars[0].get("x")) == pytest.approx(
            float(bars[1].get("x")) + float(bars[1].get("width")), abs=0.11
        )
