"""Causes: effects judged present, with free numbers and what is stated of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.departures import doubted
from fogreduce.diagnosis.inference.evidence import Fit
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.observe.predict import SLOW_STAGES
from fogreduce.effects.design import Design
from fogreduce.effects.selection import Action, action
from fogreduce.effects.table import EFFECTS

Array = NDArray[np.float64]

#: Parameters in which an effect is not linear, and the relative step of their finite difference.
SHAPES = {p.name: p.bends for e in EFFECTS.values() for p in e.parameters if p.bends is not None}
_LARGEST_MRAD = 999.0
#: What a vector has along a direction that these runs do not show, relative to what they show of it.
UNSEEN = 1.5


@dataclass(frozen=True)
class Cause:
    """An effect judged present.

    Attributes
    ----------
    effect : str
    channels, runs : tuples of str
    theta : mapping
        Free numbers: scaled ones and those of shape, as a candidate names them.
    settled : mapping
        Parameters that are no free numbers.
    std : mapping
        Standard deviations of `theta`.
    spread : (p, p) array or None
        Covariance of `theta`.
    tips : pair of (3,) arrays or None
        Directions of a tipped axis.
    finding : Finding or None
        For what the full rate shows.
    """

    effect: str
    channels: tuple[str, ...]
    runs: tuple[str, ...]
    theta: Mapping[str, float]
    settled: Mapping[str, Any]
    std: Mapping[str, float]
    tips: tuple[Array, Array] | None = None
    finding: Finding | None = None
    spread: Array | None = None

    @classmethod
    def of_fit(cls, fit: Fit) -> Cause:
        """From a candidate's best point."""
        c: Candidate = fit.candidate
        theta = {
            name: float(value) * float(step)
            for name, value, step in zip(c.scales, fit.coefficients, c.steps[fit.best], strict=False)
        }
        settled = dict(c.grid[fit.best]) | {k: v for k, v in c.extra.items() if k != "tips"}
        for name in list(settled):
            if name in SHAPES or (name == "deg_h" and c.fixed):
                theta[name] = float(settled.pop(name))
        return cls(c.effect, c.channels, c.runs, theta, settled, {}, c.extra.get("tips"))

    @classmethod
    def of_finding(cls, finding: Finding) -> Cause:
        """From a full-rate finding."""
        return cls(finding.effect, finding.channels, finding.runs, {}, {}, {}, None, finding)

    @property
    def key(self) -> tuple[str, tuple[str, ...], tuple[str, ...], str]:
        """As a candidate's."""
        if self.finding is not None:
            return self.finding.key
        other = self.settled.get("source", self.settled.get("with", ""))
        return self.effect, self.channels, self.runs, str(other)

    @property
    def slow(self) -> bool:
        """Whether it changes block means."""
        return EFFECTS[self.effect].stage in SLOW_STAGES and (
            self.finding is None or self.effect == "low_pass"
        )

    @property
    def process(self) -> dict[tuple[str, int], float]:
        """(kind, gyro) -> size of what it adds to the noise; empty unless it is a random process."""
        if self.finding is None or self.finding.process is None:
            return {}
        kind, size = self.finding.process
        return {(kind, int(self.channels[0][4:]) - 1): size}

    @property
    def unlogged(self) -> bool:
        """Whether a temperature without a log does it: it has no numbers and cannot be simulated."""
        return self.finding is not None and EFFECTS[self.effect].needs_temperature

    def parameters(self) -> dict[str, Any]:
        """As an effects file has them."""
        if self.finding is not None:
            return {name: value for name, (value, _) in self.finding.parameters.items()}
        t, out = dict(self.theta), dict(self.settled)
        design = EFFECTS[self.effect].design
        if design is not None and design.wave and "cos" in t:
            out[design.scaled] = float(np.hypot(t.pop("cos"), t["sin"]))
            out[design.wave] = float(np.arctan2(t.pop("sin"), self.theta["cos"]) % (2.0 * np.pi))
        elif design is not None and design.vector:
            out |= self._vector(design)
            t = {}
        out.update(t)
        for p in EFFECTS[self.effect].parameters:
            if p.kind == "number" and isinstance(out.get(p.name), float):
                out[p.name] = float(np.clip(out[p.name], p.low, p.high))
        return out

    def _vector(self, design: Design) -> dict[str, Any]:
        """What is scaled of a vector, as the effect's parameters have it."""
        t, scaled = self.theta, design.scaled
        if design.vector == "room":
            vector = np.array([t[f"field[{k}]"] for k in range(3)])
            size = float(np.linalg.norm(vector))
            return {scaled: size, design.along: (vector / size).tolist() if size > 0 else [0.0, 0.0, 1.0]}
        if self.tips is not None:
            vector = t["tip[0]"] * self.tips[0] + t["tip[1]"] * self.tips[1]
        else:
            vector = np.array([t[f"{scaled}[{k}]"] for k in range(3)])
        return {scaled: np.clip(vector, -_LARGEST_MRAD, _LARGEST_MRAD).tolist()}

    def stated(self) -> dict[str, dict[str, Any]]:
        """Parameters with one standard deviation, as a diagnosis states them."""
        if self.finding is not None:
            return {
                name: {"value": v, "std": doubted(self.effect, name, v, s) if s else s}
                for name, (v, s) in self.finding.parameters.items()
            }
        out: dict[str, dict[str, Any]] = {}
        design = EFFECTS[self.effect].design or Design()
        for name, value in self.parameters().items():
            out[name] = {"value": value, "std": self.std.get(name)}
            if design.wave and name in (design.scaled, design.wave):
                size, std = float(np.hypot(self.theta["cos"], self.theta["sin"])), self.std.get("cos", 0.0)
                out[name]["std"] = std if name == design.scaled else std / size if size else None
            elif design.vector == "room" and name == design.scaled:
                out[name]["std"] = self._length_std([f"field[{k}]" for k in range(3)])
            elif design.vector and name == design.scaled:
                parts = [self.std.get(f"{name}[{k}]", 0.0) for k in range(3)]
                out[name]["std"] = parts if self.tips is None else self._tip_std(self.tips).tolist()
                out[name] |= self._size_and_direction(value, design)
        return out

    def _size_and_direction(self, vector: Sequence[float], design: Design) -> dict[str, Any]:
        """A small rotation or tip as a length with its error and a unit vector."""
        size = float(np.linalg.norm(vector))
        direction = (np.array(vector) / size).tolist() if size > 0.0 else [0.0, 0.0, 0.0]
        names = [f"{design.scaled}[{k}]" for k in range(3)] if self.tips is None else ["tip[0]", "tip[1]"]
        return {"size": size, "size_std": self._length_std(names), "direction": direction}

    def _length_std(self, names: Sequence[str]) -> float:
        """Of the length of a vector of these components: to first order along it, to second across it."""
        vector = np.array([self.theta[name] for name in names])
        length = max(float(np.linalg.norm(vector)), 1e-12)
        if self.spread is None:
            return 0.0
        along = float(vector @ self.spread @ vector) / length**2
        across = float(np.trace(self.spread)) - along
        return float(np.hypot(np.sqrt(max(along, 0.0)), across / (2.0 * length)))

    def _tip_std(self, tips: tuple[Array, Array]) -> Array:
        """Of a tip's components (3,): a part along the axis does nothing, so that it cannot be known."""
        across = [self.std.get(f"tip[{k}]", 0.0) * tips[k] for k in range(2)]
        along = UNSEEN * np.hypot(self.theta["tip[0]"], self.theta["tip[1]"]) * np.cross(*tips)
        result: Array = np.sqrt(across[0] ** 2 + across[1] ** 2 + along**2)
        return result

    def action(self, run_ids: Sequence[str], n: int) -> Action:
        """What the simulator takes."""
        runs = run_ids if self.runs == ("*",) else self.runs
        return action(self.effect, self.channels, runs, self.parameters(), n)
