"""What candidates are held against, and a set of causes as it stands there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.candidates import Candidates
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.evidence import WhitenedResidual
from fogreduce.diagnosis.inference.model import Model
from fogreduce.diagnosis.inference.noise_model import Metric, Whitener
from fogreduce.diagnosis.which.full_rate.statistics import FullRateStatistics
from fogreduce.diagnosis.which.processes.processes import Processes

Array = NDArray[np.float64]
Key = tuple[str, tuple[str, ...], tuple[str, ...], str]


@dataclass
class Problem:
    """What candidates are held against: whitener, metric, residual, candidates, full rate."""

    whiten: Whitener
    metric: Metric
    y: Array
    nominal: Array
    candidates: Candidates
    families: Candidates
    processes: Processes
    full_rate: FullRateStatistics
    base: frozenset[Key] = frozenset()


@dataclass
class State:
    """A set of causes, and what is left beside them.

    Attributes
    ----------
    model : Model
        Causes that change block means, simulated.
    causes : list of Cause
        All of them.
    residual : WhitenedResidual
        Residual left, in a metric in which their amplitudes are free and wander.
    problem : Problem
        What it stands on.
    shapes : (rows, d) array
        How the causes may wander, whitened, one standard deviation each.
    """

    model: Model
    causes: list[Cause]
    residual: WhitenedResidual
    problem: Problem
    shapes: Array

    @cached_property
    def seen(self) -> float:
        """Share of what the causes change that the stated uncertainties could not have made."""
        change = self.model.change
        left = self.problem.metric.without(change)
        return max(float(change @ left), 0.0) / max(float(change @ change), 1e-300)


def processes_of(causes: Sequence[Cause]) -> dict[tuple[str, int], float]:
    """Sizes of the random processes among causes, by kind and gyro."""
    return {key: size for c in causes for key, size in c.process.items()}
