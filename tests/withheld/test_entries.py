"""Campaigns with many entries, scored as a person would."""

import pytest
from labels import cause, diagnosis, effect, label

from withheld.score.class_tables import class_tables
from withheld.score.entries import score_entries
from withheld.score.judge import judge
from withheld.study.protocol import Thresholds

T = Thresholds()
CLEAR = effect("bias_offset", "gyro1", snr=30.0, best=12.0, deg_h=0.6)
SECOND = effect("bias_offset", "gyro2", snr=20.0, best=9.0, deg_h=0.4)
# every gyro's scale factor is off: the table's rate could stand for any one of them
EXCHANGED = effect("scale_factor_error", "gyro3", snr=25.0, best=0.1, ppm=300.0,
                   rivals=[("table_rate_error", "table", 0.1), ("crosstalk", "gyro3", 5.0)])  # fmt: skip
FAINT = effect("bias_ramp", "gyro4", snr=4.0, best=2.0, deg_h_per_h=1.0)
TRUTH = (CLEAR, SECOND, EXCHANGED, FAINT)


def scored(*causes, truth=TRUTH, verdict="explained", **more):
    return score_entries(label("stale", *truth), diagnosis(verdict, *causes, **more), T)


def test_entries_that_must_be_named_are_those_clear_of_everything():
    out = scored(cause("bias_offset", "gyro1"), cause("bias_offset", "gyro3"))
    # gyro 1 named, gyro 2 not; the exchangeable and the faint one need not be; gyro 3 has no offset
    assert out.must == (True, False)
    assert out.exchangeable == (False,)
    assert out.strays == (False, True)
    assert not out.once


def test_a_member_of_the_true_group_stands_for_an_entry():
    out = scored(*(cause("bias_offset", f"gyro{i}") for i in (1, 2)), cause("table_rate_error", "table"))
    assert out.exchangeable == (True,)
    assert out.strays == (False, False, False)


def test_one_cause_stands_for_one_entry():
    others = [{**EXCHANGED, "channels": [f"gyro{i}"]} for i in (1, 2)]
    out = scored(cause("table_rate_error", "table"), truth=(EXCHANGED, *others))
    assert sorted(out.exchangeable) == [False, False, True]
    every = [cause("table_rate_error", "table"), *(cause("scale_factor_error", f"gyro{i}") for i in (1, 2))]
    out = scored(*every, truth=(EXCHANGED, *others))
    assert out.exchangeable == (True, True, True)
    assert out.once


def test_numbers_beside_a_cause_in_an_entry_s_place_count_only_where_an_entry_must_be_named():
    off = cause("scale_factor_error", "gyro3", ppm=(900.0, 1.0))
    good = cause("bias_offset", "gyro1", deg_h=(0.61, 0.02))
    assert scored(good, off).within == (True, False)
    assert scored(good, off, cause("table_rate_error", "table")).within == (True,)


def test_one_line_named_is_not_two():
    lines = [effect("periodic_interference", "gyro1", frequency_hz=f, deg_h=1.0) for f in (12.0, 30.0)]
    one = cause("periodic_interference", "gyro1", frequency_hz=(30.0, 0.001))
    out = scored(one, truth=tuple(lines))
    assert out.must == (False, True)
    assert out.within == (True,)
    two = cause("periodic_interference", "gyro1", frequency_hz=(12.001, 0.001))
    out = scored(one, two, truth=tuple(lines))
    assert (out.must, out.within) == ((True, True), (True, True))
    # one line twice is as many causes as entries, and one of them wrong by name only in its number
    assert scored(one, one, truth=tuple(lines)).within == (False, True)


def test_a_rival_between_the_thresholds_is_a_stray():
    out = scored(cause("crosstalk", "gyro3"))
    assert (out.exchangeable, out.strays) == ((False,), (True,))


def test_a_group_of_everything_accounts_for_nothing():
    wide = cause("crosstalk", "gyro3", group=[("scale_factor_error", "gyro3"), ("latency", "gyro1")])
    assert scored(wide).exchangeable == (False,)


def test_a_group_that_holds_the_entry_accounts_for_it():
    out = scored(cause("crosstalk", "gyro3", group=[("scale_factor_error", "gyro3")]))
    assert out.exchangeable == (True,)


def test_one_cause_on_two_gyros_is_not_two_entries():
    out = scored(cause("bias_offset", "gyro1", "gyro2"))
    assert (out.must, out.strays) == ((False, False), (True,))


def test_once_is_one_cause_an_entry_and_no_other():
    truth = (CLEAR,)
    right = cause("bias_offset", "gyro1")
    assert scored(right, truth=truth).once
    assert not scored(right, cause("bias_step", "gyro1", runs=("a",)), truth=truth).once
    assert not scored(right, right, truth=truth).once  # the same thing named twice
    assert not scored(truth=truth).once


def test_the_culprit_beside_a_stale_record():
    culprit = effect(
        "acceleration_bias", "gyro2", snr=15.0, best=1.0, rivals=[("magnetic_bias", "gyro2", 1.0)]
    )
    truth = ({**CLEAR, "role": "stale"}, {**culprit, "role": "culprit"})
    assert scored(cause("acceleration_bias", "gyro2"), truth=truth).culprits == (True,)
    assert scored(cause("magnetic_bias", "gyro2"), truth=truth).culprits == (True,)
    assert scored(cause("bias_offset", "gyro1"), truth=truth).culprits == (False,)
    assert score_entries(label("stale_culprit", *truth), None, T).culprits == (False,)


