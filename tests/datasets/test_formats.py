"""Every format, unit and convention of time: the file's own numbers come out, whatever the blocks' size.

The expected numbers are those that went into the file, written by each format's own library.
"""

import numpy as np
import pytest
from laboratory_files import CASES, DEG, LEAST_DEG_S, RATE_HZ, RECORDS, UNIX_S, recording

from fogreduce.datasets.readers import open_capture
from fogreduce.errors import BadInput
from fogreduce.metadata.capture import CaptureInfo

XYZ, NUMBERS = "xyz", "123"


def columns(time, pattern, letters=XYZ):
    gyros = [pattern.format(letter) for letter in letters]
    return {"gyros": gyros} if time is None else {"time": time, "gyros": gyros}


UNIX, GPS = ({"unit": "s", "epoch": epoch} for epoch in ("unix", "gps"))
ISO, MS, US = ({"unit": unit} for unit in ("iso8601", "ms", "us"))

#: What run.yaml says of each file.
KEYS = {
    "plain": {"columns": columns("t", "g{} [deg/s]")},
    "german": {
        "columns": columns("Zeit [s]", "Drehrate {} [°/s]", "XYZ"),
        "text": {"delimiter": ";", "decimal": ",", "comment": "#"},
    },
    "latin_1": {
        "columns": columns("Time (ms)", "Rate {} (°/s)", "XYZ"),
        "time": MS,
        "text": {"delimiter": "\t", "encoding": "latin-1"},
    },
    "packed_without_header": {
        "columns": {"time": 2, "gyros": [3, 4, 5]},
        "time": MS,
        "text": {"delimiter": "whitespace", "header": False},
    },
    "dates": {"columns": columns("timestamp", "gyro_{}_dps"), "time": ISO},
    "dates_with_blank": {"columns": columns("time", "w{}_deg_s"), "time": ISO},
    "unix_seconds": {"columns": columns("unix_time", "gyro_{} (rad/s)"), "time": UNIX},
    "ros": {
        "columns": columns("header.stamp", "angular_velocity.{}"),
        "time": {"unit": "ns", "epoch": "unix"},
    },
    "gps_seconds": {
        "columns": columns("gps_time_s", "gyro_{}_deg_h"),
        "time": GPS,
        "text": {"delimiter": " "},
    },
    "counter": {
        "columns": columns("ticks", "gyro{}_count", NUMBERS),
        "time": {"unit": "ticks", "tick_s": 1e-4},
        "time_zero": "first",
    },
    "no_time": {"columns": columns(None, "g{}_dps")},
    "preamble": {
        "columns": columns("Time", "G{}"),
        "text": {"delimiter": ";", "skip_lines": 4, "skip_below_header": 1},
    },
    "wide": {"columns": columns("time [s]", "omega_{} [deg/s]")},
    "increments": {"columns": columns("time_us", "dtheta_{} [rad]"), "time": US},
    "hdf5": {"columns": columns("time", "gyro[{}]", NUMBERS), "dataset": "/imu"},
    "matlab_5": {"columns": columns("rec.t", "rec.rate_dps.w{}")},
    "matlab_73": {"columns": columns("data.time_ms", "data.gyro_deg_h[{}]", NUMBERS), "time": MS},
    "npy": {"columns": {"time": 1, "gyros": [2, 3, 4]}},
    "npy_fields": {"columns": columns("stamp_us", "gyro[{}]", NUMBERS), "time": US},
    "npz": {"columns": columns("time_s", "dtheta_deg[{}]", NUMBERS)},
    "tdms": {"columns": columns(None, "Gyro {}", "XYZ"), "dataset": "Rates"},
    "parquet": {"columns": columns("time", "rate_{}_deg_h"), "time": ISO},
}
#: deg/s that one of a unit is.
DEG_S = {
    **{"deg/s": 1.0, "rad/s": 1 / DEG, "deg/h": 1 / 3600, "count": LEAST_DEG_S},
    **{"deg": RATE_HZ, "rad": RATE_HZ / DEG},
}


def capture_of(case, path, **more):
    data = {
        "file": path.name,
        "format": case.format,
        "sample_rate_hz": RATE_HZ,
        "raw_unit": case.raw_unit,
        "least_count": 1e-6,
        "polarity": [1, 1, 1],
        **KEYS[str(case)],
        **more,
    }
    return CaptureInfo.from_data(data, "run.yaml").model_dump(mode="json", exclude_none=True)


@pytest.mark.parametrize("size", [333, 65536])
@pytest.mark.parametrize("case", CASES, ids=str)
def test_numbers_come_out_as_they_went_in(case, size, tmp_path):
    data = recording()
    path = case.write(tmp_path, data)
    reader = open_capture(path, capture_of(case, path), UNIX_S * 1_000_000)
    assert (reader.n_records, reader.torn_bytes, reader.facts.n_gyros) == (RECORDS, 0, 3)
    blocks = list(reader.blocks(size))
    assert [block.start for block in blocks] == list(range(0, RECORDS, size))
    np.testing.assert_array_equal(np.concatenate([block.time_us for block in blocks]), data.time_us)
    values = np.concatenate([block.values for block in blocks], axis=1) * DEG_S[case.raw_unit]
    np.testing.assert_allclose(values, data.deg_s, rtol=1e-12, atol=1.0001 * case.half_digit_deg_s)


@pytest.mark.parametrize("case", CASES, ids=str)
def test_a_file_of_another_kind_is_one_line(case, tmp_path):
    path = case.write(tmp_path, recording())
    capture = capture_of(case, path)
    whole = path.read_bytes()
    for damaged in (b"", b"\x00\x01\x02" * 50, whole[: len(whole) // 3]):
        path.write_bytes(damaged)
        read, faults = records_of(path, capture)
        if faults:
            assert faults[0].file.startswith(str(tmp_path))
        else:  # a text cut short is a shorter text
            assert case.format == "table"
            assert 0 < read < RECORDS


def records_of(path, capture):
    """How many records are read, and the faults that end it."""
    try:
        reader = open_capture(path, capture, UNIX_S * 1_000_000)
        return sum(block.time_us.size for block in reader.blocks(1000)), ()
    except BadInput as error:
        return 0, error.faults


@pytest.mark.parametrize("case", CASES, ids=str)
def test_a_column_that_is_not_there_is_named(case, tmp_path):
    path = case.write(tmp_path, recording())
    wrong = {
        **KEYS[str(case)]["columns"],
        "gyros": ["no such column", *KEYS[str(case)]["columns"]["gyros"][1:]],
    }
    with pytest.raises(BadInput) as error:
        open_capture(path, capture_of(case, path, columns=wrong), UNIX_S * 1_000_000)
    fault = error.value.faults[0]
    assert (fault.where, fault.found) == ("capture.columns.gyros[0]", "no such column")
