"""The runs of a unit in order of date under control: what its charts draw, and which runs lie outside."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fogreduce.pages.attention import names_of
from fogreduce.pages.control import Control, control
from fogreduce.pages.numbers import number, plus_minus

#: Quantity of an overview -> in words.
QUANTITIES = {"offset": "Mean rate less commanded", "drift": "Drift"}
OUTSIDE = "outside limits"

Overview = Mapping[str, Any]


@dataclass(frozen=True)
class History:
    """One quantity about one axis; `there` has the places of the runs that have it, all else their order.

    Attributes
    ----------
    kind, axis : str
    there : list of int
    values, errors : list of float
        In deg/h; the standard error of the run's own noise (0: not known).
    found : Control
    """

    kind: str
    axis: str
    there: list[int]
    values: list[float]
    errors: list[float]
    found: Control

    def limits(self, k: int) -> str:
        """Limits of the k-th of `there` in words [deg/h]; only where the history has limits."""
        assert self.found.limits is not None
        low, high = self.found.limits[k]
        return f"{number(low, 3)} to {number(high, 3)}"


def histories(runs: Sequence[Overview]) -> list[History]:
    """Of the runs of one unit, in order of date: a history of each quantity about each axis."""
    out = []
    for kind in QUANTITIES:
        for axis in names_of(kind, runs):
            there = [k for k, run in enumerate(runs) if run[kind].get(axis, {}).get("value") is not None]
            if there:
                entries = [runs[k][kind][axis] for k in there]
                values = [float(entry["value"]) for entry in entries]
                errors = [float(entry["error"] or 0.0) for entry in entries]
                out.append(History(kind, axis, there, values, errors, control(values, errors)))
    return out


def outside(runs: Sequence[Overview]) -> list[list[dict[str, str]]]:
    """Of each run, in order of date, where it lies outside its unit's limits: each ``kind`` and ``text``."""
    said: list[list[dict[str, str]]] = [[] for _ in runs]
    for unit in dict.fromkeys(run["unit"] for run in runs):
        places = [place for place, run in enumerate(runs) if run["unit"] == unit]
        for history in histories([runs[place] for place in places]):
            for k in history.found.out:
                value = plus_minus(history.values[k], history.errors[k])
                text = f"{history.axis}: {QUANTITIES[history.kind].lower()} {value} deg/h"
                text += f", control limits {history.limits(k)}"
                said[places[history.there[k]]].append({"kind": OUTSIDE, "text": text})
    return said
