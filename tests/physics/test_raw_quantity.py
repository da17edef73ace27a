"""Units of raw readings: names that columns and keys take from them, and what one deg/s is in each."""

import math

import pytest

from fogreduce.physics.raw_quantity import INCREMENTS, RAW_UNITS, UNITS_IN_USE, unit_in_use


@pytest.mark.parametrize(("increment", "rate"), [("deg", "deg/s"), ("rad", "rad/s")])
def test_increments_are_in_use_as_rates(increment, rate):
    assert unit_in_use(increment).name == rate


def test_every_unit_is_in_use_as_itself_but_for_increments():
    assert [name for name in RAW_UNITS if unit_in_use(name).name != name] == list(INCREMENTS)
    assert set(RAW_UNITS) == set(UNITS_IN_USE) | set(INCREMENTS)


def test_names_of_keys_tell_units_apart():
    names = [unit.scale_factor_key for unit in UNITS_IN_USE.values()]
    assert len(set(names)) == len(names)
    assert UNITS_IN_USE["V"].scale_factor_key == "scale_factor_V_per_deg_s"  # as the contract has it
    assert UNITS_IN_USE["V"].bias_key == "bias_V"


def test_an_ideal_digital_unit():
    """1 deg/s is 3600 deg/h and pi/180 rad/s; what a volt or a count is, no unit tells."""
    assert {name: unit.per_deg_s for name, unit in UNITS_IN_USE.items()} == {
        "V": None,
        "count": None,
        "deg/s": 1.0,
        "deg/h": 3600.0,
        "rad/s": math.pi / 180,
    }
