"""Faults of raw captures, of both formats."""

import math
import os

from fault_case import Case
from small_lab import START_US, csv_lines, header, records

A_LINE = "a time [s] and 4 readings (finite numbers, or none for no answer)"


def _head(**changes):
    return lambda lab: lab.write_capture(header(**changes))


def _bytes(data):
    return lambda lab: lab.capture.write_bytes(data)


def _csv(line: int, text: str):
    """Line `line` of a csv-1 capture replaced."""

    def spoil(lab):
        lines = csv_lines()
        lines[line - 1] = text
        lab.write_csv(lines)

    return spoil


def _folder(lab):
    lab.capture.unlink()
    lab.capture.mkdir()


def _link_out(lab):
    outside = lab.root / "elsewhere.fogcap"
    lab.capture.rename(outside)
    lab.capture.symlink_to(outside)


def _pipe(lab):
    lab.capture.unlink()
    os.mkfifo(lab.capture)


def _torn_in_the_middle(lab):
    lines = csv_lines()
    lines[6] = lines[6][:9]
    lab.write_csv(lines)


def _csv_bytes(lab):
    lab.write_csv(csv_lines()).write_bytes(b"\xff\xfe" * 40)


FOGCAP = [
    Case(
        "truncated header",
        _bytes(header()[:40]),
        "$capture: byte 40: found the end of the file; expected a header of 64 bytes",
    ),
    Case(
        "wrong magic",
        _head(magic=b"FOGCAP2\n"),
        r"$capture: byte 0: found b'FOGCAP2\n'; expected the magic b'FOGCAP1\n' of fogcap-1",
    ),
    Case("header length", _head(length=32), "$capture: byte 8: found header length 32; expected 64"),
    Case("no gyro", _head(n=0), "$capture: byte 12: found 0 gyros; expected at least 1"),
    Case(
        "record length",
        _head(record=29),
        "$capture: byte 14: found record length 29; expected 28 for 4 gyros",
    ),
    Case(
        "rate NaN",
        _head(rate=math.nan),
        "$capture: byte 16: found sample rate nan Hz; expected 0.01 to 10000 Hz",
    ),
    Case(
        "rate out of range",
        _head(rate=1e5),
        "$capture: byte 16: found sample rate 100000.0 Hz; expected 0.01 to 10000 Hz",
    ),
    Case(
        "volts per count zero",
        _head(volts=0.0),
        "$capture: byte 24: found 0.0 volts per count; expected a positive number",
    ),
    Case(
        "unit name not ASCII",
        _head(unit=b"\xe9"),
        r"$capture: byte 40: found unit name b'\xe9'; expected ASCII characters, padded with NUL",
    ),
    Case(
        "two faults of a header",
        _head(length=32, rate=-1.0),
        "$capture: byte 8: found header length 32; expected 64\n"
        "$capture: byte 16: found sample rate -1.0 Hz; expected 0.01 to 10000 Hz",
    ),
    Case("empty file", _bytes(b""), "$capture: found an empty file; expected a fogcap-1 capture"),
    Case(
        "header only",
        _bytes(header()),
        "$capture: byte 64: found no whole record; expected at least one record",
    ),
    Case(
        "one torn record only",
        _bytes(header() + records(1).tobytes()[:27]),
        "$capture: byte 64: found no whole record; expected at least one record",
    ),
    Case(
        "header's rate against run.yaml",
        _head(rate=32.0),
        "$capture: header: found sample rate 32.0; expected 16.0, as capture.sample_rate_hz of run.yaml says",
    ),
    Case(
        "header's volts against run.yaml",
        _head(volts=2e-7),
        "$capture: header: found volts per count 2e-07; "
        "expected 1e-07, as capture.volts_per_count of run.yaml says",
    ),
    Case(
        "capture of another unit",
        _head(unit=b"TETRA-02"),
        "$capture: header: found unit TETRA-02; expected TETRA-01, as unit of run.yaml says",
    ),
    Case(
        "header's start against run.yaml",
        _head(start=START_US + 1_000_000),
        "$capture: header: found start 2014-05-12T13:00:01+00:00; "
        "expected 2014-05-12T13:00:00+00:00, as started_at of run.yaml says",
    ),
    Case(
        "capture of three gyros",
        lambda lab: lab.write_capture(header(n=3), records(n=3).tobytes()),
        "$capture: header: found number of gyros 3; expected 4, as capture.polarity of run.yaml says",
    ),
    Case(
        "a directory in the capture's place",
        _folder,
        "$yaml: capture.file: found capture.fogcap, which is a folder; "
        "expected a file in the run's own folder",
    ),
    Case(
        "a pipe in the capture's place",
        _pipe,
        "$yaml: capture.file: found capture.fogcap, which is not a file; "
        "expected a file in the run's own folder",
    ),
    Case(
        "no capture",
        lambda lab: lab.capture.unlink(),
        "$yaml: capture.file: found capture.fogcap, which is not there; "
        "expected a file in the run's own folder",
    ),
    Case(
        "a link out of the folder",
        _link_out,
        "$yaml: capture.file: found capture.fogcap, a link that leaves the folder; "
        "expected a file in the run's own folder",
    ),
    Case(
        "unknown format",
        lambda lab: lab.write_run({"capture.format": "fogcap-9"}),
        "$yaml: capture.format: found fogcap-9; expected one of fogcap-1, csv-1, "
        "table, hdf5, mat, npy, npz, tdms, parquet",
    ),
]

