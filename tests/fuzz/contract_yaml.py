"""What the contract forbids in metadata, written down a second time, without the package's models.

A file is read by PyYAML's events alone; plain scalars are resolved here by YAML 1.2. A rule takes a value and
its place and returns what is forbidden, in words.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from datetime import UTC, datetime, timedelta
from typing import Any

import yaml

Rule = Callable[[Any, str], list[str]]

NAME = r"[A-Za-z0-9][A-Za-z0-9._-]{0,63}"
_DIRECTIONS = {"up": 2, "down": 2, "north": 1, "south": 1, "east": 0, "west": 0}


class Refused(Exception):
    """Not YAML in plain words: a tag, an anchor, a second document, a key twice ..."""


def loaded(data: bytes) -> Any:
    """The file's plain value."""
    try:
        events = [event for event in yaml.parse(data.decode("utf-8-sig"), Loader=yaml.SafeLoader)]
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise Refused(type(error).__name__) from None
    if sum(isinstance(event, yaml.DocumentStartEvent) for event in events) != 1:
        raise Refused("not one document")
    rest = iter(events[2:-2])
    return _value(next(rest), rest)


def _value(event: Any, rest: Any) -> Any:
    if isinstance(event, yaml.AliasEvent) or event.anchor or event.tag:
        raise Refused("an alias, an anchor or a tag")
    if isinstance(event, yaml.ScalarEvent):
        return _scalar(event.value) if event.implicit[0] else event.value
    items = []
    while not isinstance(event := next(rest), yaml.SequenceEndEvent | yaml.MappingEndEvent):
        items.append(_value(event, rest))
    if isinstance(event, yaml.SequenceEndEvent):
        return items
    keys = items[::2]
    if not all(isinstance(key, str) for key in keys) or len(set(keys)) != len(keys):
        raise Refused("a key twice, or one that is not text")
    return dict(zip(keys, items[1::2], strict=True))


