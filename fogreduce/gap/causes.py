"""Causes: effects with parameters, simulated again, and fitted by Gauss-Newton on the simulator itself."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.effects.selection import Action, action
from fogreduce.effects.table import EFFECTS
from fogreduce.gap.candidates import Candidate
from fogreduce.gap.capture import RunInput
from fogreduce.gap.evidence import Fit
from fogreduce.gap.findings import Finding
from fogreduce.gap.noise_model import Metric, Rows, Whitener
from fogreduce.gap.predict import SLOW_STAGES

Array = NDArray[np.float64]

#: Parameters in which an effect is not linear, and the relative step of their finite difference.
_SHAPES = {"tau_s": 1e-3, "time_s": 0.0, "volts": 1e-5, "s": 1e-3}
_LARGEST_MRAD = 999.0
_RISE_S = 1.0  # no step is quite sudden: doubt of its instant [s]


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
            if name in _SHAPES or (name == "deg_h" and c.fixed):
                theta[name] = float(settled.pop(name))
        return cls(c.effect, c.channels, c.runs, theta, settled, {}, c.extra.get("tips"))

    @classmethod
    def of_finding(cls, finding: Finding) -> Cause:
        """From a full-rate finding."""
        return cls(finding.effect, finding.channels, finding.runs, {}, {}, {}, None, finding)

    @property
    def key(self) -> tuple[str, tuple[str, ...], tuple[str, ...], str]:
        """As a candidate's."""
        other = self.settled.get("source", self.settled.get("with", ""))
        return self.effect, self.channels, self.runs, str(other)

    @property
    def slow(self) -> bool:
        """Whether it changes block means."""
        return EFFECTS[self.effect].stage in SLOW_STAGES and (
            self.finding is None or self.effect == "low_pass"
        )

    def parameters(self) -> dict[str, Any]:
        """As an effects file has them."""
        if self.finding is not None:
            return {name: value for name, (value, _) in self.finding.parameters.items()}
        t, out = dict(self.theta), dict(self.settled)
        if "cos" in t:
            out["ppm"] = float(np.hypot(t.pop("cos"), t["sin"]))
            out["phase_rad"] = float(np.arctan2(t.pop("sin"), self.theta["cos"]) % (2.0 * np.pi))
        if "field[0]" in t:
            vector = np.array([t.pop(f"field[{k}]") for k in range(3)])
            size = float(np.linalg.norm(vector))
            out["deg_h"] = size
            out["field_direction"] = (vector / size).tolist() if size > 0 else [0.0, 0.0, 1.0]
        if "tip[0]" in t and self.tips is not None:
            out["mrad"] = (t.pop("tip[0]") * self.tips[0] + t.pop("tip[1]") * self.tips[1]).tolist()
        if "mrad[0]" in t:
            out["mrad"] = [t.pop(f"mrad[{k}]") for k in range(3)]
        if "mrad" in out:
            out["mrad"] = np.clip(out["mrad"], -_LARGEST_MRAD, _LARGEST_MRAD).tolist()
        out.update(t)
        for p in EFFECTS[self.effect].parameters:
            if p.kind == "number" and isinstance(out.get(p.name), float):
                out[p.name] = float(np.clip(out[p.name], p.low, p.high))
        return out

    def stated(self) -> dict[str, dict[str, Any]]:
        """Parameters with one standard deviation, as a diagnosis states them."""
        if self.finding is not None:
            return {name: {"value": v, "std": s} for name, (v, s) in self.finding.parameters.items()}
        s = self.std
        out: dict[str, dict[str, Any]] = {}
        for name, value in self.parameters().items():
            std: Any = s.get(name)
            if name == "ppm" and "cos" in self.theta:
                std = s.get("cos")
            elif name == "phase_rad" and "cos" in self.theta:
                size = float(np.hypot(self.theta["cos"], self.theta["sin"]))
                std = s.get("cos", 0.0) / size if size else None
            elif name == "deg_h" and "field[0]" in self.theta:
                std = float(np.sqrt(sum(s.get(f"field[{k}]", 0.0) ** 2 for k in range(3)) / 3.0))
            elif name == "mrad" and self.tips is not None:
                both = np.array([s.get("tip[0]", 0.0) * self.tips[0], s.get("tip[1]", 0.0) * self.tips[1]])
                std = np.sqrt(np.sum(both**2, axis=0)).tolist()
            elif name == "mrad":
                std = [s.get(f"mrad[{k}]", 0.0) for k in range(3)]
            out[name] = {"value": value, "std": std}
        return out

    def action(self, run_ids: Sequence[str], n: int) -> Action:
        """What the simulator takes."""
        runs = run_ids if self.runs == ("*",) else self.runs
        return action(self.effect, self.channels, runs, self.parameters(), n)


