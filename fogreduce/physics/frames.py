"""Frames: local east-north-up, the unit frame, and rotations between them (capture contract, steps 1, 2).

Conventions
-----------
- local frame: east, north, up (ENU), right-handed;
- unit frame: x, y, z fixed to the unit, right-handed;
- ``R(u, a)`` is the right-handed (active) rotation of a vector about u by a;
- azimuth is positive clockwise seen from above, that is a right-handed turn by ``-azimuth`` about up.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

#: Directions that an axis may point to, in east-north-up.
DIRECTIONS_ENU: dict[str, tuple[float, float, float]] = {
    "east": (1.0, 0.0, 0.0),
    "west": (-1.0, 0.0, 0.0),
    "north": (0.0, 1.0, 0.0),
    "south": (0.0, -1.0, 0.0),
    "up": (0.0, 0.0, 1.0),
    "down": (0.0, 0.0, -1.0),
}

AXES = ("x", "y", "z")


def cross_matrix(axis: Array) -> Array:
    """Matrix K with ``K v = axis x v``."""
    x, y, z = axis
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def rotation(axis: Array, angle_rad: float) -> Array:
    """R(u, a): the right-handed rotation about the unit vector `axis` by `angle_rad` (Rodrigues), 3 x 3."""
    cross = cross_matrix(axis)
    return np.eye(3) + np.sin(angle_rad) * cross + (1.0 - np.cos(angle_rad)) * (cross @ cross)


def across(axis: Array) -> tuple[Array, Array]:
    """Two unit vectors at right angles to `axis` and to each other."""
    along = axis / np.linalg.norm(axis)
    first = np.cross(along, np.eye(3)[int(np.argmin(np.abs(along)))])
    first /= np.linalg.norm(first)
    return first, np.cross(along, first)


def turn_about_axis(axis: Array, vector: Array) -> tuple[Array, Array, Array]:
    """A vector fixed in the room as the turning unit sees it, split by how it depends on the angle.

    ``R(axis, -alpha) v = constant + cos(alpha) cosine + sin(alpha) sine``.

    Parameters
    ----------
    axis : (3,) array
        Unit vector of the table's axis, unit frame.
    vector : (3,) array
        v in the unit frame at alpha = 0.

    Returns
    -------
    constant, cosine, sine : (3,) arrays
    """
    constant = axis * (axis @ vector)
    return constant, vector - constant, -np.cross(axis, vector)


def seen_by_unit(axis: Array, vector: Array, alpha_rad: Array) -> Array:
    """A vector fixed in the room as the turning unit sees it, ``R(axis, -alpha) v``, (3, N).

    Parameters
    ----------
    axis, vector : (3,) arrays
        As of `turn_about_axis`.
    alpha_rad : (N,) array
        Table angles [rad].
    """
    constant, cosine, sine = turn_about_axis(axis, vector)
    seen = np.outer(cosine, np.cos(alpha_rad))
    seen += np.outer(sine, np.sin(alpha_rad))
    seen += constant[:, None]
    return seen


def unit_from_enu(orientation: Mapping[str, str], azimuth_deg: float) -> Array:
    """u0 (3 x 3): takes local east-north-up vectors into the unit frame at t = 0.

    Parameters
    ----------
    orientation : mapping
        Two of x, y, z to ``up | down | north | south | east | west``; the third axis completes a
        right-handed triad.
    azimuth_deg : float
        The unit is then turned about local up by this much, clockwise seen from above [deg].

    Returns
    -------
    (3, 3) array
        Row k is unit axis k in east-north-up.
    """
    given = {AXES.index(name): np.array(DIRECTIONS_ENU[to]) for name, to in orientation.items()}
    (missing,) = set(range(3)) - set(given)
    first, second = (missing + 1) % 3, (missing + 2) % 3
    given[missing] = np.cross(given[first], given[second])
    up = np.array(DIRECTIONS_ENU["up"])
    turned = rotation(up, -np.radians(azimuth_deg))
    return np.array([turned @ given[k] for k in range(3)])


def up_in_unit(unit_from_enu_matrix: Array) -> Array:
    """Local vertical (up) in the unit frame at t = 0, (3,)."""
    return unit_from_enu_matrix @ np.array(DIRECTIONS_ENU["up"])
