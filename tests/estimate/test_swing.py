"""What counts as a swing, by the command and by the encoder."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.estimate.swing import FEWEST_CHANGES, LONGEST_S, RateSteps, swing_of
from fogreduce.physics.table_motion import Profile


def square(halves: int, half_s: float, rate: float = 5.0) -> Profile:
    return Profile(np.array([rate * (-1) ** k for k in range(halves)]), np.full(halves, half_s))


@pytest.mark.parametrize(
    ("halves", "half_s", "swings"),
    [
        (FEWEST_CHANGES + 1, 0.25, True),
        (FEWEST_CHANGES, 0.25, False),
        (FEWEST_CHANGES + 1, LONGEST_S, True),
        (FEWEST_CHANGES + 1, 1.01 * LONGEST_S, False),
    ],
)
def test_a_profile_swings_from_twenty_changes_on(halves: int, half_s: float, swings: bool) -> None:
    assert (swing_of(square(halves, half_s), None) is not None) == swings


def test_a_swing_between_standstills_is_where_it_is() -> None:
    swung = square(40, 0.25)
    profile = Profile(
        np.concatenate(([0.0], swung.rate_deg_s, [0.0])), np.concatenate(([60.0], swung.duration_s, [60.0]))
    )
    swing = swing_of(profile, None)
    assert swing is not None
    assert (swing.change_s[0], swing.change_s[-1]) == (60.0, 70.0)
    assert swing.half_s == 0.25
    assert swing.is_periodic
    assert not swing.by_encoder
    assert swing.covers(np.array([59.9, 65.0, 70.1])).tolist() == [False, True, False]


def log_of(profile: Profile, step_s: float) -> tuple[np.ndarray, np.ndarray]:
    time_s = np.arange(0, profile.end_s + step_s / 2, step_s)
    return time_s, np.degrees(profile.angle_at(time_s))


def test_an_encoder_shows_a_swing_that_was_not_commanded() -> None:
    command = Profile(np.array([3.0]), np.array([20.0]))
    time_s, angle = log_of(square(80, 0.25), 0.01)
    swing = swing_of(command, (time_s, angle + 3.0 * time_s))
    assert swing is not None
    assert swing.by_encoder
    assert swing.change_s.size == 79
    assert swing.half_s == pytest.approx(0.25)
    middle = np.array([0.125, 0.375])
    at = np.searchsorted(swing.steps.edge_s, middle, side="right") - 1
    np.testing.assert_allclose(swing.steps.rate_deg_s[at], [8.0, -2.0], atol=1e-9)


def test_noise_and_ripple_of_an_encoder_are_no_swing() -> None:
    command = Profile(np.array([3.0]), np.array([200.0]))
    time_s, angle = log_of(command, 0.01)
    generator = np.random.default_rng(1)
    assert swing_of(command, (time_s, angle + 0.02 * generator.standard_normal(angle.size))) is None
    assert swing_of(command, (time_s, angle + 0.01 * np.sin(2 * np.pi * time_s))) is None


def test_a_slow_log_leaves_the_command() -> None:
    profile = square(80, 0.25)
    for step_s, by_encoder in ((0.2, False), (0.05, True)):
        swing = swing_of(profile, log_of(profile, step_s))
        assert swing is not None
        assert swing.by_encoder == by_encoder


def test_a_log_that_ends_within_the_swing_leaves_the_command() -> None:
    profile = square(80, 0.25)
    time_s, angle = log_of(profile, 0.01)
    swing = swing_of(profile, (time_s[:500], angle[:500]))
    assert swing is not None
    assert not swing.by_encoder
    assert swing.change_s.size == 79


def test_angles_are_the_integral_of_the_rate() -> None:
    steps = RateSteps.of_profile(square(3, 0.5))
    np.testing.assert_allclose(
        steps.angle_at(np.array([-1.0, 0.25, 0.5, 1.0, 1.5, 9.0])), [0.0, 1.25, 2.5, 0.0, 2.5, 2.5]
    )
