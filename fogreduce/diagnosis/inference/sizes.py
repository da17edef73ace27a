"""The prior of an effect's size: a mixture of scales in physical units about its realistic range."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.evidence import Fit
from fogreduce.effects.model import Parameter
from fogreduce.effects.table import EFFECTS

Array = NDArray[np.float64]


def size_parameter(candidate: Candidate) -> Parameter:
    """The parameter whose realistic range speaks for a candidate's amplitudes."""
    effect = EFFECTS[candidate.effect]
    assert effect.design is not None, f"{effect.name}: a candidate has a design"
    return next(p for p in effect.parameters if p.name == effect.design.scaled)


def size_scales(realistic: tuple[float, float]) -> tuple[Array, Array]:
    """Standard deviations of an amplitude and ln of their weights, from the range that units show."""
    low, high = realistic
    scales = [low * factor for factor, _ in priors.BELOW]
    weights = [weight for _, weight in priors.BELOW]
    scales += np.geomspace(low, high, priors.WITHIN).tolist()
    weights += [priors.WITHIN_WEIGHT / priors.WITHIN] * priors.WITHIN
    scales += [high * factor for factor, _ in priors.ABOVE]
    weights += [weight for _, weight in priors.ABOVE]
    return np.array(scales), np.log(np.array(weights) / sum(weights))


def believed(fit: Fit) -> bool:
    """Whether a candidate is no larger at its best point than is believed of its effect."""
    c = fit.candidate
    if c.fixed:
        return True
    realistic = c.realistic or size_parameter(c).realistic
    assert realistic is not None, f"{c.effect}: an amplitude needs a realistic range"
    size = float(np.linalg.norm(fit.coefficients * c.steps[fit.best]))
    return size <= priors.LARGEST * priors.ABOVE[-1][0] * realistic[1]


def width_believed(candidate: Candidate, point: int) -> bool:
    """Whether what is not scaled has no size at a point of its grid beyond what is believed of its effect."""
    at = candidate.grid[point]
    sizes = [p for p in EFFECTS[candidate.effect].parameters if p.kind == "number"]
    most = priors.LARGEST * priors.ABOVE[-1][0]
    return all(at.get(p.name, 0.0) <= most * p.realistic[1] for p in sizes if p.realistic is not None)
