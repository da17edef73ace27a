"""Effects files of the contract (`fogreduce/effects/1`)."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from withheld import yaml12
from withheld.effects.catalogue import NAMES, PARAMETERS, WITH_PHASE, block
from withheld.effects.entry import Entry, entry_from
from withheld.errors import BadInput


def read_effects(path: Path, gyros: int, runs: tuple[str, ...]) -> tuple[Entry, ...]:
    """The entries of a file; a name, gyro or run that does not exist is bad input, by name and place."""
    document = yaml12.load(path)
    if not isinstance(document, Mapping) or document.get("schema") != "fogreduce/effects/1":
        raise BadInput(f"{path}: expected schema fogreduce/effects/1")
    items = document.get("effects") or []
    return tuple(_entry(item, f"{path}, effect {k}", gyros, runs) for k, item in enumerate(items, start=1))


def _entry(item: Any, place: str, gyros: int, runs: tuple[str, ...]) -> Entry:
    try:
        entry = entry_from(item)
    except (KeyError, TypeError, ValueError) as error:
        raise BadInput(f"{place}: expected effect, channels, runs and parameters ({error!r})") from error
    if entry.effect not in NAMES:
        raise BadInput(f"{place}: no effect {entry.effect}")
    needed = set(PARAMETERS[entry.effect])
    allowed = needed | {"phase_rad"} if entry.effect in WITH_PHASE else needed
    if not needed <= set(entry.parameters) <= allowed:
        raise BadInput(
            f"{place}: parameters {sorted(entry.parameters)}; {entry.effect} has {sorted(allowed)}"
        )
    seats = {f"gyro{i + 1}" for i in range(gyros)}
    if block(entry.effect) == "table":
        seats = {"table"}
    elif entry.effect == "clock_error":
        seats = {"clock"}
    if not entry.channels or not set(entry.channels) <= seats:
        raise BadInput(f"{place}: channels {list(entry.channels)}; expected some of {sorted(seats)}")
    if not set(entry.runs) <= {"*", *runs}:
        raise BadInput(f"{place}: runs {list(entry.runs)}; the campaign has {list(runs)}")
    return entry
