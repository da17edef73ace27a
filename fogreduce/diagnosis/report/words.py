"""Causes, sizes and verdicts in words, the same on the console and on the page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import atan2, degrees, hypot
from typing import Any

from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.effects.model import Parameter
from fogreduce.effects.table import EFFECTS
from fogreduce.pages.numbers import plus_minus

#: Times what units of this class show: worth a word.
_FAR = 10.0
#: Causes that one line names.
_FEW = 6


def named(cause: Cause) -> str:
    """A cause as files name it: effect, channels, the other gyro of a pair, the run if it is not in all."""
    return _words(cause.effect, cause.effect, cause.channels, cause.runs, cause.key[3])


def in_words(item: Mapping[str, Any]) -> str:
    """The same for a cause of a diagnosis.json, or a member of its group."""
    return _words(item["effect"], item["effect"], item["channels"], item["runs"], _other(item))


def titled(item: Mapping[str, Any]) -> str:
    """The same for people: the effect's name in words, and its channels where it does not imply them."""
    effect = EFFECTS[item["effect"]]
    channels = item["channels"] if effect.channels == "gyro" else []
    name = f"{effect.title} of" if channels else effect.title
    return _words(item["effect"], name, channels, item["runs"], _other(item))


def titled_name(name: str) -> str:
    """A name as `named` makes it, for people."""
    effect, _, rest = name.partition(" ")
    if effect not in EFFECTS:
        return name
    gyro = EFFECTS[effect].channels == "gyro"
    place = rest if gyro else rest.removeprefix(EFFECTS[effect].channels).strip()
    return f"{EFFECTS[effect].title}{' of' if gyro and place else ''} {place}".strip()


def _other(item: Mapping[str, Any]) -> str:
    given = item.get("parameters", {}).get(EFFECTS[item["effect"]].other, "")
    return str(given["value"] if isinstance(given, Mapping) else given)


def _words(effect: str, name: str, channels: Sequence[str], runs: Sequence[str], other: str) -> str:
    joint = "with" if EFFECTS[effect].mutual else "from" if EFFECTS[effect].other else "at"
    pair = f" {joint} {other}" if other else ""
    where = "" if list(runs) == ["*"] else f" in {', '.join(runs)}"
    return f"{name} {', '.join(channels)}".rstrip() + f"{pair}{where}"


def percent(value: float) -> str:
    """A probability or share in words that do not claim more than it does."""
    if value > 0.999:
        return "more than 99.9 %"
    return f"{100 * value:.1f} %" if value >= 0.001 else "less than 0.1 %"


def place(item: Mapping[str, Any]) -> str:
    """A place in words."""
    runs = f" in {item['runs'][0]}" if len(item["runs"]) == 1 else ""
    return f"{', '.join(item['channels'])}: {item['feature'].replace('_', ' ')}{runs}"


def sizes(cause: Mapping[str, Any], raw_unit: str, part: Mapping[str, Any] | None = None) -> list[str]:
    """Sizes of a cause with units, one a parameter; what is far beyond what such units show is said to be.

    `part`: of a diagnosis.json, the data sheet that says what they show.
    """
    sheet = (part or {"sizes": {}})["sizes"].get(cause["effect"])
    stated = {p.name: p for p in EFFECTS[cause["effect"]].parameters}
    out = []
    for name, found in cause["parameters"].items():
        p = stated[name]
        if p.kind == "gyro":
            continue  # the other gyro stands in the name
        value = _value(p, found)
        parts = [p.words, value, p.unit_in(raw_unit)]
        if not p.words and not p.unit and p.kind != "choice":
            parts[0] = p.meaning  # a pure number says what it is of
        out.append(
            " ".join(part for part in parts if part) + _towards(p, found) + _far(p, found, raw_unit, sheet)
        )
    return out


def _value(p: Parameter, found: Mapping[str, Any]) -> str:
    if "size" in found:
        return plus_minus(found["size"], found["size_std"])
    value = found["value"]
    if p.frame and isinstance(value, Sequence):
        return direction(value, p.frame)
    return plus_minus(value, found["std"]) if isinstance(value, int | float) else str(value)


def _towards(p: Parameter, found: Mapping[str, Any]) -> str:
    return f" toward {direction(found['direction'], p.frame)}" if "size" in found else ""


def direction(vector: Sequence[float], frame: str) -> str:
    """A unit vector in words: along x, y, z of the unit, or by azimuth and height in the room."""
    x, y, z = vector
    if frame == "unit":
        parts = ", ".join(f"{v + 0.0:.2f}".replace("-0.00", "0.00") for v in (x, y, z))
        return f"({parts}) in x, y, z".replace("-", "\N{MINUS SIGN}")
    height = degrees(atan2(z, hypot(x, y)))
    level = "level" if abs(height) < 0.5 else f"{abs(height):.0f} deg {'up' if height > 0 else 'down'}"
    return f"azimuth {round(degrees(atan2(x, y))) % 360} deg, {level}"


