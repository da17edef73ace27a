"""run.yaml and calibration record as text, every guess with its reason beside it."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from fogreduce.guess.capture import Guess
from fogreduce.metadata.yaml12 import dump_yaml
from fogreduce.physics.raw_quantity import RawUnitName, unit_in_use

TODO = "TODO"
_ORTHOGONAL = 3
#: Plain words that YAML of some version takes for something else than text.
_NO_TEXT = ("y", "n", "yes", "no", "on", "off", "true", "false", "null", "nan")
_ORDER = (
    *("file", "format", "sample_rate_hz", "raw_unit", "volts_per_count", "least_count", "polarity"),
    *("columns", "time", "time_zero", "text", "dataset"),
)


@dataclass(frozen=True)
class Bench:
    """What no file tells of a run; None where the user has not said it either."""

    latitude_deg: float | None = None
    orientation: Mapping[str, str] = field(default_factory=dict)
    axis: str | None = None
    profile: list[tuple[float, float]] | None = None
    unit: str = "UNIT-1"


def run_text(guess: Guess, bench: Bench, run_id: str, started_at: str, why_started: str) -> str:
    """The run.yaml of a capture."""
    profile: Sequence[tuple[float | None, float]] = bench.profile or [(None, guess.duration_s)]
    steps = "\n".join(
        f"    - {{rate_deg_s: {_value(rate)}, duration_s: {_value(time)}}}" for rate, time in profile
    )
    axes: Mapping[str, str | None] = bench.orientation or {"x": None, "z": None}
    orientation = ", ".join(f"{axis}: {_value(way)}" for axis, way in axes.items())
    return f"""\
# Begun by `fogreduce init` from {guess.keys["file"]!r}.
# What no file tells is asked for here, and nowhere else: replace each {TODO}, then run `fogreduce check`.
site: {{latitude_deg: {_value(bench.latitude_deg)}}}  # signed, north positive
orientation: {{{orientation}}}  # two unit axes at t = 0: up, down, north, south, east or west
table:
  axis: {_value(bench.axis)}  # x, y, z of the unit frame, or [ux, uy, uz]
  profile:  # commanded rate about that axis, piecewise constant, in order; 0 for a standstill
{steps}

# What follows was found in the file, or guessed from it.
schema: fogreduce/run/1
run_id: {_value(run_id)}  # equals the folder's name
unit: {_value(bench.unit)}  # the unit under test, a name
started_at: {started_at}  # {why_started}
capture:
{_capture_lines(guess)}
calibration: {_value(record_id(bench.unit, guess))}  # <unit>@<version>; an ideal unit's, see the record
"""


def _capture_lines(guess: Guess) -> str:
    lines = []
    for key in _ORDER:
        if key in guess.keys:
            why = f"  # {guess.why[key]}" if key in guess.why else ""
            lines.append(f"  {key}: {_value(guess.keys[key])}{why}")
    return "\n".join(lines)


def version_of(guess: Guess) -> str:
    """Version of an ideal unit's record: it differs by number of gyros and unit of readings."""
    return f"ideal-{guess.n_gyros}-{unit_in_use(_raw_unit(guess)).suffix}"


def record_id(unit: str, guess: Guess) -> str:
    """Id of the record that a run is given."""
    return f"{unit}@{version_of(guess)}"


def _raw_unit(guess: Guess) -> RawUnitName:
    raw_unit: RawUnitName = guess.keys.get("raw_unit", "V")
    return raw_unit


def record_text(guess: Guess, bench: Bench) -> str:
    """The calibration record of an ideal digital unit."""
    unit, n = unit_in_use(_raw_unit(guess)), guess.n_gyros
    scale = unit.per_deg_s if unit.per_deg_s is not None else 1.0
    note = "" if unit.per_deg_s is not None else f"  # {unit.name} a deg/s: NOT known, 1 stands for it"
    if n == _ORTHOGONAL:
        axes = "H: [[1, 0, 0], [0, 1, 0], [0, 0, 1]]  # gyros 1, 2, 3 along x, y, z"
    elif n < _ORTHOGONAL:
        axes = f"axes: {[[1, 0, 0], [0, 1, 0]][:n]}  # gyros along x, y"
    else:
        axes = f"axes: {TODO}  # {n} unit vectors [x, y, z], the gyros' input axes in the unit frame"
    return f"""\
# An IDEAL unit, written by `fogreduce init`: scale factor 1, no bias, orthogonal axes; nothing was measured.
# A calibrated unit has a record of its own, from a certificate or from `fogreduce derive-calibration`.
schema: fogreduce/calibration/1
unit: {_value(bench.unit)}
version: {_value(version_of(guess))}
valid_from: 1970-01-01T00:00:00Z
procedure: ideal unit assumed by fogreduce init, not calibrated
{axes}
{unit.scale_factor_key}: {[scale] * n}{note}
{unit.bias_key}: {[0.0] * n}
"""


def _value(value: Any) -> str:
    """A value as it stands in YAML, on one line; TODO for None."""
    if value is None:
        return TODO
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{key}: {_value(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    if isinstance(value, str):
        return _quoted(value)
    return dump_yaml({"v": value}).removeprefix("v: ").rstrip("\n")


def _quoted(text: str) -> str:
    """Text as YAML has it within brackets too: in quotes unless it is a plain word."""
    if re.fullmatch(r"[A-Za-z][A-Za-z0-9._@/-]*", text) and text.lower() not in _NO_TEXT:
        return text
    return json.dumps(text, ensure_ascii=False)
