"""The commanded profile: edges by hand, and the angle as the rate's integral."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from fogreduce.physics.table_motion import Profile, table_rates

THREE = Profile(np.array([2.0, -1.0, 0.0]), np.array([10.0, 20.0, 5.0]))


def test_a_rate_holds_from_its_start_up_to_not_including_its_end() -> None:
    """Contract, step 2; after the last segment, and before t = 0, the table stands."""
    times = np.array([-1e-6, 0.0, 10.0 - 1e-6, 10.0, 30.0 - 1e-6, 30.0, 35.0 - 1e-6, 35.0, 1e6])
    np.testing.assert_array_equal(THREE.rate_at(times), [0, 2, 2, -1, -1, 0, 0, 0, 0])
    np.testing.assert_array_equal(THREE.segment_at(times), [-1, 0, 0, 1, 1, 2, 2, 3, 3])


def test_angles_by_hand() -> None:
    """2 deg/s for 10 s: 20 degrees; then 20 s of -1 deg/s takes them back to 0; then it stands."""
    times = np.array([-5.0, 0.0, 5.0, 10.0, 20.0, 30.0, 33.0, 35.0, 100.0])
    np.testing.assert_allclose(np.degrees(THREE.angle_at(times)), [0, 0, 10, 20, 10, 0, 0, 0, 0], atol=1e-13)


@pytest.mark.parametrize("rate", [0.06, -10.0])
def test_one_segment_holds_its_last_angle(rate: float) -> None:
    single = Profile(np.array([rate]), np.array([300.0]))
    expected = np.radians(rate) * np.array([0.0, 0.0, 100.0, 300.0, 300.0])
    angles = single.angle_at(np.array([-9.0, 0.0, 100.0, 300.0, 9e9]))
    np.testing.assert_allclose(angles, expected, rtol=1e-15)


def test_asking_for_angles_changes_no_input() -> None:
    times = np.array([-1.0, 1.0])
    Profile(np.array([3.0]), np.array([5.0])).angle_at(times)
    np.testing.assert_array_equal(times, [-1.0, 1.0])


segments = st.lists(st.tuples(st.floats(-100, 100), st.floats(0.01, 1000)), min_size=1, max_size=6).map(
    lambda rows: Profile(*(np.array(column) for column in zip(*rows, strict=True)))
)


@example(profile=Profile(np.array([0.0, 1.0]), np.array([16.0, 0.01])), fractions=[0.0, 1.0])
@given(profile=segments, fractions=st.lists(st.floats(0, 1), min_size=2, max_size=2))
def test_angle_is_the_integral_of_the_rate(profile: Profile, fractions: list[float]) -> None:
    """Exactly, by segments: rate x length of the part of each segment that lies between two times."""
    start, stop = (f * profile.end_s for f in sorted(fractions))
    edges = profile.edges_s
    lengths = np.clip(stop, edges[:-1], edges[1:]) - np.clip(start, edges[:-1], edges[1:])
    first, last = profile.angle_at(np.array([start, stop]))
    scale = np.radians(np.abs(profile.rate_deg_s) @ profile.duration_s)
    # a short segment after long ones: its edges are rounded as the time since the start is
    rounded = np.radians(np.abs(profile.rate_deg_s)).sum() * np.spacing(profile.end_s) * len(edges)
    within = 1e-13 * scale + rounded + 1e-300
    assert last - first == pytest.approx(np.radians(profile.rate_deg_s @ lengths), abs=within)


def test_what_the_axes_read_of_the_command() -> None:
    """frame_signs * rate * axis: an axis of length one between y and z, z reading with a minus."""
    rates = table_rates(THREE, np.array([0.0, 0.6, 0.8]), np.array([1.0, 1.0, -1.0]), np.array([1.0, 15.0]))
    np.testing.assert_allclose(rates, [[0, 0], [1.2, -0.6], [-1.6, 0.8]], atol=1e-15)
