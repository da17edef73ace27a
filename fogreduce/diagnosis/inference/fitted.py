"""Causes fitted together by Gauss-Newton on the simulator itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.causes import UNSEEN, Cause
from fogreduce.diagnosis.inference.departures import departures
from fogreduce.diagnosis.inference.instants import ends, timed
from fogreduce.diagnosis.inference.model import DELAYS, Model, modelled, modelled_change, sample_step
from fogreduce.diagnosis.inference.noise_model import Metric, Whitener
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.effects.table import EFFECTS

Array = NDArray[np.float64]

#: Noise softens the edge at which a voltage is clipped: doubt of it, relative.
_EDGE = 0.01
#: A time constant is looked at over so wide a range about the best one.
_WIDE = np.geomspace(0.1, 10.0, 11)
#: Steps to the samples between which the rate jumps; where they start: in blocks, about the delay at first.
_MOST_MOVES = 8
_ABOUT = np.arange(-8, 9) / 8.0
_FAR = 2.0  # times what noise leaves
_BY_FAR = 50.0  # of chi-squared
#: A width is as good as another within so much of chi-squared, one standard deviation; how far off, relative,
#: it is looked at first, how much further then, and how often its end is halved.
_AS_GOOD, _NEAR, _FURTHER, _HALVINGS = 1.0, 0.01, 1.6, 7
_WIDEST = np.log(1e3)  # times as wide, or as narrow


@dataclass(frozen=True)
class _Gap:
    """A residual, and what is needed to simulate what causes make of it."""

    inputs: Sequence[RunInput]
    whiten: Whitener
    nominal: Array
    metric: Metric
    y: Array

    def change(self, causes: Sequence[Cause]) -> Array:
        """What the causes change, whitened."""
        return modelled_change(self.inputs, causes, self.whiten, self.nominal)

    def chi2(self, change: Array) -> float:
        """Of what a change leaves of the residual."""
        left = (self.y - change)[:, None]
        return float(self.metric.gram(left, left)[0, 0])


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
    if not any(c.theta for c in causes if c.slow):
        return modelled(inputs, causes, whiten, nominal)
    gap = _Gap(inputs, whiten, nominal, metric, y)
    if any(name in DELAYS for c in causes for name in c.theta):
        causes = _sought(gap, causes)
        causes = _descended(gap, causes, _MOST_MOVES, True).causes
    model = _descended(gap, causes, rounds, False)
    instants = {}
    if any("time_s" in c.theta for c in model.causes):
        at = _at_instants(gap, model)
        instants = {c.key: c.std["time_s"] for c in at if "time_s" in c.std}
        model = _better(gap, model, _descended(gap, at, 1, False))
    causes = _with_spread(model.causes, _spread(inputs, model, whiten, metric))
    causes = tuple(
        replace(c, std={**c.std, "time_s": instants[c.key]}) if c.key in instants else c for c in causes
    )
    with_widths = [
        _widened(gap, causes, k) if "tau_s" in c.theta else _between_samples(gap, causes, k)
        for k, c in enumerate(causes)
    ]
    model = replace(model, causes=tuple(with_widths))
    for k, c in enumerate(model.causes):
        design = EFFECTS[c.effect].design
        if design is not None and design.exact == "reading":
            model = _between_readings(gap, model, k)
    return model


def _between_readings(gap: _Gap, model: Model, which: int) -> Model:
    """The width of a dead zone in the middle of all that do as well: between two runs' readings any does."""
    cause = model.causes[which]
    (name,) = cause.theta
    value, others = cause.theta[name], (model.causes[:which], model.causes[which + 1 :])
    most = gap.chi2(model.change) + _AS_GOOD
    largest = max(float(np.abs(one.scene.block_means()).max()) for one in gap.inputs)

    def at(size: float) -> list[Cause]:
        return [*others[0], replace(cause, theta={name: size}), *others[1]]

    def as_good(ratio: float) -> bool:
        return value * ratio <= largest and gap.chi2(gap.change(at(value * ratio))) <= most

    ends = []
    for sign in (-1.0, 1.0):
        inside, outside = 0.0, float(np.log1p(_NEAR))
        while as_good(np.exp(sign * outside)) and outside < _WIDEST:
            inside, outside = outside, _FURTHER * outside
        for _ in range(_HALVINGS if inside else 0):
            middle = 0.5 * (inside + outside)
            inside, outside = (middle, outside) if as_good(np.exp(sign * middle)) else (inside, middle)
        ends.append(value * float(np.exp(sign * inside)))
    middle, std = 0.5 * sum(ends), (ends[1] - ends[0]) / np.sqrt(12.0)
    if std <= cause.std.get(name, 0.0) or not as_good(middle / value):
        return model
    causes = at(middle)
    causes[which] = replace(causes[which], std={name: float(std)})
    return modelled(gap.inputs, causes, gap.whiten, gap.nominal)


