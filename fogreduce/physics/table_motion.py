"""The table's commanded motion: rate and angle from a piecewise constant profile (contract, step 2).

A rate holds from its start up to, not including, its end; after the last one the table stands.
alpha is the integral of the rate from t = 0, positive for a right-handed turn about the table's axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Profile:
    """A commanded profile.

    Attributes
    ----------
    rate_deg_s : (k,) array
        Commanded rates [deg/s], in order.
    duration_s : (k,) array
        How long each holds [s].
    """

    rate_deg_s: Array
    duration_s: Array

    @property
    def edges_s(self) -> Array:
        """(k + 1,) times [s] at which segments begin, and at last the profile's end."""
        return np.concatenate(([0.0], np.cumsum(self.duration_s)))

    @property
    def edge_angles_deg(self) -> Array:
        """(k + 1,) table angles [deg] at `edges_s`."""
        return np.concatenate(([0.0], np.cumsum(self.rate_deg_s * self.duration_s)))

    @property
    def end_s(self) -> float:
        """The profile's end [s]."""
        return float(self.edges_s[-1])

    def segment_at(self, time_s: Array) -> NDArray[np.intp]:
        """Index of the segment that holds at each time, 0 to k; k = after the profile; -1 before t = 0."""
        return np.searchsorted(self.edges_s, time_s, side="right") - 1

    def rate_at(self, time_s: Array) -> Array:
        """Commanded rate [deg/s] at times [s]; zero outside the profile."""
        padded = np.concatenate((self.rate_deg_s, [0.0]))
        return padded[self.segment_at(time_s)]

    def angle_at(self, time_s: Array) -> Array:
        """Commanded angle alpha [rad] at times [s]; the table stands before t = 0 and after the end."""
        if len(self.rate_deg_s) == 1:
            inside = np.clip(time_s, 0.0, self.end_s)
            inside *= np.radians(self.rate_deg_s[0])
            return inside
        return np.radians(np.interp(time_s, self.edges_s, self.edge_angles_deg))


def table_rates(profile: Profile, axis: Array, frame_signs: Array, time_s: Array) -> Array:
    """The commanded rate as the projected axes read it: ``frame_signs * rate(t) * axis``, (3, N) [deg/s]."""
    return np.outer(frame_signs * axis, profile.rate_at(time_s))
