"""Judging one diagnosis, case by case as a person would."""

import pytest
from labels import cause, diagnosis, effect, label

from withheld.score.diagnosis_file import key_of
from withheld.score.judge import judge
from withheld.study.protocol import Thresholds

T = Thresholds()
RAMP = effect(
    "bias_ramp", "gyro2", deg_h_per_h=2.0, rivals=[("warm_up", "gyro2", 2.0), ("bias_step", "gyro2", 5.0)]
)


def of(one, *said, **more):
    return judge(label(*one), diagnosis(*said, **more), T)


def test_the_right_cause():
    out = of(("single", RAMP), "explained", cause("bias_ramp", "gyro2"), where=[("gyro", ["gyro2"])])
    assert (out.exact, out.by_group, out.verdict_right, out.place_right, out.flagged) == (True,) * 5
    assert out.stated == ((0.9, True),)


def test_the_right_effect_on_the_wrong_gyro_is_wrong():
    out = of(("single", RAMP), "explained", cause("bias_ramp", "gyro1"), where=[("gyro", ["gyro1"])])
    assert (out.exact, out.by_group, out.place_right) == (False, False, False)
    assert out.stated == ((0.9, False),)


def test_a_near_rival_first_is_right_by_group_where_the_truth_is_in_it():
    out = of(("single", RAMP), "explained", cause("warm_up", "gyro2", group=[("bias_ramp", "gyro2")]))
    assert (out.exact, out.by_group) == (False, True)
    assert (out.group_size, out.group_pure, out.impure_far) == (2, 2, False)


def test_a_group_without_the_truth_is_wrong():
    assert of(("single", RAMP), "explained", cause("warm_up", "gyro2")).by_group is False


def test_a_group_with_somebody_far_away_is_impure():
    wide = cause("warm_up", "gyro2", group=[("bias_ramp", "gyro2"), ("latency", "gyro1")])
    out = of(("single", RAMP), "explained", wide)
    assert (out.by_group, out.group_pure, out.impure_far) == (False, 2, True)


def test_a_member_between_the_two_thresholds_is_no_part_of_the_true_group_but_not_far():
    out = of(("single", RAMP), "explained", cause("bias_ramp", "gyro2", group=[("bias_step", "gyro2")]))
    assert (out.by_group, out.group_pure, out.impure_far) == (True, 1, False)


def test_one_cause_too_many_is_not_right():
    said = cause("bias_ramp", "gyro2"), cause("latency", "gyro1")
    out = of(("single", RAMP), "explained", *said)
    assert (out.exact, out.by_group, out.named) == (False, False, 1)


def test_two_causes_in_either_order_and_half_of_them():
    one, two = effect("bias_offset", "gyro1", snr=9.0), effect("latency", "gyro3")
    said = cause("latency", "gyro3"), cause("bias_offset", "gyro1")
    both = of(("pair", one, two), "explained", *said)
    assert (both.exact, both.named, both.snr) == (True, 2, 9.0)
    half = of(("pair", one, two), "partly_explained", said[0])
    assert (half.exact, half.named, half.verdict_right) == (False, 1, False)


def test_nothing_wrong():
    quiet, loud = of(("nothing",), "no_gap", gap=0.02), of(("nothing",), "unexplained")
    assert (quiet.flagged, quiet.verdict_right, quiet.gap) == (False, True, (0.02, False))
    assert (loud.flagged, loud.verdict_right, loud.gap) == (True, False, (0.99, False))


def test_the_run_counts_for_what_sits_in_one():
    step = effect("bias_step", "gyro1", runs=("b",))
    assert of(("single", step), "explained", cause("bias_step", "gyro1", runs=("b",))).exact
    assert not of(("single", step), "explained", cause("bias_step", "gyro1", runs=("a",))).exact


def test_a_swap_may_be_named_from_either_side():
    swap = effect("channel_swap", "gyro1", **{"with": "gyro3"})
    assert of(("single", swap), "explained", cause("channel_swap", "gyro3")).exact
    assert not of(("single", swap), "explained", cause("channel_swap", "gyro2")).exact
    assert of(("single", swap), "explained", cause("channel_swap", "gyro1", "gyro3")).exact
    assert not of(("single", swap), "explained", cause("channel_swap", "gyro1", "gyro2")).exact


