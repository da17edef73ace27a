"""The attitude error of an orbit, by hand: three gyros along x, y, z."""

from __future__ import annotations

import math

import numpy as np
import pytest
from simulated_runs import run_data

from fogreduce.effects.selection import action
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.noise import LOWEST_FLICKER_HZ
from fogreduce.simulate.nominal_noise import NoiseCoefficients
from fogreduce.simulate.orbit import Orbit, attitude_error, carried_into_orbit, coefficients, noise_covariance

FACTS = RunFacts.of(
    run_data(capture={"polarity": [1, 1, 1]}),
    {"H": np.eye(3).tolist(), "scale_factor_V_per_deg_s": [1.0] * 3, "bias_V": [0.0] * 3},
)
HOURS = 6000 / 3600


def error(turning: bool, name: str, gyro: str, **parameters: object) -> np.ndarray:
    orbit = Orbit(FACTS, "x")
    weights = orbit.turning if turning else orbit.each_by_itself
    return attitude_error(weights, orbit.wrong([action(name, [gyro], ["a"], parameters, 3)]))


def test_a_bias_along_the_axis_adds_up() -> None:
    """1.2 deg/h over 100 minutes: 2 deg."""
    for turning in (True, False):
        found = error(turning, "bias_offset", "gyro1", deg_h=1.2)
        assert found == pytest.approx([2.0, 0.0, 0.0], abs=1e-12)


def test_a_bias_across_the_axis_turns_away_in_a_whole_turn() -> None:
    assert error(True, "bias_offset", "gyro2", deg_h=1.2) == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)
    assert error(False, "bias_offset", "gyro2", deg_h=1.2) == pytest.approx([0.0, 2.0, 0.0], abs=1e-12)


def test_a_scale_factor_error_is_that_share_of_the_turn() -> None:
    """100 ppm of 360 deg; Earth's rate has no part in it."""
    found = error(True, "scale_factor_error", "gyro1", ppm=100.0)
    assert found == pytest.approx([0.036, 0.0, 0.0], abs=1e-12)


def test_a_ramp_across_the_axis() -> None:
    """Along y at rate r t, turned by w t about x: over a turn int t cos(w t) = 0, int t sin(w t) = -T / w."""
    found = error(True, "bias_ramp", "gyro2", deg_h_per_h=1.0)
    rate = 1.0 / 3600**2
    w = 2 * math.pi / 6000
    assert found == pytest.approx([0.0, 0.0, -rate * 6000 / w], abs=2e-5)


def test_noise() -> None:
    """White noise of N: N sqrt(T) about every axis. A walk about the axis: K T^1.5 / sqrt(3)."""
    orbit = Orbit(FACTS, "x")
    noise = NoiseCoefficients([0.01] * 3, [0.0] * 3, [0.3] * 3)
    found = noise_covariance(orbit.turning, orbit.forward().noise_levels(noise))
    assert np.sqrt(np.diag(found["angle_random_walk"])) == pytest.approx(
        [0.01 * math.sqrt(HOURS)] * 3, rel=1e-9
    )
    assert np.all(found["bias_instability"] == 0.0)
    assert math.sqrt(found["rate_random_walk"][0, 0]) == pytest.approx(
        0.3 * HOURS**1.5 / math.sqrt(3), rel=2e-3
    )


def test_flicker_along_the_axis() -> None:
    """T^2 times the variance of the mean: B^2 / pi times the integral of sinc^2(f T) / f from 1e-5 Hz up."""
    orbit = Orbit(FACTS, "x")
    noise = NoiseCoefficients([0.0] * 3, [0.2] * 3, [0.0] * 3)
    found = noise_covariance(orbit.turning, orbit.forward().noise_levels(noise))["bias_instability"][0, 0]
    f = np.geomspace(LOWEST_FLICKER_HZ, 1.0, 200_000)
    integral = np.sum(np.sinc(f * 6000) ** 2) * np.log(f[1] / f[0])
    assert found == pytest.approx(0.2**2 / np.pi * integral * HOURS**2, rel=0.001)


def test_further_processes_add_in_square() -> None:
    orbit = Orbit(FACTS, "x")
    more = [action("bias_instability", ["gyro1"], ["a"], {"deg_h": 0.4}, 3)]
    levels = orbit.forward(more).noise_levels(NoiseCoefficients([0.01] * 3, [0.3] * 3, [0.0] * 3))
    assert list(coefficients(levels).flicker_deg_h) == pytest.approx([0.5, 0.3, 0.3])


@pytest.mark.parametrize(
    ("name", "channel", "parameters", "runs", "carried"),
    [
        ("bias_offset", "gyro1", {"deg_h": 1.0}, ["a"], True),
        ("bias_offset", "gyro1", {"deg_h": 1.0}, ["b"], False),
        ("table_rate_error", "table", {"ppm": 1.0}, ["a"], False),
        ("acceleration_bias", "gyro1", {"deg_h_per_g": 1.0}, ["a"], False),
        ("temperature_bias", "gyro1", {"deg_h_per_degC": 1.0}, ["a"], False),
        ("spikes", "gyro1", {"fraction": 0.1}, ["a"], False),
        ("bias_instability", "gyro1", {"deg_h": 1.0}, ["a"], True),
    ],
)
def test_what_goes_with_the_unit_into_orbit(
    name: str, channel: str, parameters: dict, runs: list[str], carried: bool
) -> None:
    assert (carried_into_orbit(action(name, [channel], runs, parameters, 3), ["a"]) == "") is carried
