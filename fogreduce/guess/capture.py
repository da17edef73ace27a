"""What a logger's file is: format, columns, units, rate, start, least step; each with the reason for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from fogreduce.constants import MICROSECONDS_PER_SECOND
from fogreduce.datasets.readers import READERS, open_capture
from fogreduce.datasets.readers.columns import ColumnsReader
from fogreduce.datasets.readers.installed import installed_readers
from fogreduce.errors import BadInput
from fogreduce.guess.layout import layout_of
from fogreduce.guess.names import Roles, raw_unit_of, roles_of
from fogreduce.guess.stamps import Intervals, as_mapping, least_step, time_keys
from fogreduce.physics.raw_quantity import RawUnitName
from fogreduce.units import gps_leap_seconds

_RECORDS = 65_536  # read at a time
_START_OF_STAMPS = 1.5  # intervals: a first stamp beyond them is no start
#: First bytes of the formats that say so.
_MAGIC = (
    (b"FOGCAP1\n", "fogcap-1"),
    (b"\x93NUMPY", "npy"),
    (b"PK\x03\x04", "npz"),
    (b"TDSm", "tdms"),
    (b"PAR1", "parquet"),
    (b"MATLAB", "mat"),
    (b"\x89HDF\r\n", "hdf5"),
)


@dataclass(frozen=True)
class Stated:
    """What the user says; None where that is left to the file."""

    format: str | None = None
    rate_hz: float | None = None
    raw_unit: RawUnitName | None = None
    columns: Mapping[str, Any] | None = None
    time_unit: str | None = None
    tick_s: float | None = None
    epoch: str | None = None


@dataclass
class Guess:
    """The `capture` block of a file, and why, by key.

    Attributes
    ----------
    keys : mapping
        As run.yaml has them.
    why : mapping
        Reasons, by key.
    n_gyros : int
    start_us : int or None
        First stamp, microseconds since 1970, where the stamps tell.
    duration_s : float
        From the first record to one interval after the last [s].
    """

    keys: dict[str, Any]
    why: dict[str, str] = field(default_factory=dict)
    n_gyros: int = 0
    start_us: int | None = None
    duration_s: float = 0.0


def guess(path: Path, stated: Stated) -> Guess:
    """Look into a file.

    Raises
    ------
    BadInput
        It cannot be read, is of no known format, or does not tell something that only the user can say.
    """
    name = stated.format or format_of(path)
    keys: dict[str, Any] = {"file": path.name, "format": name, "sample_rate_hz": stated.rate_hz or 1.0}
    units: dict[str, str] = {}
    if name == "table" and (layout := layout_of(path)) is not None:
        units = layout.units
        if layout.keys:
            keys["text"] = layout.keys
    reader = open_capture(path, {**keys, "columns": {"gyros": [1]}}, 0)
    found = Guess(keys)
    if isinstance(reader, ColumnsReader) and name != "csv-1":
        _columns(found, reader, stated, {**units, **reader.units})
        if "time" not in found.keys["columns"]:
            found.start_us = reader.first_us
    _measure(found, path, stated)
    return found


def format_of(path: Path) -> str:
    """The name of a file's format: by its first bytes, an installed reader's liking, or as text."""
    try:
        with path.open("rb") as file:
            head = file.read(1024)
    except OSError as error:
        raise BadInput.at(path, "", found=error.strerror, expected="a capture file") from None
    for magic, name in _MAGIC:
        if head.startswith(magic):
            return name
    if head[512:516] == b"\x89HDF":
        return "mat" if path.suffix == ".mat" else "hdf5"
    for name in installed_readers():
        if _opens(path, {"file": path.name, "format": name, "sample_rate_hz": 1.0}):
            return name
    if _opens(path, {"file": path.name, "format": "csv-1", "sample_rate_hz": 1.0}):
        return "csv-1"
    if layout_of(path) is not None:
        return "table"
    raise BadInput.at(
        path, "", found="a file of no known format", expected=", ".join([*READERS, *installed_readers()])
    )


def _opens(path: Path, capture: Mapping[str, Any]) -> bool:
    try:
        open_capture(path, capture, 0)
    except BadInput:
        return False
    return True


def _columns(found: Guess, reader: ColumnsReader, stated: Stated, units: Mapping[str, str]) -> None:
    """Which column is what; the raw unit; what the time column counts."""
    names = list(reader.names)
    roles = roles_of(names, units)
    given = dict(stated.columns or {})
    gyros = given.get("gyros") or roles.gyros
    if not gyros:
        shown = ", ".join(names[:12]) + (", ..." if len(names) > 12 else "")
        raise BadInput.at(
            reader.path, "", found=f"columns {shown}", expected="--columns gyros=NAME,NAME,NAME"
        )
    # A file without names says nothing of other columns than those that the user names.
    time = given.get("time", None if "gyros" in given and not roles.gyros else roles.time)
    unnamed = _ambiguous(names)
    columns: dict[str, Any] = {} if time is None else {"time": _short(time, names, unnamed)}
    columns["gyros"] = [_short(name, names, unnamed) for name in gyros]
    columns |= {
        key: given.get(key, name)
        for key, name in {**roles.logs, **given}.items()
        if key not in ("time", "gyros")
    }
    found.keys["columns"] = columns
    found.why["columns"] = "as stated" if given else "by names and units"
    _raw_unit(found, reader, roles, stated)
    if time is not None:
        first, second = _two_stamps(reader, time)
        keys, why = time_keys(first, second, stated.time_unit or roles.time_unit, str(time))
        if stated.epoch:
            keys["epoch"] = stated.epoch
        found.keys["time"] = as_mapping(keys, stated.tick_s)
        found.why["time"] = "; ".join(why) or "seconds"
        if keys["unit"] == "ticks" and not stated.tick_s:
            raise BadInput.at(
                reader.path, f"column {time}", found="ticks of a counter", expected="--tick SECONDS"
            )


def _two_stamps(reader: ColumnsReader, time: str | int) -> tuple[Any, Any]:
    """The first two values of the time column; text where they are no numbers."""
    try:
        first = reader.first_values(time, 2)
    except BadInput:
        return "text", "text"
    return first[0], first[-1]


def _ambiguous(names: list[str]) -> set[str]:
    return {name for name in names if names.count(name) > 1}


def _short(column: str | int, names: list[str], ambiguous: set[str]) -> str | int:
    return names.index(column) + 1 if column in ambiguous and isinstance(column, str) else column


def _raw_unit(found: Guess, reader: ColumnsReader, roles: Roles, stated: Stated) -> None:
    values = reader.first_values(found.keys["columns"]["gyros"][0], 100)
    by_units = {raw_unit_of(reader.units.get(str(name), "")) for name in found.keys["columns"]["gyros"]}
    if stated.raw_unit:
        found.keys["raw_unit"], found.why["raw_unit"] = stated.raw_unit, "as stated"
    elif len(by_units) == 1 and (unit := by_units.pop()) is not None:
        found.keys["raw_unit"], found.why["raw_unit"] = unit, "stated in the file"
    elif roles.raw_unit:
        found.keys["raw_unit"], found.why["raw_unit"] = roles.raw_unit, "by the columns' names"
    elif values.dtype.kind in "iu" or all(float(v).is_integer() for v in values):
        found.keys["raw_unit"], found.why["raw_unit"] = "count", "whole numbers"
    elif "angular_velocity" in str(found.keys["columns"]["gyros"][0]):
        found.keys["raw_unit"], found.why["raw_unit"] = "rad/s", "as messages of that name have it"
    else:
        found.keys["raw_unit"], found.why["raw_unit"] = (
            "deg/s",
            "NOT stated in the file: a mere guess, see --unit",
        )


def _measure(found: Guess, path: Path, stated: Stated) -> None:
    """Rate, length, start and least step, in one pass over the file."""
    instants = _counts_from_an_epoch(found.keys)
    reader = open_capture(path, {**found.keys, "sample_rate_hz": stated.rate_hz or 1.0}, 0)
    intervals, step = Intervals(), None
    for block in reader.blocks(_RECORDS):
        intervals.add(block.time_us)
        if step is None:
            step = 1.0 if block.values is None else least_step(block.values)
    facts = reader.facts
    found.n_gyros = facts.n_gyros
    has_time = "columns" not in found.keys or "time" in found.keys["columns"]
    rate, why = stated.rate_hz, "as stated"
    if rate is None:
        rate, why = facts.sample_rate_hz, "stated in the file"
    if rate is None and has_time:
        rate, why = intervals.rate_hz(), "as the stamps show"
    if rate is None:
        raise BadInput.at(path, "", found="no column that tells the sample rate", expected="--rate HZ")
    found.keys["sample_rate_hz"], found.why["sample_rate_hz"] = rate, why
    raw_unit = found.keys.get("raw_unit") or stated.raw_unit or facts.raw_unit or "V"
    if raw_unit != "V":
        found.keys["raw_unit"] = raw_unit
    key = "volts_per_count" if raw_unit == "V" else "least_count"
    found.keys[key] = facts.least_count or (1.0 if raw_unit == "count" else step)
    found.why[key] = "stated in the file" if facts.least_count else "least difference of two readings"
    found.keys["polarity"] = [1] * facts.n_gyros
    found.why["polarity"] = "1 or -1 a gyro: turns raw readings into calibrated ones"
    span_s = intervals.count / rate
    if intervals.first is not None and has_time:
        span_s = round((intervals.last - intervals.first) / 1e6 * rate + 1.0) / rate
        if instants:
            found.start_us = intervals.first
            if (found.keys.get("time") or {}).get("epoch") == "gps":
                # Read as of 1970, when GPS time was no second ahead of UTC.
                found.start_us -= gps_leap_seconds(intervals.first) * MICROSECONDS_PER_SECOND
        elif abs(intervals.first) > _START_OF_STAMPS * 1e6 / rate and "columns" in found.keys:
            found.keys["time_zero"], found.why["time_zero"] = "first", "the stamps do not begin at 0"
    found.start_us = facts.start_us if found.start_us is None else found.start_us
    found.duration_s = float(f"{span_s:.9g}")


def _counts_from_an_epoch(keys: Mapping[str, Any]) -> bool:
    time = keys.get("time") or {}
    return time.get("unit") == "iso8601" or time.get("epoch") in ("unix", "gps")
