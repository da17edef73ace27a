"""Frames: hand cases, then what any rotation must satisfy."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fogreduce.physics.frames import (
    DIRECTIONS_ENU,
    cross_matrix,
    rotation,
    turn_about_axis,
    unit_from_enu,
    up_in_unit,
)

EAST, NORTH, UP = np.eye(3)
ROUNDING = 1e-14  # some tens of rounding errors on numbers of order one

vectors = st.tuples(*[st.floats(-1, 1)] * 3).map(np.array).filter(lambda v: np.linalg.norm(v) > 1e-3)
angles = st.floats(-20.0, 20.0)


def test_paper_orientation_by_hand() -> None:
    """x up and z north: y = z x x = north x up = east."""
    u0 = unit_from_enu({"x": "up", "z": "north"}, 0.0)
    np.testing.assert_allclose(u0, [UP, EAST, NORTH], atol=ROUNDING)


@pytest.mark.parametrize(
    ("azimuth", "z_points"), [(90.0, EAST), (180.0, -NORTH), (270.0, -EAST), (-90.0, -EAST), (0.0, NORTH)]
)
def test_azimuth_is_clockwise_seen_from_above(azimuth: float, z_points: np.ndarray) -> None:
    """An axis that points north at azimuth 0 points east at 90 degrees, as a compass counts."""
    u0 = unit_from_enu({"x": "up", "z": "north"}, azimuth)
    np.testing.assert_allclose(u0[2], z_points, atol=ROUNDING)
    np.testing.assert_allclose(u0[0], UP, atol=ROUNDING)


def test_every_orientation_is_a_right_handed_frame() -> None:
    opposite = {"up": "down", "north": "south", "east": "west"}
    opposite |= {b: a for a, b in opposite.items()}
    count = 0
    for (first, second), (one, other) in itertools.product(
        itertools.permutations("xyz", 2), itertools.permutations(DIRECTIONS_ENU, 2)
    ):
        if opposite[one] == other:
            continue
        u0 = unit_from_enu({first: one, second: other}, 33.0)
        np.testing.assert_allclose(u0 @ u0.T, np.eye(3), atol=ROUNDING)
        assert np.linalg.det(u0) == pytest.approx(1.0, abs=ROUNDING)
        np.testing.assert_allclose(up_in_unit(u0), u0[:, 2], atol=0)
        count += 1
    assert count == 6 * 24


def test_a_right_handed_turn_about_up_takes_east_to_north() -> None:
    np.testing.assert_allclose(rotation(UP, np.pi / 2) @ EAST, NORTH, atol=ROUNDING)


@given(axis=vectors, angle=angles)
def test_rotation_agrees_with_scipy(axis: np.ndarray, angle: float) -> None:
    unit = axis / np.linalg.norm(axis)
    np.testing.assert_allclose(
        rotation(unit, angle), Rotation.from_rotvec(angle * unit).as_matrix(), atol=1e-13
    )


@given(axis=vectors, vector=vectors)
def test_cross_matrix_is_the_cross_product(axis: np.ndarray, vector: np.ndarray) -> None:
    np.testing.assert_allclose(cross_matrix(axis) @ vector, np.cross(axis, vector), atol=ROUNDING)


@given(axis=vectors, vector=vectors, angle=angles)
def test_split_by_angle_is_the_turn_seen_from_the_unit(
    axis: np.ndarray, vector: np.ndarray, angle: float
) -> None:
    unit = axis / np.linalg.norm(axis)
    constant, cosine, sine = turn_about_axis(unit, vector)
    seen = constant + np.cos(angle) * cosine + np.sin(angle) * sine
    np.testing.assert_allclose(seen, Rotation.from_rotvec(-angle * unit).apply(vector), atol=1e-13)
