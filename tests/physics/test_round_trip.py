"""The whole chain forward and back, and eq. 1 and 2 by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fogreduce.physics.alignment import (
    axis_rates_from_gyro_rates,
    axis_rates_from_unit_rate,
    gyro_axes,
    gyro_rates_from_axis_rates,
)
from fogreduce.physics.earth_rate import EarthPart, add_earth_rate, remove_earth_rate
from fogreduce.physics.frames import unit_from_enu
from fogreduce.physics.scale_factor import rate_from_raw, raw_from_rate
from fogreduce.physics.table_motion import Profile, table_rates

seeds = st.integers(0, 2**32 - 1)


def test_eq_1_by_hand() -> None:
    """C = 0.08 V/(deg/s), B = 2 mV: 10 deg/s put out 0.802 V, and -0.802 V where the wires are crossed."""
    scale, bias = np.array([0.08, 0.08]), np.array([2e-3, 2e-3])
    polarity = np.array([1.0, -1.0])
    volts = raw_from_rate(np.full((2, 1), 10.0), scale, bias, polarity)
    np.testing.assert_allclose(volts[:, 0], [0.802, -0.802], rtol=1e-15)
    np.testing.assert_allclose(rate_from_raw(volts, scale, bias, polarity), 10.0, rtol=1e-15)


def test_eq_2_by_hand() -> None:
    """Three orthogonal gyros, the second along -y: H turns its sign; a missing answer leaves no axis."""
    projection = np.diag([1.0, -1.0, 1.0])
    rates = axis_rates_from_gyro_rates(np.array([[1.0, np.nan], [2.0, 2.0], [3.0, 3.0]]), projection)
    np.testing.assert_array_equal(rates[:, 0], [1.0, -2.0, 3.0])
    assert np.isnan(rates[:, 1]).all()


def test_redundant_gyros_are_combined_by_least_squares() -> None:
    """Gyros that contradict each other by what no rate explains leave x, y, z as they were: H n = 0."""
    generator = np.random.default_rng(3)
    axes = generator.normal(size=(6, 3))
    projection = np.linalg.pinv(axes)
    np.testing.assert_allclose(gyro_axes(projection), axes, atol=1e-13)
    inconsistent = np.linalg.svd(axes)[0][:, 3:]
    np.testing.assert_allclose(axis_rates_from_gyro_rates(inconsistent, projection), 0.0, atol=1e-14)


def test_frame_signs_are_their_own_inverse() -> None:
    rates = np.array([[1.0], [2.0], [3.0]])
    signs = np.array([1.0, 1.0, -1.0])
    seen = axis_rates_from_unit_rate(rates, signs)
    np.testing.assert_array_equal(seen[:, 0], [1.0, 2.0, -3.0])
    np.testing.assert_array_equal(axis_rates_from_unit_rate(seen, signs), rates)


@settings(deadline=None)
@given(seed=seeds, n=st.integers(3, 8))
def test_chain_forward_and_back(seed: int, n: int) -> None:
    """Rates to volts and back to 1e-12 of the largest rate: random units, mountings, profiles and sites.

    Geometries are kept to a condition below 30, as any unit that is of use: each step then loses a
    rounding error or a few tens, 1e-14.
    """
    generator = np.random.default_rng(seed)
    axes = generator.normal(size=(n, 3))
    while np.linalg.cond(axes) > 30:
        axes = generator.normal(size=(n, 3))
    projection = np.linalg.pinv(axes / np.linalg.norm(axes, axis=1)[:, None])
    scale, bias = generator.uniform(0.01, 1.0, n), generator.normal(0, 1e-3, n)
    polarity = generator.choice([1.0, -1.0], n)
    signs = generator.choice([1.0, -1.0], 3)
    axis = generator.normal(size=3)
    axis /= np.linalg.norm(axis)
    u0 = unit_from_enu({"x": "up", "z": "north"}, generator.uniform(0, 360))
    profile = Profile(generator.normal(0, 10, 3), generator.uniform(1, 100, 3))
    time_s = generator.uniform(0, profile.end_s, 200)
    earth = EarthPart.of(axis, u0, generator.uniform(-90, 90), signs)
    alpha = profile.angle_at(time_s)

    commanded = table_rates(profile, axis, signs, time_s)
    readings = gyro_rates_from_axis_rates(add_earth_rate(commanded, earth, alpha), gyro_axes(projection))
    volts = raw_from_rate(readings, scale, bias, polarity)
    back = axis_rates_from_gyro_rates(rate_from_raw(volts, scale, bias, polarity), projection)
    back = remove_earth_rate(back, earth, alpha)
    np.testing.assert_allclose(back, commanded, atol=1e-12 * np.abs(commanded).max())


def test_the_papers_chain_forward_and_back(repository) -> None:
    """The same for the bundled run, its own record and mounting, over a whole turn."""
    from fogreduce.metadata.facts import RunFacts
    from fogreduce.metadata.folder import load_calibration, load_run

    run = load_run(repository / "campaigns/published/runs/x-one-turn", need_capture=False)
    facts = RunFacts.of_models(run, load_calibration(repository / "calibrations", run.calibration)[0])
    time_s = np.linspace(0, 6000, 10_001)
    alpha = facts.profile.angle_at(time_s)
    assert alpha[-1] == pytest.approx(2 * np.pi, rel=1e-15)
    commanded = table_rates(facts.profile, facts.table_axis, facts.frame_signs, time_s)
    axis_rates = add_earth_rate(commanded, facts.earth, alpha)
    calibration = facts.scale_factor, facts.bias, facts.polarity
    volts = raw_from_rate(gyro_rates_from_axis_rates(axis_rates, facts.axes), *calibration)
    back = axis_rates_from_gyro_rates(rate_from_raw(volts, *calibration), facts.projection)
    back = remove_earth_rate(back, facts.earth, alpha)
    np.testing.assert_allclose(back, commanded, atol=1e-12 * 0.06)
