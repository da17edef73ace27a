"""How the unit lies in the room, and how a direction fixed in the room looks to it as the table turns."""

from collections.abc import Sequence

import numpy as np

from withheld.arrays import Array

EARTH_RAD_S = 7.2921151467e-5

_ROOM = {
    "east": (1.0, 0.0, 0.0), "west": (-1.0, 0.0, 0.0), "north": (0.0, 1.0, 0.0),
    "south": (0.0, -1.0, 0.0), "up": (0.0, 0.0, 1.0), "down": (0.0, 0.0, -1.0),
}  # fmt: skip


def rotation(axis: Sequence[float] | Array, angle_rad: float) -> Array:
    """Right-handed rotation about a unit vector, (3, 3); Rodrigues' formula."""
    x, y, z = np.asarray(axis, dtype=float)
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    result: Array = np.eye(3) + np.sin(angle_rad) * cross + (1.0 - np.cos(angle_rad)) * (cross @ cross)
    return result


def room_to_unit(orientation: Sequence[tuple[str, str]], azimuth_deg: float) -> Array:
    """`u0`, (3, 3): a vector in local east, north, up -> the unit frame at t = 0.

    The rows are the unit's axes in the room.  Two are given; the third completes a right-handed triad.  The
    unit is then turned about local up by the azimuth, clockwise seen from above, which is the negative sense.
    """
    rows: dict[str, Array] = {axis: np.array(_ROOM[where]) for axis, where in orientation}
    for axis, first, second in (("x", "y", "z"), ("y", "z", "x"), ("z", "x", "y")):
        if axis not in rows:
            rows[axis] = np.cross(rows[first], rows[second])
    u0 = np.array([rows["x"], rows["y"], rows["z"]])
    return u0 @ rotation((0.0, 0.0, 1.0), np.deg2rad(-azimuth_deg)).T


def earth_deg_s(latitude_deg: float) -> Array:
    """Earth's rate in east, north, up [deg/s]."""
    latitude = np.deg2rad(latitude_deg)
    result: Array = np.rad2deg(EARTH_RAD_S) * np.array([0.0, np.cos(latitude), np.sin(latitude)])
    return result


def seen_from_table(vector: Array, axis: Array, alpha_rad: Array) -> Array:
    """`R(axis, -alpha) vector` for every angle, (..., 3) for `alpha_rad` of shape (...).

    The part along the axis stays, the part across it turns backwards.
    """
    along = axis * (axis @ vector)
    across = vector - along
    side = np.cross(axis, vector)
    return along + np.cos(alpha_rad)[..., None] * across - np.sin(alpha_rad)[..., None] * side
