"""Captures that are odd but not bad: what is wrong is counted and located, nothing refused or dropped."""

import csv
import json

import numpy as np
import pytest
from small_lab import RECORDS, csv_lines, header, records

from fogreduce.cli.main import main


def reduce(lab, capsys) -> tuple[dict[str, int], dict]:
    """The counts of quality.csv and the report of ingest."""
    assert main(lab.reduce()) == 0
    said = capsys.readouterr()
    assert all(line.startswith(("warning: ", "red flag: ")) for line in said.err.splitlines())
    with (lab.out / "tables" / "quality.csv").open(newline="") as file:
        counts = {row["what"]: int(row["count"]) for row in csv.DictReader(file)}
    return counts, json.loads((lab.out / "reports" / "ingest.json").read_text())


def test_torn_record(small_lab, capsys):
    """A link that failed in the middle of the last record: 13 of its 28 bytes are there."""
    body = records().tobytes()
    small_lab.write_capture(header(), body[:-15])
    counts, report = reduce(small_lab, capsys)
    assert (counts["records"], counts["torn_bytes"], counts["lost"]) == (RECORDS - 1, 13, 1)
    assert report["torn_at"] == f"byte {64 + 28 * (RECORDS - 1)}"


def test_torn_line(small_lab, capsys):
    path = small_lab.write_csv(csv_lines())
    path.write_bytes(path.read_bytes()[:-25])
    counts, report = reduce(small_lab, capsys)
    assert counts["records"] == RECORDS - 1
    assert counts["torn_bytes"] > 0
    assert report["torn_at"] == f"line {RECORDS + 1}"


def test_lost_repeated_and_late_records(small_lab, capsys):
    """Records 100 to 104 lost, 200 twice, 300 and 301 in the wrong order."""
    good = records()
    order = [*range(100), *range(105, 201), 200, *range(201, 300), 301, 300, *range(302, RECORDS)]
    small_lab.write_capture(header(), good[order].tobytes())
    counts, report = reduce(small_lab, capsys)
    assert (counts["lost"], counts["repeated"], counts["out_of_order"]) == (5, 1, 1)
    assert report["lost_places"] == [{"first_pulse": 100, "pulses": 5}]
    assert [place["pulse"] for place in report["places"]["repeated"]] == [200]
    assert [place["pulse"] for place in report["places"]["out_of_order"]] == [300]


def test_missing_answers_and_a_spurious_count(small_lab, capsys):
    odd = records()
    odd["counts"][[10, 20, 30], [0, 0, 3]] = -(2**31)
    odd["counts"][500, 1] = 2**30
    small_lab.write_capture(header(), odd.tobytes())
    counts, report = reduce(small_lab, capsys)
    assert (counts["missing_gyro1"], counts["missing_gyro4"], counts["spurious_gyro2"]) == (2, 1, 1)
    assert [place["pulse"] for place in report["places"]["spurious_gyro2"]] == [500]


def test_stamps_that_contradict_the_pulses(small_lab, capsys):
    """Record 400 is stamped an hour late, record 401 with the largest number that the field holds."""
    odd = records()
    odd["time"][400] += 3_600_000_000
    odd["time"][401] = 2**64 - 1
    small_lab.write_capture(header(), odd.tobytes())
    counts, _ = reduce(small_lab, capsys)
    assert counts["bad_stamp"] == 2
    assert counts["records"] == RECORDS


def test_longer_and_shorter_than_the_profile(small_lab, capsys):
    small_lab.write_capture(header(), records(RECORDS + 7).tobytes())
    assert reduce(small_lab, capsys)[0]["beyond_profile"] == 7
    small_lab.write_capture(header(), records(RECORDS - 7).tobytes())
    assert reduce(small_lab, capsys)[0]["lost"] == 7


@pytest.mark.parametrize("count", [1, 2, 4])
def test_hardly_a_record(small_lab, capsys, count):
    """Too few for a curve of four coefficients: refused, nothing left behind."""
    small_lab.write_capture(header(), records(count).tobytes())
    assert main(small_lab.reduce()) == 2
    assert f"found {count} usable of {count} records; expected at least 5 usable" in capsys.readouterr().err
    assert not small_lab.out.exists()


def test_just_enough_records(small_lab, capsys):
    small_lab.write_capture(header(), records(5).tobytes())
    assert reduce(small_lab, capsys)[0]["records"] == 5


def test_a_gyro_that_never_answers(small_lab, capsys):
    """x, y and z need all four, so their rows are empty; the other gyros have theirs."""
    silent = records()
    silent["counts"][:, 2] = -(2**31)
    small_lab.write_capture(header(), silent.tobytes())
    counts, _ = reduce(small_lab, capsys)
    assert counts["missing_gyro3"] == RECORDS
    with (small_lab.out / "tables" / "gyro_fit.csv").open(newline="") as file:
        fitted = [bool(row["a_V"]) for row in csv.DictReader(file)]
    assert fitted == [True, True, False, True]
    with (small_lab.out / "tables" / "drift.csv").open(newline="") as file:
        assert [row["drift_deg_h"] for row in csv.DictReader(file)] == ["", "", ""]


def test_random_bytes_as_records(small_lab, capsys):
    """A body of noise: none of it belongs to the run's pulses, so nothing is usable, and it is refused."""
    body = np.random.default_rng(5).bytes(28 * RECORDS)
    small_lab.write_capture(header(), body)
    assert main(small_lab.reduce()) == 2
    assert "time stamps: found stamps from" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "found"),
    [
        ("nan,1,2,3,4", "time_s nan"),
        ("6.25,1,inf,3,4", "infinity"),
        ("abc,1,2,3,4", "time_s abc"),
        (",1,2,3,4", "time nan"),
    ],
)
def test_a_csv_line_that_is_no_record(small_lab, capsys, line, found):
    """Found by `check` as by `reduce`, which leaves no folder behind."""
    lines = csv_lines()
    lines[100] = line
    path = small_lab.write_csv(lines)
    expected = f"{path}: line 101: found {found}; expected a time [s] and 4 readings "
    expected += "(finite numbers, or none for no answer)\n"
    assert main(["check", str(small_lab.run), "--calibrations", str(small_lab.calibrations)]) == 2
    assert capsys.readouterr().err == expected
    assert main(small_lab.reduce()) == 2
    assert capsys.readouterr().err == expected
    assert not small_lab.out.exists()
    (small_lab.out / "mine").mkdir(parents=True)
    assert main(small_lab.reduce()) == 2
    assert [path.name for path in small_lab.out.iterdir()] == ["mine"]