def _scalar(text: str) -> Any:
    if text in ("", "~", "null", "Null", "NULL"):
        return None
    if text in ("true", "True", "TRUE", "false", "False", "FALSE"):
        return text[0] in "tT"
    if re.fullmatch(r"[-+]?[0-9]+|0o[0-7]+|0x[0-9a-fA-F]+", text):
        if len(text) > 400:
            raise Refused("digits without end")
        return int(text, 0) if text[:2] in ("0o", "0x") else int(text)
    if re.fullmatch(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?", text):
        return float(text)
    if re.fullmatch(r"[-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN)", text):
        return math.nan
    return text


def number(low: float = -math.inf, high: float = math.inf, *, above: bool = False) -> Rule:
    """A finite number in a range, `low` itself left out where `above`."""

    def rule(value: Any, at: str) -> list[str]:
        fine = isinstance(value, int | float) and not isinstance(value, bool)
        fine = fine and abs(value) < 1.8e308 and low <= value <= high and not (above and value == low)
        return [] if fine else [f"{at}: {value!r}"]

    return rule


def one_of(*allowed: Any) -> Rule:
    """One of some values; True is not 1."""
    return lambda value, at: (
        [] if not isinstance(value, bool) and any(value == one for one in allowed) else [f"{at}: {value!r}"]
    )


def text(pattern: str = r"[\s\S]*") -> Rule:
    """Text of a shape."""
    return lambda value, at: (
        [] if isinstance(value, str) and re.fullmatch(pattern, value) else [f"{at}: {value!r}"]
    )


def instant(value: Any, at: str) -> list[str]:
    """A time with its zone."""
    try:
        assert isinstance(value, str)
        moment = datetime.fromisoformat(value.upper())
        assert moment.utcoffset() is not None
        moment.astimezone(UTC) + timedelta(0)
    except (AssertionError, ValueError, OverflowError):
        return [f"{at}: {value!r}"]
    return []


def each(rule: Rule, count: int | None = None) -> Rule:
    """A list whose entries all obey a rule: so many, or at least one."""

    def listed(value: Any, at: str) -> list[str]:
        if not isinstance(value, list) or (len(value) != count if count else not value):
            return [f"{at}: {value!r}"]
        return [wrong for k, item in enumerate(value) for wrong in rule(item, f"{at}[{k}]")]

    return listed


def keys(needed: dict[str, Rule], optional: dict[str, Rule] | None = None) -> Rule:
    """A mapping of these keys and no others; an optional key may also say null."""
    optional = optional or {}

    def mapped(value: Any, at: str) -> list[str]:
        if not isinstance(value, dict):
            return [f"{at}: not a mapping"]
        wrong = [f"{at}: unknown key {key!r}" for key in value if key not in needed and key not in optional]
        wrong += [f"{at}: no {key}" for key in needed if key not in value]
        for key, item in value.items():
            if rule := needed.get(key) or (optional.get(key) if item is not None else None):
                wrong += rule(item, f"{at}.{key}")
        return wrong

    return mapped


def _orientation(value: Any, at: str) -> list[str]:
    if not isinstance(value, dict) or len(value) != 2 or not set(value) <= {"x", "y", "z"}:
        return [f"{at}: {value!r}"]
    lines = [_DIRECTIONS.get(item) if isinstance(item, str) else None for item in value.values()]
    return [] if None not in lines and lines[0] != lines[1] else [f"{at}: {value!r}"]


def _axis(value: Any, at: str) -> list[str]:
    if isinstance(value, str):
        return one_of("x", "y", "z")(value, at)
    return each(number(), 3)(value, at) or ([] if any(value) else [f"{at}: no direction"])


_TEXT = text()
_SIGN = one_of(1, -1)
_FILE = text(r"(?!\.\.?$)[^/\\\x00]+")
_LATITUDE = number(-90, 90)
_NOT_NEGATIVE = number(0)


def run(n: int) -> Rule:
    """run.yaml of the run r1 of the unit TETRA-01 with n gyros."""
    step = keys({"rate_deg_s": number(), "duration_s": number(0, above=True)})
    return keys(
        {
            "schema": one_of("fogreduce/run/1"),
            "run_id": one_of("r1"),
            "unit": one_of("TETRA-01"),
            "started_at": instant,
            "site": keys(
                {"latitude_deg": _LATITUDE},
                {
                    "longitude_deg": number(),
                    "height_m": number(),
                    "name": _TEXT,
                    "latitude_uncertainty_deg": _NOT_NEGATIVE,
                },
            ),
            "table": keys({"axis": _axis, "profile": each(step)}, {"rate_uncertainty_ppm": _NOT_NEGATIVE}),
            "orientation": _orientation,
            "capture": keys(
                {
                    "file": _FILE,
                    "format": one_of("fogcap-1", "csv-1"),
                    "sample_rate_hz": number(0.01, 10_000),
                    "volts_per_count": number(0, above=True),
                    "polarity": each(_SIGN, n),
                }
            ),
        },
        {
            "calibration": text(rf"TETRA-01@{NAME}"),
            "azimuth_deg": number(),
            "azimuth_uncertainty_deg": _NOT_NEGATIVE,
            "frame_signs": each(_SIGN, 3),
            "temperature": _FILE,
            "table_log": _FILE,
            "notes": _TEXT,
        },
    )


def calibration(n: int) -> Rule:
    """A calibration record of n >= 3 gyros, named TETRA-01/2012a."""
    sigmas, reals = each(_NOT_NEGATIVE, n), each(number(), n)
    uncertainty = ("scale_factor_rel", "bias_V", "axis_rad", "turn_on_bias_deg_h")
    noise = ("angle_random_walk_deg_sqrt_h", "bias_instability_deg_h", "rate_random_walk_deg_h_sqrt_h")
    return keys(
        {
            "schema": one_of("fogreduce/calibration/1"),
            "unit": one_of("TETRA-01"),
            "version": one_of("2012a"),
            "valid_from": instant,
            "procedure": _TEXT,
            "H": each(reals, 3),
            "scale_factor_V_per_deg_s": reals,
            "bias_V": reals,
        },
        {
            "valid_until": instant,
            "uncertainty": keys({}, dict.fromkeys(uncertainty, sigmas)),
            "noise": keys({}, dict.fromkeys(noise, sigmas)),
        },
    )


def campaign(value: Any, at: str) -> list[str]:
    """campaign.yaml: the contract's keys, and those that the project added."""
    made = keys({}, {"simulate": keys({}, {"seed": number(0)}), "curves": _FILE})
    return keys(
        {},
        {
            **dict.fromkeys(("title", "operator", "notes", "label"), _TEXT),
            "schema": one_of("fogreduce/campaign/1"),
            "calibration": text(rf"{NAME}@{NAME}"),
            "captures_from": made,
            "diagnose": lambda value, at: [] if isinstance(value, bool) else [f"{at}: {value!r}"],
        },
    )(value, at)


#: Effect -> its parameters, from the contract's table; those that the tests use.
EFFECTS = {
    "table_rate_error": {"ppm"},
    "bias_ramp": {"deg_h_per_h"},
    "mount_rotation": {"mrad"},
    "dead_zone": {"deg_h", "kind"},
    "spikes": {"fraction"},
    "lost_bits": {"bits"},
    "crosstalk": {"ppm", "source"},
    "channel_swap": {"with"},
    "clock_error": {"ppm"},
    "polarity_error": set(),
}


def effects(value: Any, at: str) -> list[str]:
    """An effects file: shape, names, parameters, and finite numbers in these."""
    entry = keys(
        {"effect": _TEXT},
        {"channels": each(_TEXT), "runs": each(_TEXT), "parameters": lambda value, at: []},
    )
    wrong = keys({"schema": one_of("fogreduce/effects/1"), "effects": lambda value, at: []})(value, at)
    if wrong:
        return wrong
    if not isinstance(value["effects"], list):
        return [f"{at}.effects: {value['effects']!r}"]
    for k, item in enumerate(value["effects"]):
        here = f"{at}.effects[{k}]"
        wrong += entry(item, here)
        if not isinstance(item, dict) or str(item.get("effect")) not in EFFECTS:
            continue
        given = item.get("parameters")
        if given is not None and not isinstance(given, dict):
            wrong.append(f"{here}.parameters: {given!r}")
            continue
        wrong += [
            f"{here}: unknown parameter {key}" for key in given or {} if key not in EFFECTS[item["effect"]]
        ]
        for key, item_value in (given or {}).items():
            listed = item_value if isinstance(item_value, list) else [item_value]
            wrong += [
                f"{here}.{key}: {one!r}"
                for one in listed
                if isinstance(one, float) and not math.isfinite(one)
            ]
    return wrong


def forbidden(data: bytes, rule: Rule) -> list[str]:
    """What a file has that the contract forbids."""
    try:
        return rule(loaded(data), "")
    except Refused as error:
        return [str(error)]
    except RecursionError:
        return ["nesting"]
