"""Plausible mistakes on a good run of a digital unit, which gives deg/s, about a level axis."""

import numpy as np
import pytest
from named import assert_named, in_turn


def another_raw_unit(name):
    def change(m):
        m.run["capture"]["raw_unit"] = name

    return change


def readings_times(factor):
    return lambda m: m.edit("capture.csv", lambda rows: rows * np.array([1.0, factor, factor, factor]))


DIGITAL_MISTAKES = {
    "read as rad/s": (another_raw_unit("rad/s"), "raw_unit|capture.csv: line 1"),
    "read as deg/h": (another_raw_unit("deg/h"), "raw_unit|capture.csv: line 1"),
    "read as increments": (another_raw_unit("deg"), "raw_unit|capture.csv: line 1"),
    "deg/h in the file": (readings_times(3600.0), "factor of 3600"),
    "rad/s in the file": (readings_times(np.pi / 180), r"factor of 57\.29"),
    "increments in the file": (readings_times(1 / 64), "factor"),
    "a thousandth too much": (readings_times(1.001), "commanded"),
    "axes x and y exchanged": (
        lambda m: m.edit("capture.csv", lambda r: r[:, [0, 2, 1, 3]]),
        "exchanged|axis",
    ),
    "axes turned round": (lambda m: m.edit("capture.csv", lambda r: r[:, [0, 2, 3, 1]]), "axis|exchanged"),
    "latitude without its sign": (lambda m: m.run["site"].update(latitude_deg=-48.137), "latitude"),
    "latitude transposed": (lambda m: m.run["site"].update(latitude_deg=41.837), "commanded|sine|latitude"),
    "azimuth off by 3 deg": (lambda m: m.run.update(azimuth_deg=34.0), "azimuth|commanded|sine"),
    "azimuth off by 2 deg": (lambda m: m.run.update(azimuth_deg=33.0), "azimuth|commanded|sine"),
    "x down": (lambda m: m.run.update(orientation={"z": "east", "x": "down"}), "orientation|sign|latitude"),
    "z west": (lambda m: m.run.update(orientation={"z": "west", "x": "up"}), "azimuth|orientation"),
}


#: One of each kind in the quick suite; the rest is marked slow.
QUICK = {"read as increments", "increments in the file", "latitude transposed"}


@pytest.mark.parametrize("name", in_turn(DIGITAL_MISTAKES, QUICK))
def test_a_mistake_with_a_digital_unit_is_named(digital, tmp_path, name):
    assert_named(digital, *DIGITAL_MISTAKES[name], tmp_path)


def test_of_the_good_digital_run_nothing_is_said(digital, tmp_path):
    assert digital.with_mistake(lambda m: None, tmp_path) == (0, "")
