"""From an effects file to what acts where: names, channels, runs and parameters checked against the table."""

from __future__ import annotations

import difflib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import Any

from fogreduce.effects.gyro_names import gyro_index, gyro_name
from fogreduce.effects.model import Effect, Parameter
from fogreduce.effects.table import EFFECTS
from fogreduce.errors import BadInput, Fault
from fogreduce.metadata.effects_file import EffectEntry


@dataclass(frozen=True)
class Action:
    """One entry of an effects file, checked.

    Attributes
    ----------
    effect : Effect
    gyros : tuple of int
        Indices from 0; empty for what is common to all.
    runs : frozenset of str
        Ids of the runs in which it acts.
    parameters : mapping
        Every parameter of the effect; None for a phase that is to be drawn.
    ordinal : int
        How many entries of the same effect stand before it: part of its random stream's name.
    """

    effect: Effect
    gyros: tuple[int, ...]
    runs: frozenset[str]
    parameters: Mapping[str, Any]
    ordinal: int

    def acting(self) -> list[tuple[int, Mapping[str, Any]]]:
        """(gyro, parameters) for every place at which it acts; gyro -1 where it is common to all."""
        if not self.gyros:
            return [(-1, self.parameters)]
        places = [(gyro, self.parameters) for gyro in self.gyros]
        if self.effect.mutual:
            other = gyro_index(self.parameters[self.effect.mutual])
            places += [(other, {**self.parameters, self.effect.mutual: gyro_name(i)}) for i in self.gyros]
        return places


def select(
    entries: Sequence[EffectEntry], run_ids: Sequence[str], n_gyros: int, file: object
) -> list[Action]:
    """Check entries against the table, the campaign's runs and the unit's gyros.

    Parameters
    ----------
    entries : sequence of EffectEntry
        As read.
    run_ids : sequence of str
        All runs of the campaign.
    n_gyros : int
        Gyros of the unit.
    file : path
        To name in a fault.

    Raises
    ------
    BadInput
        With every fault.
    """
    faults: list[Fault] = []
    actions: list[Action] = []
    seen: dict[str, int] = {}
    for k, entry in enumerate(entries):
        check = _Check(str(file), f"effects[{k}]", n_gyros)
        action = check.entry(entry, run_ids, seen.get(entry.effect, 0))
        seen[entry.effect] = seen.get(entry.effect, 0) + 1
        faults += check.faults
        if action is not None:
            actions.append(action)
    if faults:
        raise BadInput(*faults)
    return actions


def action(
    effect: str, channels: Iterable[str], runs: Iterable[str], parameters: Mapping[str, Any], n_gyros: int
) -> Action:
    """One action from plain values, for callers who do not start from a file; `runs` are run ids."""
    run_ids = list(runs)
    entry = EffectEntry(
        effect=effect, channels=tuple(channels), runs=tuple(run_ids), parameters=dict(parameters)
    )
    return select([entry], run_ids, n_gyros, "effect")[0]


