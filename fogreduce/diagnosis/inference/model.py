"""Causes in the chain, simulated again, with the derivatives of block means by their numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.causes import SHAPES, Cause
from fogreduce.diagnosis.inference.noise_model import Rows, Whitener
from fogreduce.diagnosis.observe.capture import RunInput

Array = NDArray[np.float64]

#: Delays, and what a second is in their units. A rate that jumps does so between two samples: which two is
#: found in steps of whole samples, and only then what else a delay does.
DELAYS = {"s": 1.0, "ms": 1e3}
_INSTANT_S = 1e-6  # too short for a sample to fall into


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


def sample_step(one: RunInput, name: str) -> float:
    """Time between the samples that are looked at where the rate jumps, in a delay's unit."""
    return DELAYS[name] * one.scene.blocks.edge_step_s(one.facts.sample_rate_hz)


def _steps(cause: Cause, name: str, inputs: Sequence[RunInput], whole: bool) -> float:
    value = cause.theta[name]
    if name == "time_s":
        here = [one for one in inputs if one.facts.run_id in cause.runs] or inputs
        return 0.5 * max(one.scene.blocks.length_s for one in here)
    if name in DELAYS:
        return max(sample_step(one, name) for one in inputs) if whole else DELAYS[name] * _INSTANT_S
    if name in SHAPES:
        return max(abs(value) * SHAPES[name], 1e-9)
    return max(abs(value) * 1e-2, 1e-6)


def modelled(
    inputs: Sequence[RunInput],
    causes: Sequence[Cause],
    whiten: Whitener,
    nominal: Array,
    whole: bool = False,
) -> Model:
    """The causes simulated, with their derivatives; `whole`: those of delays by whole samples."""
    rows = whiten.rows
    at = simulated(inputs, causes, rows)
    slopes: list[Array] = []
    for k, cause in enumerate(causes):
        if not cause.slow:
            continue
        for name in cause.theta:
            step = _steps(cause, name, inputs, whole)
            moved = replace(cause, theta={**cause.theta, name: cause.theta[name] + step})
            other = [*causes[:k], moved, *causes[k + 1 :]]
            slopes.append((simulated(inputs, other, rows) - at) / step)
    columns = np.column_stack(slopes) if slopes else np.zeros((rows.total, 0))
    change = whiten((at - nominal)[:, None])[:, 0]
    return Model(tuple(causes), change, whiten(columns))


def modelled_change(
    inputs: Sequence[RunInput], causes: Sequence[Cause], whiten: Whitener, nominal: Array
) -> Array:
    """What causes change, whitened (rows,)."""
    return whiten((simulated(inputs, causes, whiten.rows) - nominal)[:, None])[:, 0]


def changes_of(inputs: Sequence[RunInput], causes: Sequence[Cause], rows: Rows) -> Array:
    """All that each cause changes beside the others, (rows, causes) [deg/h]."""
    every = simulated(inputs, causes, rows)
    less = [simulated(inputs, [c for c in causes if c is not one], rows) for one in causes]
    return every[:, None] - np.column_stack(less)
