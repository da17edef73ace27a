"""What can be known at best where several effects are there at once."""

import pytest
from bench import THREE, UP_Y, campaign, on, run

from withheld.chain.injector import exact_world
from withheld.clairvoyant.appraisal import appraise
from withheld.clairvoyant.full_rate import Healthy
from withheld.effects.catalogue import NAMES

ALL = frozenset(NAMES)
HEALTHY = Healthy()


def appraised(of, *entries):
    """What the clairvoyant says of each of several effects."""
    return appraise(exact_world(of, entries), ALL, HEALTHY)["effects"]


def separated(effect, name):
    return next((r["separation"] for r in effect["rivals"] if r["effect"] == name), 99.0)


def test_offsets_of_two_gyros_do_not_hide_each_other():
    alone = appraised(campaign(*THREE), on("bias_offset", deg_h=1.0))[0]
    both = appraised(campaign(*THREE), on("bias_offset", deg_h=1.0), on("bias_offset", "gyro2", deg_h=0.5))
    # independent gyros, one nuisance shared that neither looks like (latitude)
    assert both[0]["snr"] == pytest.approx(alone["snr"], rel=1e-3)
    # an offset of both by one amount is no rival where each has its own
    assert all(len(r["channels"]) == 1 or r["effect"] != "bias_offset" for r in both[0]["rivals"])


def test_every_scale_factor_off_leaves_the_table_s_rate_a_rival():
    every = [on("scale_factor_error", f"gyro{i}", ppm=30.0 + 5.0 * i) for i in (1, 2, 3)]
    of = campaign(run("a", 8.0, 200.0))
    assert separated(appraised(of, *every)[0], "table_rate_error") < 1.0


def test_every_axis_tipped_is_as_good_as_a_turned_mounting_and_the_others():
    of = campaign(run("a", 8.0, 200.0), run("b", 8.0, 200.0, axis=(0.0, 1.0, 0.0), orientation=UP_Y))
    every = [
        on("axis_misalignment", "gyro1", mrad=[0.0, 0.3, 0.1]),
        on("axis_misalignment", "gyro2", mrad=[0.2, 0.0, -0.4]),
        on("axis_misalignment", "gyro3", mrad=[0.5, 0.1, 0.0]),
    ]
    assert separated(appraised(of, every[0])[0], "mount_rotation") > 6.0
    assert separated(appraised(of, *every)[0], "mount_rotation") < 0.1


def test_an_effect_far_above_the_noise_is_no_less_far_from_a_wrong_sign():
    of = campaign(*THREE)
    found = appraised(of, on("scale_factor_error", ppm=300.0), on("bias_offset", deg_h=1.0))
    # a sign turned about is 2e6 ppm: no scale factor that stands beside it may undo it
    assert separated(found[1], "polarity_error") == 99.0