CSV = [
    Case(
        "a CSV that says it is fogcap-1",
        lambda lab: lab.capture.write_text("\n".join(csv_lines())),
        "$capture: byte 0: found b'time_s,g'; expected the magic b'FOGCAP1\\n' of fogcap-1",
    ),
    Case(
        "a fogcap-1 that says it is csv-1",
        lambda lab: lab.write_run({"capture.format": "csv-1"}),
        "$capture: line 2: found bytes that are not UTF-8; expected text",
    ),
    Case(
        "wrong header (csv-1)",
        _csv(1, "time,gyro1_V,gyro2_V,gyro3_V,gyro4_V"),
        "$run/capture.csv: line 1: found time,gyro1_V,gyro2_V,gyro3_V,gyro4_V; "
        "expected time_s,gyro1_V,...,gyroN_V",
    ),
    Case(
        "three gyros (csv-1)",
        lambda lab: lab.write_csv([line.rpartition(",")[0] for line in csv_lines()]),
        "$run/capture.csv: header: found number of gyros 3; expected 4, as capture.polarity of run.yaml says",
    ),
    Case(
        "text for a number (csv-1)",
        _csv(500, "31.125,1,2,x,4"),
        f"$run/capture.csv: line 500: found gyro3_V x; expected {A_LINE}",
    ),
    Case(
        "too few fields",
        _csv(7, "0.3125,1,2,3"),
        f"$run/capture.csv: line 7: found 0.3125,1,2,3; expected {A_LINE}",
    ),
    Case(
        "a header that does not fit its records",
        _csv(1, "time_s,gyro1_V,gyro2_V,gyro3_V"),
        "$run/capture.csv: line 1: found time_s,gyro1_V,gyro2_V,gyro3_V,5; "
        "expected time_s,gyro1_V,...,gyroN_V",
    ),
    Case(
        "a line torn in the middle of the file",
        _torn_in_the_middle,
        f"$run/capture.csv: line 7: found 0.312500,; expected {A_LINE}",
    ),
    Case(
        "too many fields",
        _csv(7, "0.3125,1,2,3,4,5"),
        f"$run/capture.csv: line 7: found 0.3125,1,2,3,4,5; expected {A_LINE}",
    ),
    Case("no time", _csv(9, ",1,2,3,4"), f"$run/capture.csv: line 9: found time nan; expected {A_LINE}"),
    Case(
        "time NaN", _csv(9, "nan,1,2,3,4"), f"$run/capture.csv: line 9: found time_s nan; expected {A_LINE}"
    ),
    Case(
        "infinite volts",
        _csv(9, "0.4375,1,inf,3,4"),
        f"$run/capture.csv: line 9: found infinity; expected {A_LINE}",
    ),
    Case(
        "header only (csv-1)",
        lambda lab: lab.write_csv(csv_lines(0)),
        "$run/capture.csv: line 2: found no record; expected at least one record",
    ),
    Case("not text", _csv_bytes, "$run/capture.csv: line 1: found bytes that are not UTF-8; expected text"),
]
