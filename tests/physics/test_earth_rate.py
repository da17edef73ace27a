"""Earth's rate: the paper's formula, cases by hand, and two truths that are not ours."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from fogreduce.constants import EARTH_RATE_DEG_S, EARTH_RATE_RAD_S
from fogreduce.physics.earth_rate import EarthPart, add_earth_rate, earth_rate_enu, remove_earth_rate
from fogreduce.physics.frames import unit_from_enu
from fogreduce.physics.table_motion import Profile, table_rates

W = EARTH_RATE_DEG_S
ROUNDING = 1e-14 * W
X, Y, Z = np.eye(3)
PLUS = np.ones(3)

vectors = st.tuples(*[st.floats(-1, 1)] * 3).map(np.array).filter(lambda v: np.linalg.norm(v) > 1e-2)
orientations = st.sampled_from(
    [
        {"x": "up", "z": "north"},
        {"y": "down", "x": "west"},
        {"z": "south", "x": "east"},
        {"x": "north", "y": "up"},
    ]
)
signs = st.tuples(*[st.sampled_from((1.0, -1.0))] * 3).map(np.array)


def part(axis: np.ndarray, orientation: dict[str, str], latitude: float, azimuth: float = 0.0) -> EarthPart:
    return EarthPart.of(axis, unit_from_enu(orientation, azimuth), latitude, PLUS)


# ------------------------------------------------------------------------------------ the paper's


def test_a_stellar_day_is_one_turn() -> None:
    """86164.0989 s (IERS, Earth's turn in inertial space): the paper's 7.2921151467e-5 rad/s to its
    digits."""
    stellar_day = 86164.0989 * W
    assert stellar_day == pytest.approx(360.0, rel=1e-9)
    per_hour = 3600 * W
    assert per_hour == pytest.approx(15.041067, abs=1e-6)  # the figure of every textbook


@pytest.mark.parametrize("latitude", [-23.21132308, 51.0])
def test_eq_3_of_the_paper(latitude: float) -> None:
    """Eq. 3 with delta positive south: (-W sin d, W cos d sin a, W cos d cos a) for x up, z north."""
    alpha = np.linspace(-7.0, 7.0, 29)
    delta = np.radians(-latitude)
    expected = W * np.array(
        [-np.sin(delta) * np.ones_like(alpha), np.cos(delta) * np.sin(alpha), np.cos(delta) * np.cos(alpha)]
    )
    seen = part(X, {"x": "up", "z": "north"}, latitude).at(alpha)
    np.testing.assert_allclose(seen, expected, atol=ROUNDING)


def test_eq_6_of_the_paper_is_frame_sign_minus_on_z() -> None:
    """Eq. 6 adds W sin d to x (south, |latitude|), takes W cos d sin a from y and adds W cos d cos a to z."""
    alpha = np.linspace(0.0, 2 * np.pi, 13)
    delta = np.radians(23.21132308)
    u0 = unit_from_enu({"x": "up", "z": "north"}, 0.0)
    earth = EarthPart.of(X, u0, -23.21132308, np.array([1.0, 1.0, -1.0]))
    rates = np.full((3, alpha.size), 0.06)
    expected = rates + W * np.array(
        [np.full(alpha.size, np.sin(delta)), -np.cos(delta) * np.sin(alpha), np.cos(delta) * np.cos(alpha)]
    )
    np.testing.assert_allclose(remove_earth_rate(rates, earth, alpha), expected, atol=1e-16)


# ------------------------------------------------------------------------------------- by hand


@pytest.mark.parametrize(("latitude", "expected"), [(90.0, W), (-90.0, -W)])
def test_at_a_pole_all_of_it_is_about_the_vertical(latitude: float, expected: float) -> None:
    """And so neither azimuth nor table angle matters."""
    alpha = np.linspace(0, 6, 7)
    for azimuth in (0.0, 77.0):
        seen = part(X, {"x": "up", "z": "north"}, latitude, azimuth).at(alpha)
        np.testing.assert_allclose(seen, np.outer([expected, 0, 0], np.ones(7)), atol=ROUNDING)


def test_at_the_equator_none_of_it_is_about_the_vertical() -> None:
    alpha = np.array([0.0, np.pi / 2, np.pi])
    seen = part(X, {"x": "up", "z": "north"}, 0.0).at(alpha)
    np.testing.assert_allclose(seen, W * np.array([[0, 0, 0], [0, 1, 0], [1, 0, -1]]), atol=ROUNDING)


def test_both_senses_of_the_table_by_hand() -> None:
    """x up, y east, z north. A quarter turn, right-handed about up, brings y north; the other way, south."""
    earth = part(X, {"x": "up", "z": "north"}, 45.0)
    level = W * np.sqrt(0.5)
    for alpha, y in ((np.pi / 2, level), (-np.pi / 2, -level)):
        np.testing.assert_allclose(earth.at(np.array([alpha]))[:, 0], [level, y, 0.0], atol=ROUNDING)


def test_both_hemispheres() -> None:
    """Across the equator the vertical part changes sign and the horizontal one does not."""
    alpha = np.linspace(0, 6, 7)
    north, south = (part(X, {"x": "up", "z": "north"}, lat).at(alpha) for lat in (37.0, -37.0))
    np.testing.assert_allclose(north, [[-1], [1], [1]] * south, atol=ROUNDING)
    assert north[0, 0] > 0


def test_azimuth_sign_by_hand() -> None:
    """z, from north 30 degrees clockwise: cos 30 of the horizontal part; y, then at 120 degrees, reads
    cos 120 = -1/2 of it."""
    seen = part(X, {"x": "up", "z": "north"}, 0.0, 30.0).at(np.zeros(1))[:, 0]
    np.testing.assert_allclose(seen, W * np.array([0.0, -0.5, np.sqrt(0.75)]), atol=ROUNDING)


def test_a_table_about_earths_axis_sees_no_turn() -> None:
    """Axis along Earth's, whatever the attitude: the part is constant and of length W."""
    for orientation, latitude, azimuth in (
        ({"x": "north", "z": "up"}, 0.0, 0.0),
        ({"y": "up", "z": "east"}, -61.3, 211.0),
    ):
        u0 = unit_from_enu(orientation, azimuth)
        axis = u0 @ earth_rate_enu(latitude) / W
        earth = EarthPart.of(axis, u0, latitude, PLUS)
        np.testing.assert_allclose(earth.constant, W * axis, atol=ROUNDING)
        np.testing.assert_allclose([earth.cosine, earth.sine], 0.0, atol=ROUNDING)


def test_frame_signs_turn_the_reading_of_their_axis_only() -> None:
    alpha = np.linspace(0, 6, 7)
    u0 = unit_from_enu({"y": "up", "x": "north"}, 12.0)
    plain = EarthPart.of(Y, u0, 40.0, PLUS).at(alpha)
    turned = EarthPart.of(Y, u0, 40.0, np.array([1.0, -1.0, -1.0])).at(alpha)
    np.testing.assert_allclose(turned, [[1], [-1], [-1]] * plain, atol=0)


# --------------------------------------------------------------- second truths, and properties


def unit_from_inertial(
    time_s: float, axis: np.ndarray, rate_deg_s: float, u0: np.ndarray, latitude: float
) -> Rotation:
    """Inertial to unit at a time: Earth's turn, the site's east-north-up, the mounting, the table."""
    longitude = 0.7
    level = np.cos(latitude)
    up = np.array([level * np.cos(longitude), level * np.sin(longitude), np.sin(latitude)])
    east = np.cross(Z, up) / np.linalg.norm(np.cross(Z, up))
    enu_from_ecef = np.array([east, np.cross(up, east), up])
    ecef_from_inertial = Rotation.from_rotvec(-EARTH_RATE_RAD_S * time_s * Z)
    table = Rotation.from_rotvec(-np.radians(rate_deg_s) * time_s * axis)
    return table * Rotation.from_matrix(u0) * Rotation.from_matrix(enu_from_ecef) * ecef_from_inertial


@settings(max_examples=60, deadline=None)
@given(
    axis=vectors,
    orientation=orientations,
    azimuth=st.floats(-180, 360),
    latitude=st.floats(-89, 89),
    rate=st.sampled_from((0.06, -0.06, 0.0, 0.01)),
    time_s=st.floats(0.0, 6000.0),
)
def test_total_rate_is_the_attitudes_own_derivative(
    axis: np.ndarray, orientation: dict[str, str], azimuth: float, latitude: float, rate: float, time_s: float
) -> None:
    """The unit's attitude in inertial space, turned by Earth and table, differentiated: what gyros sense.

    A central difference over 2 h: error (rate h)^2 / 6 of W (1.8e-7 at 0.06 deg/s, h = 1 s), rounding
    1e-16 / (2 h) rad/s; so 1e-6 W is demanded. Of our formulas only u0 is used (tested in test_frames).
    """
    axis = axis / np.linalg.norm(axis)
    u0 = unit_from_enu(orientation, azimuth)
    h = 1.0
    before, after = (
        unit_from_inertial(time_s + sign * h, axis, rate, u0, np.radians(latitude)) for sign in (-1, 1)
    )
    # after = R(-omega 2h) before for a frame that turns by omega 2h, omega seen from the frame midway.
    turned = -(after * before.inv()).as_rotvec() / (2 * h)
    earth = EarthPart.of(axis, u0, latitude, PLUS)
    profile = Profile(np.array([rate]), np.array([1e4]))
    times = np.array([time_s])
    total = add_earth_rate(table_rates(profile, axis, PLUS, times), earth, profile.angle_at(times))
    np.testing.assert_allclose(np.degrees(turned), total[:, 0], atol=1e-6 * W, rtol=1e-9)


@pytest.mark.parametrize("latitude", [-90.0, -23.21132308, 0.0, 51.3, 90.0])
@pytest.mark.parametrize("heading", [0.0, 30.0, 186.03, -77.0])
def test_against_python_ins(latitude: float, heading: float) -> None:
    """python-ins' Earth model (north-east-down) and attitudes (roll, pitch, heading), another's work.

    Its rate is rounded to 7.292115e-5 rad/s; it is brought to ours. A table that turns the unit about its y
    (then horizontal, to starboard) is its pitch, about x its roll, about z its heading.
    """
    earth = pytest.importorskip("pyins.earth", reason="python-ins, the second truth, is not installed")
    transform = pytest.importorskip("pyins.transform")
    in_ned = np.degrees(earth.rate_n(latitude)) * EARTH_RATE_RAD_S / earth.RATE
    u0 = unit_from_enu({"x": "north", "z": "down"}, heading)
    for alpha in (0.0, 0.4, -2.0, 3.0):
        degrees = np.degrees(alpha)
        for axis, roll_pitch_heading in (
            (X, [degrees, 0.0, heading]),
            (Y, [0.0, degrees, heading]),
            (Z, [0.0, 0.0, heading + degrees]),
        ):
            expected = transform.mat_from_rph(roll_pitch_heading).T @ in_ned
            seen = EarthPart.of(axis, u0, latitude, PLUS).at(np.array([alpha]))[:, 0]
            np.testing.assert_allclose(seen, expected, atol=1e-13 * W)


@given(
    axis=vectors,
    orientation=orientations,
    latitude=st.floats(-90, 90),
    frame_signs=signs,
    alpha=st.floats(-10, 10),
)
def test_length_and_part_along_the_axis_do_not_change(
    axis: np.ndarray, orientation: dict[str, str], latitude: float, frame_signs: np.ndarray, alpha: float
) -> None:
    axis = axis / np.linalg.norm(axis)
    earth = EarthPart.of(axis, unit_from_enu(orientation, 0.0), latitude, frame_signs)
    here, start = earth.at(np.array([alpha, 0.0])).T
    assert np.linalg.norm(here) == pytest.approx(W, rel=1e-12)
    assert (frame_signs * here) @ axis == pytest.approx((frame_signs * start) @ axis, abs=1e-13 * W)


def test_adding_and_removing_are_inverse() -> None:
    alpha = np.linspace(0, 6, 50)
    earth = part(X, {"x": "up", "z": "north"}, -23.2)
    rates = np.random.default_rng(5).normal(0.0, 10.0, (3, 50))
    back = remove_earth_rate(add_earth_rate(rates, earth, alpha), earth, alpha)
    np.testing.assert_allclose(back, rates, atol=1e-14)
