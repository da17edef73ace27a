"""Capture files of the format `fogcap-1`, byte for byte as the contract lays them out."""

import calendar
import re
import struct
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from withheld.arrays import AnyArray, Counts, Stamps
from withheld.atomic import write_bytes
from withheld.chain.campaign import Run, Unit
from withheld.errors import BadInput

_HEADER = struct.Struct("<8sIHHddq24s")


def _record(n: int) -> np.dtype:
    return np.dtype([("stamp", "<u8"), ("pulse", "<u4"), ("count", "<i4", (n,))])


def microseconds(started_at: str) -> int:
    """Microseconds since 1970 of a UTC time such as 2014-05-12T13:00:00Z."""
    match = re.fullmatch(r"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d)(?:\.(\d{1,6}))?Z", started_at)
    if match is None:
        raise BadInput(f"started_at {started_at}: expected a UTC time such as 2014-05-12T13:00:00Z")
    seconds = calendar.timegm(time.strptime(match[1], "%Y-%m-%dT%H:%M:%S"))
    return seconds * 1_000_000 + int((match[2] or "").ljust(6, "0"))


def encode(run: Run, unit: Unit, stamps: Stamps, counts: Counts) -> bytes:
    """Header and records; `stamps` (k,) [us], `counts` (k, n).  Pulse numbers count from 0."""
    records = np.empty(len(counts), dtype=_record(unit.n))
    records["stamp"], records["pulse"], records["count"] = stamps, np.arange(len(counts)), counts
    header = _HEADER.pack(
        b"FOGCAP1\n", 64, unit.n, 12 + 4 * unit.n, run.sample_rate_hz, run.volts_per_count,
        microseconds(run.started_at), unit.name.encode("ascii"),
    )  # fmt: skip
    return header + records.tobytes()


def write_capture(path: Path, run: Run, unit: Unit, stamps: Stamps, counts: Counts) -> None:
    """The capture of one run, whole or not at all."""
    write_bytes(path, encode(run, unit, stamps, counts))


@dataclass(frozen=True)
class Capture:
    """A capture as read: header numbers, then stamps [us] (k,), pulses (k,), counts (k, n)."""

    unit: str
    sample_rate_hz: float
    volts_per_count: float
    start_us: int
    stamps: Stamps
    pulses: AnyArray
    counts: AnyArray


def read_capture(path: Path) -> Capture:
    """The whole records of a capture; a last record that was cut off is left out."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise BadInput(f"{path}: cannot be read ({error.strerror})") from error
    if len(content) < 64 or content[:8] != b"FOGCAP1\n":
        raise BadInput(f"{path}: not a fogcap-1 capture (its first eight bytes are {content[:8]!r})")
    _, size, n, width, rate, lsb, start, name = _HEADER.unpack(content[:64])
    if size != 64 or width != 12 + 4 * n:
        raise BadInput(
            f"{path}: header of {size} bytes and records of {width} for {n} gyros; expected 64, {12 + 4 * n}"
        )
    records = np.frombuffer(content, dtype=_record(n), offset=64, count=(len(content) - 64) // width)
    unit = name.rstrip(b"\0").decode("ascii")
    return Capture(unit, rate, lsb, start, records["stamp"], records["pulse"], records["count"])
