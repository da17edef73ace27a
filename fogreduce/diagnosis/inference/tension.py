"""Tension with the calibration record: every stated uncertainty's posterior beside its prior.

A stated uncertainty is a parameter with mean 0 and a standard deviation; the runs move it. How far, in prior
standard deviations, says whether the record still holds, also where nothing is called a gap.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.noise_model import stated_actions
from fogreduce.diagnosis.inference.problem import State
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.effects.table import EFFECTS

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Tension:
    """One stated uncertainty.

    Attributes
    ----------
    effect : str
        The catalogue's name of what it is the uncertainty of.
    channels, runs : tuples of str
    unit : str
    prior_std : float
    value, std : float
        Its posterior, from a mean of 0 before.
    """

    effect: str
    channels: tuple[str, ...]
    runs: tuple[str, ...]
    unit: str
    prior_std: float
    value: float
    std: float

    @property
    def sigma(self) -> float:
        """How far the runs move it, in prior standard deviations."""
        return self.value / self.prior_std

    def document(self) -> dict[str, object]:
        """As a diagnosis has it."""
        return {
            "effect": self.effect,
            "channels": list(self.channels),
            "runs": list(self.runs),
            "unit": self.unit,
            "prior_std": self.prior_std,
            "value": self.value,
            "std": self.std,
            "sigma": self.sigma,
        }


def tensions(inputs: Sequence[RunInput], state: State) -> list[Tension]:
    """Every stated uncertainty beside the causes found, the greatest tension first.

    Parameters
    ----------
    inputs : runs
    state : State
        The causes, whose amplitudes are free in its metric.
    """
    metric, every = state.residual.metric, tuple(one.facts.run_id for one in inputs)
    mean = metric.shrink @ (metric.a.T @ state.residual.y)
    std = np.sqrt(np.maximum(np.diag(metric.shrink), 0.0))
    out = []
    for k, (step, sigmas) in enumerate(stated_actions(inputs)):
        parameter = EFFECTS[step.effect.name].parameters[0]
        size = sigmas * float(np.linalg.norm(step.parameters[parameter.name]))
        channels = tuple(gyro_name(i) for i in step.gyros) or ("table",)
        runs = ("*",) if set(step.runs) == set(every) else tuple(sorted(step.runs))
        value = size * float(mean[k])
        out.append(
            Tension(step.effect.name, channels, runs, parameter.unit, size, value, size * float(std[k]))
        )
    out += _turn_on(inputs, state, state.residual.y - metric.a @ mean)
    return sorted(out, key=lambda one: -abs(one.sigma))


def _turn_on(inputs: Sequence[RunInput], state: State, left: Array) -> list[Tension]:
    """Turn-on biases, which stand in the noise's covariance: ``E = s^2 1' S^-1 r``."""
    out = []
    stated = inputs[0].record.stated_uncertainty.turn_on_bias_deg_h
    for (i, r), matrix in state.problem.whiten.filters.items():
        if stated[i] > 0.0:
            one = matrix.sum(axis=1)
            value = stated[i] ** 2 * float(one @ left[state.problem.whiten.rows.of(i, r)])
            std = stated[i] * float(np.sqrt(max(1.0 - stated[i] ** 2 * float(one @ one), 0.0)))
            run = (inputs[r].facts.run_id,)
            out.append(Tension("turn_on_bias", (gyro_name(i),), run, "deg/h", stated[i], value, std))
    return out
