"""Shapes near the catalogue: what they are, and whether a diagnosis says what they resemble."""

from dataclasses import replace

import numpy as np
import pytest
from bench import campaign, change, run
from labels import cause, diagnosis, effect

from withheld.effects.catalogue import NAMES
from withheld.effects.entry import Entry
from withheld.effects.near import KIN, NEAR
from withheld.score.kin import kin_named

COUNT = 1e-7 / 0.1 * 3600.0  # deg/h


def made(name, *runs, **parameters):
    """Time and what the shape adds to gyro 1 [deg/h], to within a count."""
    t, before, after = change(campaign(*runs), Entry(name, ("gyro1",), ("*",), parameters))
    return t, (after - before)[:, 0] * COUNT


def test_each_has_a_kin_in_the_catalogue_and_is_not_in_it():
    assert set(KIN) == set(NEAR)
    assert set(KIN.values()) <= set(NAMES)
    assert not set(NEAR) & set(NAMES)


def test_two_warmings():
    t, m = made("two_warmings", run(duration=60.0), deg_h=40.0, tau_s=5.0, ratio=8.0, share=0.5)
    assert m[0] == pytest.approx(40.0, abs=COUNT)
    # at 40 s the first has fallen to e^-8, the second to 1 / e
    assert m[t == 40.0][0] == pytest.approx(20.0 * (np.exp(-8.0) + np.exp(-1.0)), abs=2 * COUNT)


def test_a_late_temperature_bias():
    # the exact world warms by 0.01 degC/s; after many lags the coil is behind by the lag's rise
    t, m = made("late_temperature_bias", run(duration=200.0), deg_h_per_degC=100.0, lag_s=20.0)
    assert m[-1] == pytest.approx(100.0 * 0.01 * (t[-1] - 20.0), abs=1.0)
    assert m[t == 5.0][0] == pytest.approx(100.0 * 0.01 * (5.0 - 20.0 * (1 - np.exp(-5.0 / 20.0))), abs=0.4)


def test_a_scale_factor_that_bends_in_the_fifth_power():
    _, m = made("fifth_power", run(rate=10.0), ppm_at_10_deg_s=50.0)
    _, twice = made("fifth_power", run(rate=20.0), ppm_at_10_deg_s=50.0)
    assert m.mean() == pytest.approx(10.0 * 50e-6 * 3600.0, rel=1e-2)
    assert twice.mean() / m.mean() == pytest.approx(32.0, rel=2e-2)


def test_a_soft_dead_zone_passes_half_at_its_edge():
    # gyro 1 stands upright at latitude 30: it reads half of Earth's rate, 7.52 deg/h
    at_edge = run(latitude_deg=30.0)
    _, m = made("soft_dead_zone", at_edge, deg_h=7.5205, soft=0.5)
    assert m.mean() == pytest.approx(-7.5205 / 2, rel=1e-2)


def test_a_slow_step_and_a_bent_ramp():
    t, m = made("slow_step", run(duration=100.0), deg_h=20.0, time_s=20.0, rise_s=30.0)
    assert not m[t < 20.0].any()
    assert m[t == 50.0][0] == pytest.approx(20.0 * (1 - 1 / np.e), abs=COUNT)
    t, m = made("bent_ramp", run(duration=100.0), deg_h_after_1_h=3600.0)
    assert m[t == 60.0][0] == pytest.approx(1.0, abs=COUNT)


NEAREST = {"effect": "bias_ramp", "channels": ["gyro2"], "runs": ["*"]}
TRUTH = {**effect("two_warmings", "gyro2", best=15.0), "nearest": NEAREST}


def said(verdict, *resembles, causes=(), remainder=()):
    keys = tuple((name, (gyro,), ("*",)) for name, gyro in resembles)
    places = tuple(("gyro", (gyro,), ("*",)) for gyro in remainder)
    return replace(diagnosis(verdict, *causes), resembles=keys, remainder=places)


def test_unknown_with_its_kin():
    assert kin_named(TRUTH, said("unexplained", ("warm_up", "gyro2")), True)
    assert kin_named(TRUTH, said("partly_explained", ("bias_ramp", "gyro2")), True)  # the nearest, too
    assert not kin_named(TRUTH, said("unexplained", ("warm_up", "gyro2")), False)  # elsewhere
    assert not kin_named(TRUTH, said("unexplained", ("warm_up", "gyro1")), True)
    assert not kin_named(TRUTH, said("unexplained", ("dead_zone", "gyro2"), ("warm_up", "gyro2")), True)
    assert not kin_named(TRUTH, said("unexplained"), True)
    assert not kin_named(TRUTH, said("no_gap", ("warm_up", "gyro2")), True)


def test_kin_named_and_the_departure_shown():
    warm = (cause("warm_up", "gyro2"),)
    assert kin_named(TRUTH, said("explained", causes=warm, remainder=("gyro2",)), True)
    assert not kin_named(TRUTH, said("explained", causes=warm), True)
    assert not kin_named(TRUTH, said("explained", causes=warm, remainder=("gyro1",)), True)
    assert not kin_named(
        TRUTH, said("explained", causes=(cause("latency", "gyro2"),), remainder=("gyro2",)), True
    )
