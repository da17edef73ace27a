"""Earth's rate as the unit sees it (the paper's eq. 3 to 6, capture contract, steps 2 to 5).

The paper's eq. 3 is the special case axis = x, x up, z north. Its eq. 6 is eq. 5 with
``frame_signs = (1, 1, -1)``: the z axis reads a positive rotation with a negative sign.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import EARTH_RATE_DEG_S
from fogreduce.physics.frames import turn_about_axis

Array = NDArray[np.float64]


def earth_rate_enu(latitude_deg: float) -> Array:
    """Earth's rate in east-north-up [deg/s]: ``(0, W cos(lat), W sin(lat))``; latitude north positive."""
    latitude = np.radians(latitude_deg)
    return EARTH_RATE_DEG_S * np.array([0.0, np.cos(latitude), np.sin(latitude)])


@dataclass(frozen=True)
class EarthPart:
    """What the projected axes read of Earth's rate, as a function of the table angle alpha.

    ``part(alpha) = constant + cos(alpha) cosine + sin(alpha) sine``, each (3,) [deg/s], frame signs in it.
    Equal to ``frame_signs * R(axis, -alpha) u0 earth``.
    """

    constant: Array
    cosine: Array
    sine: Array

    @classmethod
    def of(cls, axis: Array, unit_from_enu: Array, latitude_deg: float, frame_signs: Array) -> EarthPart:
        """From the table's axis (3,), u0 (3, 3), latitude [deg] and frame signs (3,)."""
        terms = turn_about_axis(axis, unit_from_enu @ earth_rate_enu(latitude_deg))
        return cls(*(frame_signs * term for term in terms))

    def at(self, alpha_rad: Array) -> Array:
        """Earth's part [deg/s], (3, N), at table angles alpha [rad], (N,)."""
        terms = np.empty((3, alpha_rad.size))
        terms[0] = 1.0
        np.cos(alpha_rad, out=terms[1])
        np.sin(alpha_rad, out=terms[2])
        part: Array = np.column_stack((self.constant, self.cosine, self.sine)) @ terms
        return part


def add_earth_rate(table_rates: Array, earth: EarthPart, alpha_rad: Array) -> Array:
    """What the axes read in all: the table's part plus Earth's. (3, N) [deg/s]."""
    return table_rates + earth.at(alpha_rad)


def remove_earth_rate(axis_rates: Array, earth: EarthPart, alpha_rad: Array) -> Array:
    """Rates with Earth's part taken away (eq. 6), the inverse of `add_earth_rate`. (3, N) [deg/s]."""
    return axis_rates - earth.at(alpha_rad)