def _far(p: Parameter, found: Mapping[str, Any], raw_unit: str, sheet: Sequence[float] | None) -> str:
    value = found.get("size", found["value"])
    shown = None if p.words else sheet or p.realistic
    if shown is None or not isinstance(value, int | float) or abs(value) <= _FAR * shown[1]:
        return ""
    return f" (units of this class show {shown[0]:.2g} to {shown[1]:.3g} {p.unit_in(raw_unit)})"


def is_group(cause: Mapping[str, Any]) -> bool:
    """Whether the runs cannot tell a cause from others."""
    return len(cause["group"]) > 1


def headline(document: Mapping[str, Any]) -> str:
    """The verdict in one sentence; a group is announced as one."""
    if document["verdict"] == "no_gap":
        return "bench and simulator agree"
    causes = document["causes"]
    if document["mistakes"]:
        runs = [one["run"] for one in document["mistakes"]]
        return f"{', '.join(runs)} look{'s' * (len(runs) == 1)} like a mistake"
    if not causes:
        return "nothing in the catalogue explains the gap between bench and simulator"
    part = "" if document["verdict"] == "explained" else " a part of"
    sure = [c for c in causes if not is_group(c)]
    groups = [c for c in causes if is_group(c)]
    if len(causes) == 1 and sure:
        return f"{titled(sure[0])} explains{part} the gap"
    if len(causes) == 1:
        return f"one of {len(groups[0]['group'])} causes explains{part} the gap; these runs cannot tell which"
    if not groups:
        return f"{len(causes)} causes explain{part} the gap"
    open_ones = "one of them" if len(groups) == 1 else f"{len(groups)} of them"
    return f"{len(causes)} causes explain{part} the gap; what {open_ones} may be, these runs cannot tell"


def announced(document: Mapping[str, Any]) -> str:
    """The verdict and its causes in one line; a group as a group."""
    if document["mistakes"]:
        return f"{document['verdict'].replace('_', ' ')}: {headline(document)}"
    causes = []
    if len(document["causes"]) > _FEW:
        return f"{document['verdict'].replace('_', ' ')}: {len(document['causes'])} causes"
    for cause in document["causes"]:
        if is_group(cause):
            members = [f"{titled(m)} ({percent(m['probability'])})" for m in cause["group"]]
            causes.append(f"one of {', '.join(members)}")
        else:
            causes.append(titled(cause))
    return f"{document['verdict'].replace('_', ' ')}{': ' if causes else ''}{'; '.join(causes)}"


def in_detail(document: Mapping[str, Any]) -> list[str]:
    """Lines below the verdict: what a run looks like, sizes and what they close."""
    lines = mistakes_in_words(document)
    for cause in document["causes"]:
        found = "; ".join(sizes(cause, document["raw_unit"], document["part"]))
        if found or len(document["causes"]) > _FEW:
            lines.append(f"{'if it is ' * is_group(cause)}{titled(cause)}: {found}")
    closure = document["closure"]
    if closure is not None and document["causes"]:
        lines.append(
            f"in the simulator, {closed(closure)} of the gap closes on data that the fit did not see"
        )
    return lines


def closed(closure: Mapping[str, Any]) -> str:
    """How much closes, with its error."""
    return f"{100 * closure['fraction']:.1f} \N{PLUS-MINUS SIGN} {max(100 * closure['std'], 0.1):.1f} %"


def mistakes_in_words(document: Mapping[str, Any]) -> list[str]:
    """Runs that look like a mistake in run.yaml, record or wiring, and what to do with them."""
    found = document["mistakes"]
    lines = [f"{one['run']} looks like {' or '.join(one['looks_like'])}." for one in found]
    others = [run for run in document["runs"] if run not in {one["run"] for one in found}]
    if lines and others:
        lines.append(
            "Put that right, or leave it out, and diagnose again: what else is wrong shows only then "
            f"(--only-runs {','.join(others)})."
        )
    return lines


_CONSTANT = {
    "dead": "a dead gyro, left out: a healthy one would have read something else",
    "rail": "as far as its converter goes",
    "below_step": "what was to be read lies within one step of its converter, so that nobody can tell a "
    "dead gyro from a sound one",
}


def captures_in_words(document: Mapping[str, Any]) -> list[str]:
    """What is odd about the captures: constant gyros, lost records, jumps of the stamps."""
    lines = []
    for one in document["constant_gyros"]:
        said = _CONSTANT[one["judged"]]
        lines.append(f"{one['channel']} gives the one count {one['count']} all through {one['run']}: {said}.")
    for run, (lost, expected) in document["lost_records"].items():
        lines.append(f"{lost} of {expected} records of {run} are not there.")
    for run, seconds in document["stamps_jump_s"].items():
        lines.append(f"The time stamps of {run} jump by {seconds:.6g} s.")
    return lines
