"""Tracing cells of gyro_fit.csv, whose columns name the unit of the raw readings."""

import pytest

from fogreduce.physics.raw_quantity import UNITS_IN_USE
from fogreduce.provenance.cell import error_columns, standard_uncertainty
from fogreduce.stages.tables import gyro_fit_columns


@pytest.mark.parametrize("name", UNITS_IN_USE)
def test_errors_stand_beside_every_parameter(name):
    unit = UNITS_IN_USE[name]
    header = gyro_fit_columns(unit)
    for letter, of in (("a", unit.suffix), ("b", unit.suffix), ("d", "rad"), ("e", unit.slope_suffix)):
        names = [f"{letter}_err_{kind}{of}" for kind in ("", "coloured_", "combined_")]
        assert error_columns(f"{letter}_{of}", header) == names
        row = dict.fromkeys(header, "") | {names[0]: "2.5", names[1]: "9"}
        assert standard_uncertainty(f"{letter}_{of}", row) == 2.5
    assert error_columns("c_rad_s", header) == []