def _at_instants(gap: _Gap, model: Model) -> list[Cause]:
    """The causes, each that stepped at its most probable instant beside the others."""
    out, column = list(model.causes), 0
    for k, cause in enumerate(model.causes):
        if not cause.slow:
            continue
        its_columns = np.arange(column, column + len(cause.theta))
        column += len(cause.theta)
        if "time_s" in cause.theta:
            others = np.delete(model.slopes, its_columns, axis=1)
            rest = [*out[:k], *out[k + 1 :]]
            left = gap.y - gap.change(rest)
            out[k] = timed(gap.inputs, cause, gap.whiten, gap.metric.with_free(others), left)
    return out


def _better(gap: _Gap, one: Model, other: Model) -> Model:
    """The model that leaves less."""
    return other if gap.chi2(other.change) < gap.chi2(one.change) else one


def _sought(
    gap: _Gap,
    causes: Sequence[Cause],
) -> list[Cause]:
    """The causes with the best delays about theirs: from an edge in the wrong block no step leads on."""

    def left(trial: Sequence[Cause]) -> float:
        return gap.chi2(gap.change(trial))

    best = list(causes)
    for k, cause in enumerate(causes):
        for name in DELAYS.keys() & cause.theta.keys():
            if left(best) <= _FAR * gap.whiten.rows.total:
                return best
            span = DELAYS[name] * max(one.scene.blocks.length_s for one in gap.inputs)
            values = [_within(cause, name, cause.theta[name] + share * span) for share in _ABOUT]
            moved = [replace(cause, theta={**cause.theta, name: value}) for value in values]
            best = min(([*best[:k], one, *best[k + 1 :]] for one in moved), key=left)
    return best


def _descended(
    gap: _Gap,
    causes: Sequence[Cause],
    rounds: int,
    whole: bool,
) -> Model:
    """The causes where steps of Gauss and Newton lead no further."""
    model = modelled(gap.inputs, causes, gap.whiten, gap.nominal, whole)
    chi2 = gap.chi2(model.change)
    for _ in range(rounds):
        gram = gap.metric.gram(model.slopes, model.slopes)
        scale = np.sqrt(np.maximum(np.diag(gram), 1e-300))
        step = (
            np.linalg.lstsq(
                gram / np.outer(scale, scale),
                gap.metric.gram(model.slopes, (gap.y - model.change)[:, None])[:, 0] / scale,
                rcond=1e-10,
            )[0]
            / scale
        )
        damping, better = 1.0, False
        while damping > 0.05:
            moved = _moved(gap.inputs, model.causes, damping * step)
            trial = modelled(gap.inputs, moved, gap.whiten, gap.nominal, whole)
            found = gap.chi2(trial.change)
            if found <= chi2 + 1e-9:
                better = found < chi2 - 0.01
                model, chi2 = trial, found
                break
            damping *= 0.35
        if not better:
            break
    return model


