"""Causes in words, the same wherever they are named."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from fogreduce.diagnosis.inference.causes import Cause


def named(cause: Cause) -> str:
    """A cause: effect, channels, the other gyro of a pair, and the run where it is not in all."""
    return _words(cause.effect, cause.channels, cause.runs, cause.key[3])


def in_words(item: Mapping[str, Any]) -> str:
    """The same for a cause of a diagnosis.json, or a member of its group."""
    given = item.get("parameters", {})
    other = given.get("source", given.get("with", ""))
    other = other["value"] if isinstance(other, Mapping) else other
    return _words(item["effect"], item["channels"], item["runs"], other)


def _words(effect: str, channels: Sequence[str], runs: Sequence[str], other: str) -> str:
    joint = {"channel_swap": "with", "crosstalk": "from"}.get(effect, "at")
    pair = f" {joint} {other}" if other else ""
    where = "" if list(runs) == ["*"] else f" in {', '.join(runs)}"
    return f"{effect} {', '.join(channels)}{pair}{where}"


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
