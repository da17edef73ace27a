"""Functions of time taken to the coefficients that a fitted mean curve would have of them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.mean_curve import CurveBasis
from fogreduce.physics.table_motion import Profile

Array = NDArray[np.float64]

_GRID = 512  # times a segment at which functions are worked out
_GOLDEN = (5**0.5 - 1) / 2  # steps of this part of a segment fill it evenly and never beat with its turns


@dataclass(frozen=True)
class CurveProjection:
    """Least squares of the mean curve on an even choice of times within a segment.

    Attributes
    ----------
    time_s : (N,) array
        The times, from the run's start [s].
    to_theta : (4, N) array
        Takes values at these times to theta = (a, p, q, e), see `fogreduce.estimate.mean_curve`.
    """

    time_s: Array
    to_theta: Array

    @classmethod
    def of(cls, profile: Profile, segment: int, terms: int = 4) -> CurveProjection:
        """Of a segment of the profile, from 1; `terms` as `CurveBasis.first` takes them."""
        edges = profile.edges_s
        start, stop = float(edges[segment - 1]), float(edges[segment])
        # What is projected is a sum of 1, cos(alpha) and sin(alpha), which the curve holds, or nearly so: any
        # even choice of times finds its coefficients.
        time_s = start + (stop - start) * np.sort((0.5 + _GOLDEN * np.arange(_GRID)) % 1.0)
        basis = CurveBasis.of(start, stop, float(profile.rate_deg_s[segment - 1])).first(terms)
        columns = basis.columns(time_s)
        return cls(time_s, basis.to_theta @ np.linalg.inv(columns @ columns.T) @ columns)
