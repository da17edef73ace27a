"""Classes of campaigns: what they hold, and one command that runs one of them."""

import sys
from collections import Counter

import numpy as np
import pytest

from withheld.atomic import read_json
from withheld.cli import main
from withheld.effects.catalogue import NAMES
from withheld.errors import BadInput
from withheld.examine import KINDS, only
from withheld.streams import stream
from withheld.study.cases import draw_case, plans
from withheld.study.classes import CLASSES
from withheld.study.classes.stale import FEWEST, MOST, stale_entries
from withheld.study.classes.strong import LEVELS
from withheld.study.designs import SHORT_AND_LONG, any_campaign


def test_every_cell_comes_once_before_any_comes_twice():
    cells = CLASSES["strong"].spread(150, np.random.default_rng(1))
    assert len(set(cells[:120])) == 120 == len(NAMES) * len(LEVELS)
    assert max(Counter(cells).values()) == 2


@pytest.mark.parametrize("seed", range(30))
def test_stale_records_hold_some_entries_of_unequal_sizes(seed):
    rng = np.random.default_rng(seed)
    _, campaign = any_campaign("c", rng, 0.75)
    entries = stale_entries(campaign, rng, 0.04)
    assert FEWEST <= len(entries) <= MOST
    assert len({(e.effect, e.channels) for e in entries}) == len(entries)
    offsets = [abs(e.number("deg_h")) for e in entries if e.effect == "bias_offset"]
    assert len(set(offsets)) == len(offsets)
    for e in entries:
        if e.effect == "axis_misalignment":
            # all of it shows: nothing lies along the gyro's own axis (but the rounding of six digits)
            assert campaign.unit.axes[e.gyros()[0]] @ np.array(e.parameters["mrad"]) == pytest.approx(
                0.0, abs=2e-5
            )


def test_sizes_of_ageing_are_those_of_the_class_of_units():
    sizes = []
    for seed in range(60):
        rng = stream(seed, "sizes")
        _, campaign = any_campaign("c", rng, 0.75, {"eight": 1.0})
        sizes += [
            abs(e.number("deg_h")) for e in stale_entries(campaign, rng, 0.04) if e.effect == "bias_offset"
        ]
    # lognormal about 0.6 deg/h with 0.6: nine in ten between 0.22 and 1.6
    low, high = np.percentile(sizes, [5, 95])
    assert 0.15 < low < 0.32
    assert 1.1 < high < 2.3


def test_a_culprit_stands_beside_a_stale_record():
    plan = plans(only("stale_culprit", 3, 1))[0]
    drawn = draw_case(only("stale_culprit", 3, 1), plan)
    assert drawn.roles.count("culprit") == 1
    assert drawn.world.entries[-1].effect == plan.effects[0]
    assert len(drawn.roles) == len(drawn.world.entries) >= FEWEST + 1


def test_strong_effects_meet_their_target_and_half_keep_the_catalogue_s_shape():
    from withheld.study.cases import label

    protocol = only("strong", 5, 120)
    chosen = [p for p in plans(protocol) if p.effects[0] == "bias_ramp" and p.snr == 200.0]
    for plan in chosen:
        drawn = draw_case(protocol, plan)
        assert label(protocol, plan, drawn)["effects"][0]["snr"] == pytest.approx(200.0, rel=0.03)
    shapes = Counter(
        bool(draw_case(only("strong", seed, 120), chosen[0]).world.entries[0].departure) for seed in range(5)
    )
    assert shapes[True] > 0
    assert shapes[False] > 0


def first(kind, seed=3, campaigns=1, **has):
    protocol = only(kind, seed, campaigns)
    plan = next(p for p in plans(protocol) if set(has.get("effects", ())) <= set(p.effects))
    return protocol, plan, draw_case(protocol, plan)


def test_a_poor_link_and_a_slow_fault():
    _, plan, drawn = first("link_slow", campaigns=154, effects=("dropouts", "spikes", "bias_ramp"))
    assert plan.effects == ("dropouts", "spikes", "bias_ramp")
    assert drawn.roles == ("link", "link", "slow")
    assert all(1e-5 <= e.number("fraction") <= 2e-2 for e in drawn.world.entries[:-1])


def test_lines_and_a_slow_fault():
    _, plan, drawn = first("link_slow", campaigns=154, effects=("base_motion", "bias_offset"))
    assert drawn.roles == ("full rate", "slow")
    assert [e.effect for e in drawn.world.entries] == list(plan.effects)


