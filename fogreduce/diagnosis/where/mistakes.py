"""Runs that are off by so much that they look like a mistake: a wrong sign, sense, factor, axis or wiring.

What each run looks like is for the tests that a reduction makes (`fogreduce.estimate.mistakes`): here its
block means are put as mean curves for them.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import EARTH_RATE_DEG_S, SECONDS_PER_HOUR
from fogreduce.diagnosis.inference.candidate import EVERY
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.diagnosis.observe.data import Data
from fogreduce.effects.table import EFFECTS
from fogreduce.estimate.mean_curve import CurveBasis
from fogreduce.estimate.mistakes import MeasuredCurve, MeasuredSegment, likely_mistakes
from fogreduce.estimate.uncertainty import StatedErrors
from fogreduce.physics.noise import white_sigma
from fogreduce.physics.scale_factor import raw_from_rate

Array = NDArray[np.float64]

#: A mean of this part of the largest commanded rate, and more than Earth's rate, is gross; as in rates.csv.
_GROSS = 0.1
#: Segments of a profile that are looked at: the longest of them.
_MOST_SEGMENTS = 12
#: A size of so many times what units show is out of proportion.
_FAR = 100.0


def mistakes(data: Data, verdict: str, causes: Sequence[Cause] = ()) -> list[dict[str, Any]]:
    """Runs that look like mistakes, as a diagnosis has them: ``run`` and ``looks_like``, the best first.

    Parameters
    ----------
    data : Data
    verdict : str
        What is explained needs no other words, unless a run has a cause to itself that is out of proportion.
    causes : sequence of Cause
    """
    if verdict == "no_gap":
        return []
    odd = {run for c in causes if c.runs != EVERY and _out_of_proportion(c) for run in c.runs}
    found = []
    for one, residual, sizes in zip(data.inputs, data.residual, data.sizes, strict=True):
        if verdict == "explained" and one.facts.run_id not in odd:
            continue
        words = _looks_like(one, residual / SECONDS_PER_HOUR, sizes)
        if words:
            found.append({"run": one.facts.run_id, "looks_like": words})
    return found


def _out_of_proportion(cause: Cause) -> bool:
    """Whether its size is far beyond what units show."""
    given, parameters = cause.parameters(), EFFECTS[cause.effect].parameters
    return any(
        abs(float(given[p.name])) > _FAR * p.realistic[1]
        for p in parameters[:1]
        if p.kind == "number" and p.realistic is not None and p.name in given
    )


def _looks_like(one: RunInput, residual: Array, sizes: Array) -> list[str]:
    """What a run looks like; nothing where no gyro's mean is gross. `residual`: (n, blocks) [deg/s]."""
    facts, profile = one.facts, one.facts.profile
    largest = max(_GROSS * float(np.max(np.abs(profile.rate_deg_s))), EARTH_RATE_DEG_S)
    measured = residual + one.scene.block_means() / SECONDS_PER_HOUR
    stated = np.array(one.record.stated_noise.angle_random_walk_deg_sqrt_h)
    white = np.asarray(white_sigma(stated, facts.sample_rate_hz))
    segments, gross = [], False
    longest = np.argsort(-profile.duration_s, kind="stable")[:_MOST_SEGMENTS]
    for k in sorted(longest.tolist()):
        start, stop = profile.edges_s[k : k + 2].tolist()
        basis = CurveBasis.of(start, stop, float(profile.rate_deg_s[k]))
        here = (one.scene.blocks.centre_s > start) & (one.scene.blocks.centre_s < stop)
        curves = []
        for i in range(facts.n_gyros):
            there = here & (sizes[i] > 0.0)
            if np.sum(there) <= len(basis.whiten):
                continue
            gross |= bool(abs(np.mean(residual[i, there])) > largest)
            curves.append(_curve(one, i, basis, measured[i], there, float(white[i]), sizes[i]))
        segments.append(MeasuredSegment.of(profile, k + 1, curves))
    if not gross:
        return []
    return likely_mistakes(facts, StatedErrors.of(one.run, one.record), segments)


def _curve(
    one: RunInput,
    i: int,
    basis: CurveBasis,
    rate: Array,
    there: NDArray[np.bool_],
    white: float,
    sizes: Array,
) -> MeasuredCurve:
    """The mean curve of a gyro's raw readings over a segment, by least squares on its block means."""
    facts, gyro = one.facts, slice(i, i + 1)
    scale, polarity = facts.scale_factor[gyro], facts.polarity[gyro]
    columns = basis.columns(one.scene.blocks.centre_s[there])
    inverse = np.linalg.inv(columns @ columns.T)
    theta = basis.to_theta @ (inverse @ (columns @ rate[there]))
    raw = raw_from_rate(theta[None, :], scale, np.zeros(1), polarity)[0]
    raw[0] = raw_from_rate(theta[None, :1], scale, facts.bias[gyro], polarity)[0, 0]
    noise = (white * facts.scale_factor[i]) ** 2 / float(np.mean(sizes[there]))
    covariance = noise * basis.to_theta @ inverse @ basis.to_theta.T
    return MeasuredCurve(i, raw, covariance, basis.has_sine)
