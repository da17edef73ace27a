"""Logs beside a capture: read, interpolated as the contract says, and refused with the line at fault."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.datasets.logs import read_table_log, read_temperature
from fogreduce.errors import BadInput

TEMPERATURE = "time_s,electronics_degC,sensor_degC\n"
TABLE = "time_s,angle_deg\n"


def test_temperatures_between_rows_are_linear_and_hold_at_the_ends(tmp_path) -> None:
    path = tmp_path / "temperature.csv"
    path.write_text(TEMPERATURE + "1,30,20\n2,31,22\n4,32,20\n")
    log = read_temperature(path)
    np.testing.assert_allclose(
        log.sensor_at(np.array([-5, 1, 1.5, 2, 3, 4, 99])), [20, 20, 21, 22, 21, 20, 20]
    )
    np.testing.assert_array_equal(log.electronics_degC, [30, 31, 32])


def test_an_encoder_starts_from_nought(tmp_path) -> None:
    path = tmp_path / "table.csv"
    path.write_text(TABLE + "0,100\n10,460\n")
    angles = read_table_log(path).angle_at(np.array([0.0, 5.0, 10.0, 20.0]))
    np.testing.assert_allclose(np.degrees(angles), [0, 180, 360, 360])


@pytest.mark.parametrize(
    ("text", "where"),
    [
        ("", ""),
        ("time_s,sensor_degC\n0,1\n", "line 1"),
        (TEMPERATURE, "line 2"),
        (TEMPERATURE + "0,1\n", "line 2"),
        (TEMPERATURE + "0,1,2\n1,one,2\n", "line 3"),
        (TEMPERATURE + "0,1,2\n1,nan,2\n", "line 3"),
        (TEMPERATURE + "0,1,2\n1,1,2\n1,1,2\n", "line 4"),
        (TEMPERATURE + "5,1,2\n4,1,2\n", "line 3"),
        (TEMPERATURE + "0,1,2\n1,1,-300\n", "line 3"),
        (TEMPERATURE + "0,1,2\n1,2000,2\n", "line 3"),
    ],
)
def test_faults_have_their_line(tmp_path, text: str, where: str) -> None:
    path = tmp_path / "temperature.csv"
    path.write_text(text)
    with pytest.raises(BadInput) as error:
        read_temperature(path)
    assert (error.value.faults[0].file, error.value.faults[0].where) == (str(path), where)


def test_no_log_where_one_is_named(tmp_path) -> None:
    with pytest.raises(BadInput, match="No such file"):
        read_table_log(tmp_path / "table.csv")
    (tmp_path / "table.csv").write_bytes(b"\xff\xfe")
    with pytest.raises(BadInput, match="UTF-8"):
        read_table_log(tmp_path / "table.csv")
