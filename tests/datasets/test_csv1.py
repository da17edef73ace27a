"""csv-1: fields missing, lines lost, stamps wrong, and malformed lines with their numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fogreduce.datasets.readers import open_capture
from fogreduce.datasets.readers.csv1 import CsvReader
from fogreduce.errors import BadInput

HEADER = "time_s,gyro1_V,gyro2_V"
LINES = ["0.000000,0.1,-0.2", "0.500000,,1e-7", "1.000000,0.3,", "1.500000,-0.25,0.000012345678901234"]


def write(path: Path, *lines: str, end: str = "\n") -> Path:
    path.write_text("\n".join([HEADER, *lines]) + end)
    return path


@pytest.fixture
def capture(tmp_path) -> Path:
    return write(tmp_path / "capture.csv", *LINES)


@pytest.mark.parametrize("size", [1, 3, 100])
@pytest.mark.parametrize("end", ["\n", ""])
@pytest.mark.parametrize("break_", ["\n", "\r\n"])
def test_a_file_by_hand(tmp_path, size: int, end: str, break_: str) -> None:
    """An empty field is no answer; the last line may lack its end; volts to the last bit."""
    path = tmp_path / "capture.csv"
    path.write_bytes((break_.join([HEADER, *LINES]) + end).encode())
    reader = CsvReader(path, {"sample_rate_hz": 2.0}, 0)
    assert (reader.facts.n_gyros, reader.n_records, reader.torn_bytes) == (2, 4, 0)
    blocks = list(reader.blocks(size))
    np.testing.assert_array_equal(
        np.concatenate([b.time_us for b in blocks]), [0, 500_000, 1_000_000, 1_500_000]
    )
    assert all(block.pulse is None for block in blocks)  # the format numbers no records
    volts = np.concatenate([b.values for b in blocks], axis=1)
    expected = [[0.1, np.nan, 0.3, -0.25], [-0.2, 1e-7, np.nan, 0.000012345678901234]]
    np.testing.assert_array_equal(volts, expected)
    assert all(block.counts is None for block in blocks)


def test_a_torn_last_line_is_not_a_record(tmp_path) -> None:
    path = write(tmp_path / "capture.csv", *LINES[:2], "1.000", end="")
    reader = CsvReader(path, {"sample_rate_hz": 2.0}, 0)
    assert (reader.n_records, reader.torn_bytes) == (2, 5)
    assert [block.time_us.size for block in reader.blocks(10)] == [2]
    assert reader.place(reader.n_records) == "line 4"


@pytest.mark.parametrize(
    "line",
    [
        "0.5,1",
        "0.5,1,2,3",
        "0.5,one,2",
        ",1,2",
        "0.5,nan,2",
        "0.5,inf,2",
        "nan,1,2",
        "1e13,1,2",
        "0.5,1_0,2",
        "0.5,١,2",
        "0.5;1;2",
        "0.5,1,0x10",
    ],
)
@pytest.mark.parametrize("size", [1, 100])
def test_a_malformed_line_is_named(tmp_path, line: str, size: int) -> None:
    path = write(tmp_path / "capture.csv", LINES[0], line, *LINES[2:])
    with pytest.raises(BadInput) as error:
        list(CsvReader(path, {"sample_rate_hz": 2.0}, 0).blocks(size))
    (fault,) = error.value.faults
    assert fault.where == "line 3"
    assert "2 readings" in fault.expected


@pytest.mark.parametrize(
    ("header", "where"),
    [
        ("", ""),
        ("time_s\n", "line 1"),
        ("time,gyro1_V\n", "line 1"),
        ("time_s,gyro2_V,gyro1_V\n", "line 1"),
        ("time_s,gyro1_V,gyro2_V\n", "line 2"),
        ("FOGCAP1\n", "line 1"),
    ],
)
def test_a_header_that_is_not_one(tmp_path, header: str, where: str) -> None:
    path = tmp_path / "capture.csv"
    path.write_text(header)
    with pytest.raises(BadInput) as error:
        open_capture(path, {"format": "csv-1", "sample_rate_hz": 2.0}, 0)
    assert error.value.faults[0].where == where


def test_bytes_that_are_no_text(tmp_path) -> None:
    path = tmp_path / "capture.csv"
    path.write_bytes(b"time_s,gyro1_V\n0.0,1.0\n0.5,\xff\xfe\n")
    with pytest.raises(BadInput, match="line 3"):
        list(CsvReader(path, {"sample_rate_hz": 2.0}, 0).blocks(10))
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(BadInput, match="not UTF-8"):
        CsvReader(path, {"sample_rate_hz": 2.0}, 0)


@pytest.mark.parametrize(
    "text",
    [
        "\ufefftime_s,gyro1_V,gyro2_V\n0,1,2\n0.5,3,4\n",  # a byte order mark
        "time_s,gyro1_V,gyro2_V\n0,1,2\n0.5,3,4\n\n",  # a blank last line
        "time_s,gyro1_V,gyro2_V\n0,1,2\n\n0.5,3,4\n",  # or one between
        '"time_s","gyro1_V","gyro2_V"\n"0","1","2"\n"0.5","3","4"\n',
        "time_s, gyro1_V, gyro2_V\n0, 1, 2\n0.5, 3, 4\n",
        "time_s,gyro1_V,gyro2_V\r0,1,2\r0.5,3,4\r",  # carriage returns alone
    ],
)
def test_what_other_programs_write_is_read(tmp_path, text: str) -> None:
    path = tmp_path / "capture.csv"
    path.write_bytes(text.encode())
    reader = CsvReader(path, {"sample_rate_hz": 2.0}, 0)
    assert reader.n_records == 2
    (block,) = reader.blocks(10)
    assert block.time_us.tolist() == [0, 500_000]
    assert block.values.tolist() == [[1, 3], [2, 4]]
