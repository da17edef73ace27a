"""What the capture contract forbids, written down a second time, without the package: files of numbers.

Each function returns what is forbidden in a file, in words; nothing means that the contract allows it. It
need not see everything: what it does see must not be accepted.
"""

from __future__ import annotations

import re
import struct
from collections import Counter
from collections.abc import Sequence

NO_ANSWER = -(2**31)
_NUMBER = re.compile(r"[ \t]*[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?[ \t]*")


def fogcap(data: bytes, *, n: int, rate: float, volts: float, start_us: int, unit: str) -> list[str]:
    """A capture of `fogcap-1`, beside what run.yaml says of it."""
    if len(data) < 64:
        return ["a header cut off"]
    magic, length, gyros, record, its_rate, its_volts, start = struct.unpack("<8sIHHddq", data[:40])
    rules = {
        "magic": magic == b"FOGCAP1\n",
        "header length": length == 64,
        "gyros": gyros >= 1 and gyros == n,
        "record length": record == 12 + 4 * gyros,
        "rate": 0.01 <= its_rate <= 10_000 and abs(its_rate / rate - 1) < 1e-6,
        "volts per count": 0 < its_volts < float("inf") and abs(its_volts / volts - 1) < 1e-6,
        "start": start == start_us,
        "unit": data[40:64] == unit.encode("ascii").ljust(24, b"\0"),
    }
    return [rule for rule, holds in rules.items() if not holds]


def fogcap_counts(data: bytes, n: int, rate: float) -> dict[str, int]:
    """What quality.csv must say of an allowed capture; `stray_stamps` is the least number of bad stamps."""
    size = 12 + 4 * n
    body = data[64:]
    records = [struct.unpack_from(f"<qI{n}i", body, size * k) for k in range(len(body) // size)]
    missing = Counter(gyro for record in records for gyro in range(n) if record[2 + gyro] == NO_ANSWER)
    late = [record[0] - record[1] / rate * 1e6 for record in records]
    stray = sum(
        abs(late[k] - late[k - 1]) > 1e7 and max(late[k - 2 : k] + late[k + 1 : k + 3]) - min(
            late[k - 2 : k] + late[k + 1 : k + 3]
        ) < 1e4
        for k in range(2, len(late) - 2)
    )  # fmt: skip
    return {
        "records": len(records),
        "torn_bytes": len(body) % size,
        **{f"missing_gyro{gyro + 1}": missing[gyro] for gyro in range(n)},
        "stray_stamps": stray,
    }


def csv_lines(data: bytes, header: Sequence[str], *, may_miss: bool, may_tear: bool) -> list[str]:
    """A file of numbers under one header line: a capture of `csv-1` or a log."""
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError:
        return ["bytes that are not UTF-8"]
    lines = re.split(r"\r\n|\n", text)
    if (lines[-1] == "" and len(lines) > 1) or (may_tear and lines[-1].count(",") < len(header) - 1):
        lines.pop()
    if not lines or lines[0].split(",") != list(header):
        return ["header"]
    if len(lines) < 2:
        return ["no line"]
    for number, line in enumerate(lines[1:], start=2):
        fields = line.split(",")
        if len(fields) != len(header):
            return [f"line {number}: {len(fields)} fields"]
        for place, field in enumerate(fields):
            if field == "" and place and may_miss:
                continue
            if not _NUMBER.fullmatch(field) or not abs(float(field)) < float("inf"):
                return [f"line {number}: {field[:30]!r}"]
    return []


def temperatures(data: bytes) -> list[str]:
    """A temperature log."""
    return csv_lines(data, ("time_s", "electronics_degC", "sensor_degC"), may_miss=False, may_tear=False)


def table_log(data: bytes) -> list[str]:
    """A log of the table's encoder."""
    return csv_lines(data, ("time_s", "angle_deg"), may_miss=False, may_tear=False)


def csv_capture(data: bytes, n: int) -> list[str]:
    """A capture of `csv-1`."""
    header = ("time_s", *(f"gyro{i}_V" for i in range(1, n + 1)))
    return csv_lines(data, header, may_miss=True, may_tear=True)
