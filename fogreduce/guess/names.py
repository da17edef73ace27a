"""What a column's name says of it: its role and its unit."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from fogreduce.physics.raw_quantity import RawUnitName

#: Ways to write a raw unit, once blanks are gone and ° is deg.
_RAW_UNITS: dict[RawUnitName, str] = {
    "deg/s": r"deg/s(ec)?|degs|deg_s|deg\.?s-1|degs\^-1|dps|deg_per_s(ec)?",
    "deg/h": r"deg/hr?|deg/hour|deg_hr?|dph|deg_per_h(our)?",
    "rad/s": r"rad/s(ec)?|rads|rad_s|rad\.?s-1|rads\^-1|rps|rad_per_s(ec)?",
    "count": r"counts?|lsb|digits?|adc|raw|adu",
    "V": r"v|volts?",
    "deg": r"deg|degrees?",
    "rad": r"rad|radians?",
}
_TIME_UNITS = {
    "s": r"s|secs?|seconds?|sekunden?",
    "ms": r"ms|msecs?|milliseconds?|millis",
    "us": r"[uµμ]s|[uµμ]secs?|microseconds?|micros",
    "ns": r"ns|nsecs?|nanoseconds?|nanos",
    "ticks": r"ticks?|cycles|clk",
}
_IN_BRACKETS = re.compile(r"\s*[\[(]\s*([^\])\d][^\])]*)[\])]\s*$")
_TIME = re.compile(
    r"(^|[^a-z])(t|time|zeit|temps|timestamp|time_?stamp|stamp|sec|secs|seconds|tow|ticks?|utc|datetime|date|millis|micros)"
    r"([^a-z]|$)"
)
_NO_TIME = re.compile(r"sample_?rate|baud|frame_?id")
_GYRO = re.compile(
    r"gyro|omega|angular_?vel|ang_?vel|rate|drehrate|rotation|fog|d_?theta|delta_?(theta|angle)|dang"
    r"|(^|[^a-z])(g|w|rot)_?[xyz0-9]([^a-z]|$)|(^|[^a-z])[pqr]([^a-z]|$)"
)
_OTHER = re.compile(
    r"acc|mag|temp|quat|orient|covar|status|flag|volt_?supply|sample|baud|table|encoder|command|ref|err|std"
)
_INCREMENT = re.compile(r"d_?theta|delta|incr|dang")
_ANGLE = re.compile(r"angle|encoder|winkel|position|table")
_TEMPERATURE = re.compile(r"temp(?!s)|deg_?c([^a-z]|$)")
_ELECTRONICS = re.compile(r"elec|board|pcb|adc|cpu|mcu")


@dataclass(frozen=True)
class Roles:
    """Which column is what, by name (or number from 1), and what unit is stated for it.

    Attributes
    ----------
    time : name or None
    time_unit : str or None
        As `capture.time.unit`, where the name states it.
    gyros : list of names
    raw_unit : str or None
        As `capture.raw_unit`, where names state it.
    logs : mapping
        Names by the keys of `capture.columns` that serve as logs.
    """

    time: str | int | None = None
    time_unit: str | None = None
    gyros: list[str | int] = field(default_factory=list)
    raw_unit: RawUnitName | None = None
    logs: Mapping[str, str] = field(default_factory=dict)


def unit_in(name: str) -> str:
    """The unit that a name states: in brackets at its end, or as its last words; else empty."""
    found = _IN_BRACKETS.search(name)
    if found:
        return _plain(found[1])
    words = _plain(re.sub(r"\[\d+\]$", "", name))
    for unit in ("deg_s", "deg_hr", "deg_h", "rad_s", "deg_c", "degc"):
        if words.endswith(f"_{unit}"):
            return unit
    return re.split(r"[_./\s]", words)[-1] if re.search(r"[_./\s]", words) else ""


def raw_unit_of(unit: str) -> RawUnitName | None:
    """The raw unit that a unit's text means."""
    return next((name for name, way in _RAW_UNITS.items() if re.fullmatch(way, _plain(unit))), None)


def time_unit_of(unit: str) -> str | None:
    """The unit of time that a unit's text means."""
    return next((name for name, way in _TIME_UNITS.items() if re.fullmatch(way, _plain(unit))), None)


def roles_of(names: Sequence[str], units: Mapping[str, str]) -> Roles:
    """Which column is what.

    Parameters
    ----------
    names : sequence of str
        The columns' names, in the file's order.
    units : mapping
        Units that the file states beside the names.
    """
    stated = {name: _plain(units.get(name, "")) or unit_in(name) for name in names}
    plain = {name: _plain(_IN_BRACKETS.sub("", name)) for name in names}
    logs = _logs(names, plain, stated)
    time = _time(names, plain, stated)
    free = [name for name in names if name != time and name not in logs.values()]
    by_unit = [
        n
        for n in free
        if raw_unit_of(stated[n]) in ("deg/s", "deg/h", "rad/s") and not _OTHER.search(plain[n])
    ]
    by_name = [n for n in free if _GYRO.search(plain[n]) and not _OTHER.search(plain[n])]
    gyros = [n for n in by_unit if n in by_name] or by_unit or by_name
    found = {raw_unit_of(stated[n]) for n in gyros}
    raw_unit = found.pop() if len(found) == 1 else None
    time_unit = time_unit_of(stated[time]) or time_unit_of(plain[time]) if time else None
    return Roles(time, time_unit, list(gyros), raw_unit, logs)


def _time(names: Sequence[str], plain: Mapping[str, str], stated: Mapping[str, str]) -> str | None:
    """The first column that is called a time; one that states a unit of time before one that does not."""
    called = [n for n in names if _TIME.search(plain[n]) and not _NO_TIME.search(plain[n])]
    called = [
        n
        for n in called
        if not _TEMPERATURE.search(plain[n]) and raw_unit_of(stated[n]) in (None, "V", "count")
    ]
    return next((n for n in called if time_unit_of(stated[n])), called[0] if called else None)


def _logs(names: Sequence[str], plain: Mapping[str, str], stated: Mapping[str, str]) -> dict[str, str]:
    """Columns that serve as logs: the first of each kind."""
    found: dict[str, str] = {}
    for name in names:
        if _TEMPERATURE.search(plain[name]) or stated[name] in ("degc", "deg_c", "c"):
            key = "electronics_temperature" if _ELECTRONICS.search(plain[name]) else "sensor_temperature"
        elif (
            raw_unit_of(stated[name]) == "deg"
            and _ANGLE.search(plain[name])
            and not _INCREMENT.search(plain[name])
        ):
            key = "table_angle"
        else:
            continue
        found.setdefault(key, name)
    return found


def _plain(text: str) -> str:
    return re.sub(r"\s+", " ", text.strip().lower().replace("°", "deg").replace("degrees", "deg")).replace(
        " ", "_"
    )