def _widened(gap: _Gap, causes: Sequence[Cause], which: int) -> Cause:
    """A decaying effect with the spread of amplitude and time constant that the likelihood far from its peak
    has.
    """
    cause = causes[which]
    amplitude, tau = cause.theta["deg_h"], cause.theta["tau_s"]
    values, logs = [], []
    for factor in _WIDE.tolist():
        moved = replace(cause, theta={"deg_h": amplitude, "tau_s": _within(cause, "tau_s", tau * factor)})
        change = gap.change([*causes[:which], moved, *causes[which + 1 :]])
        without = gap.change([*causes[:which], *causes[which + 1 :]])
        column, left = (change - without)[:, None], (gap.y - without)[:, None]
        gram = max(float(gap.metric.gram(column, column)[0, 0]), 1e-12)
        size = float(gap.metric.gram(column, left)[0, 0]) / gram
        values.append((size * amplitude, moved.theta["tau_s"], amplitude**2 / gram))
        logs.append(0.5 * size**2 * gram)
    weight = np.exp(np.array(logs) - max(logs))
    weight /= weight.sum()
    a, t, variance = np.array(values).T
    wide = {
        "deg_h": float(np.sqrt(weight @ ((a - amplitude) ** 2 + variance))),
        "tau_s": float(np.sqrt(weight @ (t - tau) ** 2)),
    }
    return replace(cause, std={name: max(cause.std[name], wide[name]) for name in cause.std})


def _between_samples(gap: _Gap, causes: Sequence[Cause], which: int) -> Cause:
    """A delayed effect known at least to a sample, where a jump of the rate a sample off fits far worse."""
    cause = causes[which]
    std = dict(cause.std)
    for name in DELAYS.keys() & cause.theta.keys():
        step = max(sample_step(one, name) for one in gap.inputs)
        left = []
        for shift in (-step, 0.0, step):
            moved = replace(
                cause, theta={**cause.theta, name: _within(cause, name, cause.theta[name] + shift)}
            )
            trial = [*causes[:which], moved, *causes[which + 1 :]]
            left.append(gap.chi2(gap.change(trial)))
        if min(left[0], left[2]) > left[1] + _BY_FAR:
            std[name] = min(std[name], step / np.sqrt(3.0))
    return replace(cause, std=std)


def _spread(inputs: Sequence[RunInput], model: Model, whiten: Whitener, metric: Metric) -> Array:
    """Covariance of all free numbers: from the curvature, and from how the effects may depart from their
    shapes.
    """
    slow = [c for c in model.causes if c.slow]
    weak = np.concatenate([_weak(c) for c in slow])
    covariance = np.linalg.pinv(
        metric.gram(model.slopes, model.slopes) + np.diag(weak), rcond=1e-13, hermitian=True
    )
    ids, n = [one.facts.run_id for one in inputs], whiten.rows.n
    actions = [replace(c.action(ids, n), ordinal=k) for k, c in enumerate(slow)]
    total: Array = np.asarray(covariance, np.float64)
    for k in range(len(slow)):
        shapes = departures(inputs, actions, k, whiten.rows)
        if shapes.shape[1]:
            shift = covariance @ metric.gram(model.slopes, whiten(shapes))
            total = total + shift @ shift.T
    return total


def _weak(cause: Cause) -> Array:
    """Inverse variances of a cause's numbers before any data: a vector is of no more than its own size."""
    out = np.zeros(len(cause.theta))
    parts = [k for k, name in enumerate(cause.theta) if name.endswith("]")]
    values = list(cause.theta.values())
    size = float(np.sqrt(sum(values[k] ** 2 for k in parts)))
    if size > 0.0:
        out[parts] = (UNSEEN * size) ** -2.0
    return out


def _moved(inputs: Sequence[RunInput], causes: Sequence[Cause], step: Array) -> list[Cause]:
    out, k = [], 0
    for cause in causes:
        if cause.slow:
            theta = dict(cause.theta)
            for name in theta:
                theta[name] = _within(cause, name, theta[name] + float(step[k]))
                if name == "time_s":
                    theta[name] = float(np.clip(theta[name], *ends(inputs, cause)))
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


def _with_spread(causes: Sequence[Cause], spread: Array) -> tuple[Cause, ...]:
    out, k = [], 0
    for cause in causes:
        if cause.slow:
            covariance = spread[k : k + len(cause.theta), k : k + len(cause.theta)]
            std = dict(zip(cause.theta, np.sqrt(np.maximum(np.diag(covariance), 0.0)).tolist(), strict=True))
            if "volts" in std:
                std["volts"] = float(np.hypot(std["volts"], _EDGE * cause.theta["volts"]))
            out.append(replace(cause, std=std, spread=covariance))
            k += len(cause.theta)
        else:
            out.append(cause)
    return tuple(out)