def test_a_swap_s_partner_is_read_as_one_of_its_gyros():
    for partner in ("gyro1", {"value": "gyro1"}):
        item = {"effect": "channel_swap", "channels": ["gyro3"], "parameters": {"with": partner}}
        assert key_of(item) == ("channel_swap", ("gyro1", "gyro3"), ("*",))


@pytest.mark.parametrize(
    ("verdict", "where", "best", "fate"),
    [
        ("unexplained", [("gyro", ["gyro1"])], 9.0, "flagged_in_place"),
        ("partly_explained", [("noise", ["gyro1"])], 9.0, "flagged_in_place"),
        ("unexplained", [("gyro", ["gyro2"])], 9.0, "flagged_elsewhere"),
        ("unexplained", [("gyro", ["gyro1", "gyro2", "gyro3", "gyro4"])], 9.0, "flagged_elsewhere"),
        ("unexplained", [], 9.0, "flagged_elsewhere"),
        ("explained", [("gyro", ["gyro1"])], 9.0, "misattributed"),
        ("explained", [("gyro", ["gyro1"])], 4.9, "indistinguishable"),
        ("no_gap", [], 9.0, "missed"),
    ],
)
def test_fates_of_what_is_not_in_the_catalogue(verdict, where, best, fate):
    truth = effect("telegraph_bias", "gyro1", best=best)
    out = of(("stranger", truth), verdict, where=where)
    assert out.fate == fate
    assert out.verdict_right == fate.startswith("flagged")


def test_a_table_s_effect_is_in_place_at_the_stage_table_only():
    truth = effect("mount_rotation", "table")
    assert of(("single", truth), "unexplained", where=[("table", ["gyro1", "gyro2"])]).place_right
    assert not of(("single", truth), "unexplained", where=[("gyro", ["gyro1"])]).place_right


def test_no_diagnosis_is_wrong_in_every_respect():
    single, quiet = judge(label("single", RAMP), None, T), judge(label("nothing"), None, T)
    assert (single.valid, single.exact, single.by_group, single.verdict_right) == (False,) * 4
    assert (quiet.flagged, quiet.verdict_right) == (True, False)
    assert judge(label("stranger", effect("sawtooth_bias", "gyro1")), None, T).fate == "missed"


def test_pulls_and_standard_deviations():
    said = cause("bias_ramp", "gyro2", deg_h_per_h=(2.3, 0.1))
    out = of(("single", RAMP), "explained", said)
    assert out.pulls == pytest.approx([3.0])
    # attainable 1/20 relative; stated 0.1/2.3
    assert out.attainable == pytest.approx([0.1 / 2.3 * 20])


def test_vectors_pull_by_component():
    truth = effect("mount_rotation", "table", mrad=[1.0, 0.0, -1.0])
    parameters = {"mrad[0]": (1.2, 0.1), "mrad[2]": (-1.0, 0.1)}
    out = of(("single", truth), "explained", cause("mount_rotation", "table", **parameters))
    assert out.pulls == pytest.approx([2.0, 0.0])


def test_phases_pull_within_a_turn():
    truth = effect("table_rate_ripple", "table", ppm=1.0, harmonic=6, phase_rad=0.1)
    out = of(("single", truth), "explained", cause("table_rate_ripple", "table", phase_rad=(6.2831853, 0.1)))
    assert out.pulls == pytest.approx([-1.0], abs=1e-6)


def test_a_magnetic_bias_turned_round_is_the_same():
    truth = effect("magnetic_bias", "gyro1", deg_h=-0.5, field_direction=[0.6, 0.0, 0.8])
    out = of(("single", truth), "explained", cause("magnetic_bias", "gyro1", deg_h=(0.6, 0.1)))
    assert out.pulls == pytest.approx([1.0])


def test_closure_stands_beside_the_oracle_s():
    out = judge(label("single", RAMP, oracle=0.99), diagnosis("explained", closure=(0.97, 0.02)), T)
    assert out.closure == (0.97, 0.02, 0.99)
