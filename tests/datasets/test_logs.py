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
        ("time_s,cabin_degC\n0,1\n", "line 1"),
        ("sensor_degC\n1\n", "line 1"),
        (TEMPERATURE, "line 2"),
        (TEMPERATURE + "0,1\n", "line 2"),
        (TEMPERATURE + "0,1,2\n1,one,2\n", "line 3"),
        (TEMPERATURE + "0,1,2\n1,nan,2\n", "line 3"),
        (TEMPERATURE + "0,1,2\n1,1_0,2\n", "line 3"),
        (TEMPERATURE + "0,1,2\n1,٣,2\n", "line 3"),
        (TEMPERATURE + "0,1,2\n1,inf,2\n", "line 3"),
        (TEMPERATURE + "0,1,2\n1,1e999,2\n", "line 3"),
        (TEMPERATURE + "0,1,2\n1,0x1,2\n", "line 3"),
        (TEMPERATURE + "0,1,2\n1,,2\n", "line 3"),
        (TEMPERATURE + "0,1,2\n\n1,one,2\n", "line 4"),
        (TEMPERATURE + "0,1,2\r1,one,2\r", "line 3"),
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


@pytest.mark.parametrize(
    "text",
    [
        "\ufeff" + TEMPERATURE + "0,30,20\n1.5,31,22\n",
        TEMPERATURE + "0,30,20\n1.5,31,22",
        TEMPERATURE + "0,30,20\n1.5,31,22\n\n \n",
        (TEMPERATURE + "0,30,20\n1.5,31,22\n").replace("\n", "\r\n"),
        (TEMPERATURE + "0,30,20\n1.5,31,22\n").replace("\n", "\r"),
        (TEMPERATURE + "0,30,20\n1.5,31,22\n").replace(",", ", "),
        (TEMPERATURE + "0,30,20\n1.5,31,22\n").replace(",", " ,"),
        '"time_s","electronics_degC","sensor_degC"\n"0","30","20"\n"1.5","31","22"\n',
        TEMPERATURE + "0,+30.,2E1\n15e-1,31,.22e+2\n",
    ],
    ids=["mark", "no end", "blank lines", "CRLF", "CR", "spaces", "spaces before", "quotes", "exponents"],
)
def test_what_spreadsheets_write_is_read(tmp_path, text: str) -> None:
    path = tmp_path / "temperature.csv"
    path.write_bytes(text.encode())
    log = read_temperature(path)
    np.testing.assert_array_equal(log.time_s, [0, 1.5])
    np.testing.assert_array_equal(log.electronics_degC, [30, 31])
    np.testing.assert_array_equal(log.sensor_degC, [20, 22])
    path.write_bytes(text.replace("electronics_degC", "angle_deg").encode())
    with pytest.raises(BadInput, match="time_s,angle_deg"):
        read_table_log(path)


def test_one_temperature_is_enough(tmp_path) -> None:
    """It is the sensors'; the electronics' own is there only where it was logged."""
    path = tmp_path / "temperature.csv"
    path.write_text("time_s,sensor_degC\n0,20\n2,22\n")
    log = read_temperature(path)
    assert log.electronics_degC is None
    np.testing.assert_array_equal(log.sensor_at(np.array([1.0])), [21])
    path.write_text("time_s,electronics_degC\n0,30\n2,32\n")
    log = read_temperature(path)
    np.testing.assert_array_equal(log.electronics_degC, [30, 32])
    np.testing.assert_array_equal(log.sensor_at(np.array([1.0])), [31])


def test_no_log_where_one_is_named(tmp_path) -> None:
    with pytest.raises(BadInput, match="No such file"):
        read_table_log(tmp_path / "table.csv")
    (tmp_path / "table.csv").write_bytes(b"\xff\xfe")
    with pytest.raises(BadInput, match="UTF-8"):
        read_table_log(tmp_path / "table.csv")