@dataclass(frozen=True)
class Model:
    """Causes in the chain, and how the residual looks beside them.

    Attributes
    ----------
    causes : tuple of Cause
    change : (rows,) array
        What they change, whitened.
    slopes : (rows, p) array
        Its derivatives by every free number of the slow causes, whitened.
    """

    causes: tuple[Cause, ...]
    change: Array
    slopes: Array


def simulated(inputs: Sequence[RunInput], causes: Sequence[Cause], rows: Rows) -> Array:
    """Block means of the chain with causes in it, (rows,) [deg/h]."""
    ids, n = [one.facts.run_id for one in inputs], rows.n
    actions = [replace(c.action(ids, n), ordinal=k) for k, c in enumerate(causes) if c.slow]
    return rows.stacked([one.scene.block_means(actions) for one in inputs])


def _steps(cause: Cause, name: str, length_s: float) -> float:
    value = cause.theta[name]
    if name == "time_s":
        return 0.5 * length_s
    if name in _SHAPES:
        return max(abs(value) * _SHAPES[name], 1e-9)
    return max(abs(value) * 1e-2, 1e-6)


def modelled(inputs: Sequence[RunInput], causes: Sequence[Cause], whiten: Whitener, nominal: Array) -> Model:
    """The causes simulated, with their derivatives."""
    rows = whiten.rows
    at = simulated(inputs, causes, rows)
    slopes = []
    for k, cause in enumerate(causes):
        if not cause.slow:
            continue
        for name in cause.theta:
            step = _steps(cause, name, inputs[0].scene.blocks.length_s)
            moved = replace(cause, theta={**cause.theta, name: cause.theta[name] + step})
            other = [*causes[:k], moved, *causes[k + 1 :]]
            slopes.append((simulated(inputs, other, rows) - at) / step)
    columns = np.column_stack(slopes) if slopes else np.zeros((rows.total, 0))
    return Model(tuple(causes), whiten((at - nominal)[:, None])[:, 0], whiten(columns))


def refined(
    inputs: Sequence[RunInput],
    causes: Sequence[Cause],
    whiten: Whitener,
    nominal: Array,
    metric: Metric,
    y: Array,
    rounds: int = 4,
) -> Model:
    """The causes with the parameters that fit best, by damped Gauss-Newton; standard deviations from the
    curvature.
    """
    model = modelled(inputs, causes, whiten, nominal)
    chi2 = _chi2(metric, y - model.change)
    for _ in range(rounds):
        if not model.slopes.shape[1]:
            return model
        gram = metric.gram(model.slopes, model.slopes)
        scale = np.sqrt(np.maximum(np.diag(gram), 1e-300))
        step = (
            np.linalg.lstsq(
                gram / np.outer(scale, scale),
                metric.gram(model.slopes, (y - model.change)[:, None])[:, 0] / scale,
                rcond=1e-10,
            )[0]
            / scale
        )
        damping, better = 1.0, False
        while damping > 0.05:
            moved = _moved(model.causes, damping * step)
            trial = modelled(inputs, moved, whiten, nominal)
            found = _chi2(metric, y - trial.change)
            if found <= chi2 + 1e-9:
                better = found < chi2 - 0.01
                model, chi2 = trial, found
                break
            damping *= 0.35
        if not better:
            break
    covariance = np.linalg.pinv(metric.gram(model.slopes, model.slopes), rcond=1e-13, hermitian=True)
    return replace(model, causes=_with_std(model.causes, np.sqrt(np.maximum(np.diag(covariance), 0.0))))


def _chi2(metric: Metric, y: Array) -> float:
    return float(metric.gram(y[:, None], y[:, None])[0, 0])


def _moved(causes: Sequence[Cause], step: Array) -> list[Cause]:
    out, k = [], 0
    for cause in causes:
        if cause.slow:
            theta = dict(cause.theta)
            for name in theta:
                theta[name] = _within(cause, name, theta[name] + float(step[k]))
                k += 1
            cause = replace(cause, theta=theta)
        out.append(cause)
    return out


def _within(cause: Cause, name: str, value: float) -> float:
    """A number kept to what the effect accepts."""
    for p in EFFECTS[cause.effect].parameters:
        if p.name == name:
            low = max(p.low, 1e-3) if name == "tau_s" else p.low
            return float(np.clip(value, low, p.high))
    return value


def _with_std(causes: Sequence[Cause], std: Array) -> tuple[Cause, ...]:
    out, k = [], 0
    for cause in causes:
        if cause.slow:
            own = {name: float(std[k + j]) for j, name in enumerate(cause.theta)}
            if "time_s" in own:
                own["time_s"] = float(np.hypot(own["time_s"], _RISE_S))
            out.append(replace(cause, std=own))
            k += len(cause.theta)
        else:
            out.append(cause)
    return tuple(out)