def test_mixed_runs_have_rates_and_lengths_of_their_own():
    seen = [first("mixed_quiet", seed)[2].world for seed in range(6)]
    assert all(world.entries == () for world in seen)
    rates = [len({run.sample_rate_hz for run in world.campaign.runs}) for world in seen]
    lengths = [len({run.duration_s for run in world.campaign.runs}) for world in seen]
    assert max(rates) >= 3
    assert min(lengths) >= 2
    noise = np.concatenate([world.campaign.unit.arw_deg_sqrt_h for world in seen])
    assert noise.max() / noise.min() > 5.0


def test_a_step_in_one_of_several_lengths_falls_into_its_run():
    from withheld.study.classes.mixed import mixed
    from withheld.study.draws import draw_entry

    for seed in range(20):
        rng = np.random.default_rng(seed)
        campaign = mixed(any_campaign("c", rng, 1.0)[1], rng)
        step = draw_entry("bias_step", campaign, rng, 0.0)
        length = next(run.duration_s for run in campaign.runs if run.run_id in step.runs)
        assert 0.1 * length < step.number("time_s") < 0.9 * length


def test_slow_logs_are_slow_coarse_and_creep():
    from withheld.study.cases import label

    protocol, plan, drawn = first("slow_log", campaigns=9, effects=("bias_ramp",))
    for run in drawn.world.campaign.runs:
        assert run.sample_rate_hz < 2.0
        assert 450 <= run.samples <= 2600
        assert max(abs(rate) for rate, _ in run.profile) <= 0.02
    spread = [np.ptp(heat.sensor_degC) for heat in drawn.world.heat.values()]
    assert max(spread) < 8.0  # a room, however long the log
    known = label(protocol, plan, drawn)["effects"]
    assert [e["role"] for e in known] == ["link", "link", "slow"]
    assert 9.0 < known[-1]["snr"] < 42.0


@pytest.mark.slow
def test_a_shape_near_the_catalogue_keeps_its_distance_from_it():
    from withheld.study.cases import label

    protocol, plan, drawn = first("near", campaigns=6, effects=("fifth_power",))
    known = label(protocol, plan, drawn)["effects"][0]
    # 15 where the law's bounds allow it, and never less than half of that
    assert 7.5 < known["best_rival"] < 15.5
    assert known["nearest"]["effect"] in NAMES


def test_a_single_run_of_100_minutes_has_one_effect_at_its_target():
    from withheld.study.cases import label

    protocol, plan, drawn = first("long_run", campaigns=len(CLASSES["long_run"].cells), effects=("warm_up",))
    assert [run.duration_s for run in drawn.world.campaign.runs] == [6000.0]
    # hours for what takes minutes in a run of 300 s
    assert 400.0 <= drawn.world.entries[0].number("tau_s") <= 4000.0
    known = label(protocol, plan, drawn)["effects"]
    assert [e["role"] for e in known] == ["culprit"]
    assert known[0]["snr"] == pytest.approx(plan.snr, rel=0.03)


def test_strong_effects_come_in_short_and_long_runs_too():
    rng = np.random.default_rng(2)
    short, long = (any_campaign("c", rng, 1.0, {design: 1.0})[1] for design in SHORT_AND_LONG)
    assert [run.duration_s for run in short.runs] == [120.0, 120.0]
    assert [run.duration_s for run in long.runs] == [6000.0]
    assert all(rate == 0.0 for run in short.runs for rate, _ in run.profile)


def test_no_class_has_an_effect_taken_out():
    assert not any(plan.without for plan in plans(only("stale", 1, 60)))


def test_kinds_by_name():
    assert only("pair", 1, 7).cases == 7
    assert only("nothing", 1, 3).cases == 3
    with pytest.raises(BadInput, match="kind muddle: expected one of nothing, "):
        only("muddle", 1, 3)
    assert set(CLASSES) < set(KINDS)


def test_examine_makes_diagnoses_scores_and_goes_on_where_it_was(tmp_path, capsys):
    diagnoser = f"{sys.executable} -m withheld candidate no_gap --batch {{batch}} --out {{out}}"
    call = ["examine", "strong", "--seed", "4", "--campaigns", "1", "--out", str(tmp_path / "out")]
    call += ["--diagnoser", diagnoser]
    assert main(call) == 0
    assert "| named once (or one of its true group), and explained | 0 of 1" in capsys.readouterr().out
    assert not (tmp_path / "out" / "batches").exists() or not list((tmp_path / "out" / "batches").iterdir())
    stamp = (tmp_path / "out" / "labels" / "batch-000.json").stat().st_mtime_ns
    assert main(call) == 0
    assert (tmp_path / "out" / "labels" / "batch-000.json").stat().st_mtime_ns == stamp
    assert read_json(tmp_path / "out" / "scores.json")["cases"] == 1
    assert main([*call[:2], "--seed", "1000000", *call[4:]]) == 2