class _Check:
    """One entry being checked: collects faults."""

    def __init__(self, file: str, where: str, n_gyros: int) -> None:
        self.file, self.where, self.n_gyros = file, where, n_gyros
        self.faults: list[Fault] = []

    def wrong(self, key: str, found: object, expected: str) -> None:
        self.faults.append(Fault(self.file, f"{self.where}.{key}", str(found), expected))

    def entry(self, entry: EffectEntry, run_ids: Sequence[str], ordinal: int) -> Action | None:
        effect = EFFECTS.get(entry.effect)
        if effect is None:
            near = difflib.get_close_matches(entry.effect, EFFECTS, n=1)
            hint = f" (did you mean {near[0]}?)" if near else ""
            self.wrong("effect", entry.effect + hint, "an effect of the catalogue")
            return None
        gyros = self.channels(effect, entry.channels)
        parameters = self.parameters(effect, entry.parameters)
        runs = self.runs(entry.runs, run_ids)
        self.together(effect, gyros, parameters)
        return None if self.faults else Action(effect, gyros, runs, parameters, ordinal)

    def channels(self, effect: Effect, channels: Sequence[str]) -> tuple[int, ...]:
        if effect.channels != "gyro":
            if tuple(channels) not in ((effect.channels,), ("*",)):
                self.wrong("channels", list(channels), f"[{effect.channels}]")
            return ()
        if tuple(channels) == ("*",):
            return tuple(range(self.n_gyros))
        indices = []
        for k, name in enumerate(channels):
            index = self.gyro(f"channels[{k}]", name)
            if index in indices:
                self.wrong(f"channels[{k}]", f"{name} again", "each gyro once")
            indices.append(index)
        return tuple(indices)

    def gyro(self, key: str, name: object) -> int:
        index = gyro_index(name) if isinstance(name, str) else -1
        if not 0 <= index < self.n_gyros:
            self.wrong(key, name, f"one of gyro1 to gyro{self.n_gyros}")
        return index

    def runs(self, patterns: Sequence[str], run_ids: Sequence[str]) -> frozenset[str]:
        chosen: set[str] = set()
        for k, pattern in enumerate(patterns):
            found = {run_id for run_id in run_ids if run_id == pattern or fnmatchcase(run_id, pattern)}
            if not found:
                self.wrong(f"runs[{k}]", pattern, "a run of the campaign, or * for all")
            chosen |= found
        return frozenset(chosen)

    def parameters(self, effect: Effect, given: Mapping[str, Any]) -> dict[str, Any]:
        parameters_by_name = {p.name: p for p in effect.parameters}
        for name in given:
            if name not in parameters_by_name:
                near = difflib.get_close_matches(name, parameters_by_name, n=1)
                hint = f" (did you mean {near[0]}?)" if near else ""
                names = ", ".join(parameters_by_name) or "none at all"
                self.wrong(
                    f"parameters.{name}", "an unknown parameter" + hint, f"those of {effect.name}: {names}"
                )
        values: dict[str, Any] = {}
        for name, parameter in parameters_by_name.items():
            if name in given:
                values[name] = self.value(f"parameters.{name}", parameter, given[name])
            elif parameter.required:
                unit = f" [{parameter.unit}]" if parameter.unit else ""
                self.wrong(f"parameters.{name}", "nothing", f"{parameter.meaning}{unit}")
            else:
                values[name] = parameter.default
        return values

    def value(self, key: str, parameter: Parameter, value: object) -> Any:
        if parameter.kind == "gyro":
            self.gyro(key, value)
            return value
        if parameter.kind == "choice":
            if value not in parameter.choices:
                self.wrong(key, value, "one of " + ", ".join(parameter.choices))
            return value
        if parameter.kind == "vector":
            if not isinstance(value, tuple | list) or len(value) != 3:
                self.wrong(key, value, "three numbers [x, y, z]")
                return (0.0, 0.0, 0.0)
            vector = tuple(self.number(key, parameter, part) for part in value)
            if parameter.off is None and not any(vector):
                self.wrong(key, list(vector), "a vector with a direction")
            return vector
        number = self.number(key, parameter, value)
        if parameter.kind == "integer":
            if not number.is_integer():
                self.wrong(key, value, "a whole number")
                return 0
            return int(number)
        return number

    def number(self, key: str, parameter: Parameter, value: object) -> float:
        if isinstance(value, bool) or not isinstance(value, int | float) or math.isnan(value):
            self.wrong(key, value, "a number")
            return float(parameter.low)
        if not parameter.low <= value <= parameter.high:
            self.wrong(key, value, f"{parameter.low:g} to {parameter.high:g}")
            return float(parameter.low)
        return float(value)

    def together(self, effect: Effect, gyros: tuple[int, ...], parameters: Mapping[str, Any]) -> None:
        """What an entry's parts must be to each other."""
        if len(gyros) < effect.smallest_group and effect.channels == "gyro":
            self.wrong("channels", f"{len(gyros)} gyro", f"at least {effect.smallest_group}")
        for p in effect.parameters:
            if p.kind == "gyro" and gyro_index(str(parameters.get(p.name, ""))) in gyros:
                self.wrong(f"parameters.{p.name}", parameters[p.name], "another gyro than those of channels")
        if effect.mutual and len(gyros) > 1:
            self.wrong("channels", f"{len(gyros)} gyros", "one gyro; the other one is the parameter")
        correlation = parameters.get("correlation", 0.0)
        if effect.name == "common_noise" and len(gyros) > 1 and correlation < -1.0 / (len(gyros) - 1):
            self.wrong(
                "parameters.correlation",
                correlation,
                f"at least {-1 / (len(gyros) - 1):g} for {len(gyros)} gyros",
            )