def test_a_set_that_does_what_the_true_set_does_has_no_strays():
    # two entries of SNR 30 and 20 that share nothing, and a cause whose two columns are both of them
    table = {
        "places": [["bias_offset", ["gyro1"], ["*"], 1], ["bias_offset", ["gyro2"], ["*"], 1],
                   ["mount_rotation", ["table"], ["*"], 2], ["latency", ["gyro1"], ["*"], 1]],
        "gram": [[1300.0], [900.0, 900.0], [400.0, 0.0, 400.0],
                 [900.0, 900.0, 0.0, 900.0], [400.0, 0.0, 400.0, 0.0, 400.0], [0.0] * 5 + [1.0]],
    }  # fmt: skip
    truth = {**label("stale", CLEAR, SECOND), "linear": table}

    def strays(*causes):
        return score_entries(truth, diagnosis("explained", *causes), T).strays

    mount, late = cause("mount_rotation", "table"), cause("latency", "gyro1")
    assert strays(mount) == (False,)
    assert strays(mount, late) == (False, True)  # it does not take the second
    assert strays(mount, late, late) == (True, True, True)  # more causes than entries
    assert strays(late) == (True,)
    assert strays(cause("warm_up", "gyro1"), mount) == (True, True)  # not in the table, and stands for none


@pytest.mark.parametrize(
    ("value", "std", "within", "near"),
    [(0.63, 0.02, True, True), (0.61, 0.002, False, True), (0.63, 0.01, False, False)],
)
def test_parameters_within_two_deviations_or_two_per_cent(value, std, within, near):
    out = scored(cause("bias_offset", "gyro1", deg_h=(value, std)))
    assert (out.within, out.within_or_near) == ((within,), (near,))


def closing(name, channel, rank, **closure):
    from dataclasses import replace

    return replace(cause(name, channel), closure={"rank": rank, **closure})


def test_closures_of_single_effects_stand_beside_the_oracle_s():
    # two effects that share nothing: 0.7 and 0.3 of the gap
    gram = [[1.0, 0.7, 0.3], [0.7, 0.7, 0.0], [0.3, 0.0, 0.3]]
    truth = {**label("stale", CLEAR, SECOND), "closure_gram": gram}
    first = closing("bias_offset", "gyro1", 1, alone=0.72, removed=0.60, cumulative=0.70)
    second = closing("bias_offset", "gyro2", 2, alone=0.30, removed=0.30, cumulative=0.99)
    out = score_entries(truth, diagnosis("explained", first, second), T)
    assert out.closures == (True, False, True, True, True, True)
    # a running total behind a cause that is not there has no oracle
    stray = closing("bias_step", "gyro1", 1, alone=0.2, removed=0.1, cumulative=0.2)
    late = closing("bias_offset", "gyro2", 2, alone=0.30, removed=0.30, cumulative=0.5)
    assert score_entries(truth, diagnosis("explained", stray, late), T).closures == (True, True)


def rows_of(*outcomes):
    return {
        (table["title"], row["row"]): (row["k"], row["n"])
        for table in class_tables(list(outcomes), T)
        for row in table["rows"]
    }


def test_rows_of_stale_records():
    truth = {**label("stale", *TRUTH, oracle=0.99)}
    good = diagnosis("explained", *(cause("bias_offset", f"gyro{i}") for i in (1, 2)), closure=(0.98, 0.01))
    rows = rows_of(judge(truth, good, T), judge(truth, diagnosis("unexplained", closure=(0.0, 0.1)), T))
    title = "Stale records, 2 campaigns"
    assert rows[title, "verdict explained"] == (1, 2)
    assert rows[title, "entries that must be named, named"] == (2, 4)
    assert rows[title, "causes named that are in no true group"] == (0, 2)
    assert rows[title, "closure within 0.03 of the oracle's"] == (1, 2)


def test_explained_needs_a_closure_that_reaches():
    from dataclasses import replace

    low = replace(
        diagnosis("explained", cause("bias_offset", "gyro1"), closure=(0.89, 0.02)), closure_reaches=0.93
    )
    well = replace(low, closure_reaches=0.98)
    name = ("Closures, all classes", "explained, with a closure interval below 0.97")
    outcomes = [judge(label("single", CLEAR, oracle=0.99), said, T) for said in (low, well)]
    assert rows_of(*outcomes)[name] == (1, 2)


@pytest.mark.parametrize("kind", ["stale", "stale_culprit", "strong", "link_slow", "mixed", "slow_log"])
def test_who_reads_the_label_reaches_every_aim(kind):
    from dataclasses import replace

    truth = (
        (CLEAR,) if kind in ("strong", "mixed") else (CLEAR, SECOND, EXCHANGED, {**FAINT, "role": "culprit"})
    )
    said = [cause(e["effect"], *e["channels"], **{k: (v, 0.1 * v) for k, v in e["parameters"].items()})
            for e in truth]  # fmt: skip
    right = replace(diagnosis("explained", *said, closure=(0.99, 0.01)), closure_reaches=1.0)
    outcome = judge({**label(kind, *truth, oracle=0.99), "target_snr": 50.0}, right, T)
    for table in class_tables([outcome], T):
        for row in table["rows"]:
            aim = row.get("aim", "")
            assert row["k"] == (
                0 if aim.startswith(("at most", "never")) or "no true group" in row["row"] else row["n"]
            )
