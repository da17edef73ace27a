"""One thing that is wrong: an effect, its seat, its parameters, its departure from the catalogue's shape."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from withheld.arrays import Array
from withheld.streams import stream


@dataclass(frozen=True)
class Entry:
    """An entry of an effects file.

    Parameters
    ----------
    effect : str
    channels : tuple of str
        `gyro1` ..., `table` or `clock`.
    runs : tuple of str
        Run ids, or `("*",)` for all.
    parameters : mapping
        In the catalogue's names and units.
    departure : mapping
        How the shape differs from the catalogue's; empty: not at all.  `wobble`, `wobble_period_s` and
        `wobble_phase_rad` multiply what the effect adds by `1 + wobble sqrt(2) sin(2 pi t / period + phase)`;
        the other keys belong to one effect and are named where they are used.
    """

    effect: str
    channels: tuple[str, ...]
    runs: tuple[str, ...] = ("*",)
    parameters: Mapping[str, Any] = field(default_factory=dict)
    departure: Mapping[str, float] = field(default_factory=dict)

    def acts_in(self, run_id: str) -> bool:
        """Whether the effect is present in that run."""
        return "*" in self.runs or run_id in self.runs

    def number(self, parameter: str) -> float:
        """A parameter that is a number."""
        return float(self.parameters[parameter])

    def gyros(self) -> list[int]:
        """Indices, from 0, of the gyros named."""
        return [int(name[4:]) - 1 for name in self.channels if name.startswith("gyro")]

    def wobble(self, t: Array) -> Array | float:
        """The factor of the generic departure at times `t` [s]; 1 without one."""
        size = self.departure.get("wobble", 0.0)
        if size == 0.0:
            return 1.0
        turn = 2 * np.pi * t / self.departure["wobble_period_s"] + self.departure["wobble_phase_rad"]
        factor: Array = 1.0 + size * np.sqrt(2.0) * np.sin(turn)
        return factor

    def phase_rad(self, run_id: str) -> float:
        """The stated phase; one that is not stated is drawn afresh for each run."""
        if "phase_rad" in self.parameters:
            return float(self.parameters["phase_rad"])
        words = (self.effect, run_id, repr(sorted(self.parameters.items())))
        return float(stream(0, "phase", *words).uniform(0.0, 2 * np.pi))

    def document(self) -> dict[str, Any]:
        """As a plain mapping; the departure only where there is one."""
        document: dict[str, Any] = {
            "effect": self.effect, "channels": list(self.channels), "runs": list(self.runs),
            "parameters": dict(self.parameters),
        }  # fmt: skip
        if self.departure:
            document["departure"] = dict(self.departure)
        return document


def entry_from(document: Mapping[str, Any]) -> Entry:
    """The inverse of `Entry.document`."""
    return Entry(
        document["effect"], tuple(document["channels"]), tuple(document.get("runs", ("*",))),
        dict(document.get("parameters", {})), dict(document.get("departure", {})),
    )  # fmt: skip


def select(entries: tuple[Entry, ...], run_id: str, *effects: str) -> list[Entry]:
    """The entries of these effects that act in the run, in the order given."""
    return [entry for entry in entries if entry.effect in effects and entry.acts_in(run_id)]
