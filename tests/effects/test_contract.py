"""Contract tests that run over the whole table of effects."""

from __future__ import annotations

import importlib
import math
from typing import Any

import numpy as np
import pytest
from simulated_runs import facts, profile, ramp_log

from fogreduce.effects.model import Effect, Stage
from fogreduce.effects.selection import Action, action, select
from fogreduce.effects.table import EFFECTS
from fogreduce.metadata.effects_file import EffectEntry
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.nominal_noise import NoiseCoefficients

PROFILE = profile((0.06, 70.0), (0.0, 30.0), (-10.0, 60.0))
NOISE = NoiseCoefficients([0.002] * 4, [0.03] * 4, [0.02] * 4)
#: Names and parameters as the effects contract has them, in its order.
CONTRACT = {
    "table_rate_error": ["ppm"],
    "table_rate_ripple": ["ppm", "harmonic", "phase_rad"],
    "heading_error": ["deg"],
    "latitude_error": ["deg"],
    "rotation_sense": [],
    "start_offset": ["s"],
    "mount_rotation": ["mrad"],
    "base_motion": ["deg_h", "frequency_hz", "axis", "phase_rad"],
    "bias_offset": ["deg_h"],
    "turn_on_bias": ["deg_h"],
    "bias_ramp": ["deg_h_per_h"],
    "bias_step": ["deg_h", "time_s"],
    "warm_up": ["deg_h", "tau_s"],
    "temperature_bias": ["deg_h_per_degC"],
    "temperature_rate_bias": ["deg_h_per_degC_per_min"],
    "temperature_scale_factor": ["ppm_per_degC"],
    "scale_factor_error": ["ppm"],
    "scale_factor_asymmetry": ["ppm"],
    "scale_factor_nonlinearity": ["ppm_at_10_deg_s"],
    "axis_misalignment": ["mrad"],
    "acceleration_bias": ["deg_h_per_g"],
    "magnetic_bias": ["deg_h", "field_direction"],
    "dead_zone": ["deg_h", "kind"],
    "angle_random_walk": ["deg_sqrt_h"],
    "bias_instability": ["deg_h"],
    "rate_random_walk": ["deg_h_sqrt_h"],
    "common_noise": ["correlation"],
    "periodic_interference": ["deg_h", "frequency_hz", "phase_rad"],
    "lost_bits": ["bits"],
    "adc_nonlinearity": ["volts", "period_volts"],
    "saturation": ["volts"],
    "crosstalk": ["ppm", "source"],
    "low_pass": ["time_constant_ms"],
    "clock_error": ["ppm"],
    "latency": ["ms"],
    "dropouts": ["fraction"],
    "spikes": ["fraction"],
    "stuck_samples": ["fraction"],
    "channel_swap": ["with"],
    "polarity_error": [],
}


def simulated(*actions: Action, run_id: str = "a", seed: int = 5) -> bytes:
    """Everything that a capture holds, as bytes; long enough for two blocks."""
    run = ForwardRun(
        facts(run_id=run_id, table={"axis": [1.0, 0.0, 0.0], "profile": PROFILE}),
        NOISE,
        actions,
        ramp_log(160.0),
        seed,
    )
    return b"".join(b.time_us.tobytes() + b.pulse.tobytes() + b.counts.tobytes() for b in run.blocks())


def columns(*actions: Action, **options: Any) -> np.ndarray:
    run = ForwardRun(
        facts(table={"axis": [1.0, 0.0, 0.0], "profile": PROFILE}),
        NOISE,
        actions,
        ramp_log(160.0),
        5,
        **options,
    )
    return np.concatenate([block.counts for block in run.blocks()], axis=1)


def channels(effect: Effect) -> list[str]:
    """Where the effect's example acts: gyro 2, and gyro 3 with it where it takes two."""
    if effect.channels != "gyro":
        return [effect.channels]
    return ["gyro2", "gyro3"][: effect.smallest_group]


def example(effect: Effect, runs: list[str] | None = None) -> Action:
    assert effect.example is not None
    return action(effect.name, channels(effect), runs or ["a"], effect.example, 4)


def test_names_and_parameters_are_the_contracts() -> None:
    assert {name: [p.name for p in effect.parameters] for name, effect in EFFECTS.items()} == CONTRACT
    assert len(CONTRACT) == 40


@pytest.mark.parametrize("name", EFFECTS)
def test_an_entry_says_all_that_people_need(name: str) -> None:
    effect = EFFECTS[name]
    assert effect.equation
    assert effect.source
    for parameter in effect.parameters:
        assert parameter.meaning
        if parameter.kind in ("number", "integer") and parameter.name != "phase_rad":
            assert parameter.realistic is not None
            low, high = parameter.realistic
            assert 0 <= low < high
            assert parameter.low <= low
            assert high <= parameter.high


@pytest.mark.parametrize("name", [name for name, effect in EFFECTS.items() if effect.off is not None])
def test_off_is_identity_to_the_bit(name: str) -> None:
    effect = EFFECTS[name]
    off = action(name, channels(effect), ["a"], effect.off or {}, 4)
    assert simulated(off) == simulated()


def test_what_has_no_off_value_is_off_by_absence_alone() -> None:
    without = {name for name, effect in EFFECTS.items() if effect.off is None}
    assert without == {"rotation_sense", "polarity_error", "channel_swap", "angle_random_walk"}


def test_angle_random_walk_of_the_records_own_size_is_identity() -> None:
    assert simulated(action("angle_random_walk", ["gyro2"], ["a"], {"deg_sqrt_h": 0.002}, 4)) == simulated()


@pytest.mark.parametrize("name", EFFECTS)
def test_same_seed_same_bytes_and_the_effect_is_there(name: str) -> None:
    one = simulated(example(EFFECTS[name]))
    assert one == simulated(example(EFFECTS[name]))
    assert one != simulated()
    assert one != simulated(example(EFFECTS[name]), seed=6)


@pytest.mark.parametrize("name", EFFECTS)
def test_another_run_keeps_its_bytes(name: str) -> None:
    elsewhere = example(EFFECTS[name], runs=["b"])
    assert simulated(elsewhere) == simulated()


@pytest.mark.parametrize("name", [name for name, effect in EFFECTS.items() if effect.channels == "gyro"])
def test_other_gyros_keep_their_bytes(name: str) -> None:
    effect = EFFECTS[name]
    touched = {int(channel[4:]) - 1 for channel in channels(effect)}
    if effect.mutual:
        touched.add(0)  # the example exchanges with gyro 1
    untouched = sorted(set(range(4)) - touched)
    assert np.array_equal(columns(example(effect))[untouched], columns()[untouched])


def test_adding_an_effect_changes_no_other_effects_stream() -> None:
    """Spikes on gyro 2 strike the same samples, whatever else is there."""
    spikes = EffectEntry(effect="spikes", channels=("gyro2",), parameters={"fraction": 0.01})
    others = [
        EffectEntry(effect="dropouts", channels=("gyro3",), parameters={"fraction": 0.5}),
        EffectEntry(effect="bias_instability", channels=("gyro2",), parameters={"deg_h": 0.5}),
    ]
    alone = columns(*select([spikes], ["a"], 4, "test"))[1]
    among = columns(*select([*others, spikes], ["a"], 4, "test"))[1]
    struck = np.abs(alone) > 2e7
    assert struck.any()
    assert np.array_equal(struck, np.abs(among) > 2e7)
    assert np.array_equal(alone[struck], among[struck])


def test_entries_of_one_effect_draw_apart() -> None:
    """Two flicker entries on one gyro are two processes, not one twice as large."""
    entry = EffectEntry(effect="bias_instability", channels=("gyro2",), parameters={"deg_h": 50.0})
    plain, one, two = (columns(*select([entry] * k, ["a"], 4, "test"))[1].astype(float) for k in range(3))
    first, second = one - plain, two - one
    assert not np.allclose(first, second, atol=2)


def test_gyros_of_one_run_and_runs_of_one_gyro_have_their_own_noise() -> None:
    still = facts(table={"axis": [1.0, 0.0, 0.0], "profile": profile((0.0, 100.0))})
    other = facts(run_id="b", table={"axis": [1.0, 0.0, 0.0], "profile": profile((0.0, 100.0))})
    rows = []
    for one in (still, other):
        (counts,) = [np.concatenate([b.counts for b in ForwardRun(one, NOISE, seed=1).blocks()], axis=1)]
        rows += list(counts)
    correlation = np.corrcoef(rows)[np.triu_indices(8, 1)]
    assert np.abs(correlation).max() < 5 / math.sqrt(12800)


def test_a_phase_that_is_not_given_is_drawn_for_each_run() -> None:
    parameters = {"deg_h": 50.0, "frequency_hz": 0.1}
    line = action("periodic_interference", ["gyro2"], ["a", "b"], parameters, 4)
    first, again, other = (
        ForwardRun(facts(run_id=run_id, table={"axis": "x", "profile": profile((0.0, 50.0))}), None, [line])
        for run_id in ("a", "a", "b")
    )
    lines = [np.concatenate([b.counts[1] for b in run.blocks()]) for run in (first, again, other)]
    assert np.array_equal(lines[0], lines[1])
    assert not np.array_equal(lines[0], lines[2])


def test_the_order_of_a_file_does_not_matter() -> None:
    """Effects act in the catalogue's order: a scale factor error and a nonlinearity do not commute."""
    entries = [
        EffectEntry(
            effect="scale_factor_nonlinearity", channels=("gyro2",), parameters={"ppm_at_10_deg_s": 5e4}
        ),
        EffectEntry(effect="scale_factor_error", channels=("gyro2",), parameters={"ppm": 5e4}),
    ]
    one, other = (columns(*select(order, ["a"], 4, "test")) for order in (entries, entries[::-1]))
    assert np.array_equal(one, other)


def test_effects_do_not_change_their_inputs() -> None:
    """Facts, logs and parameters are as they were after a run with every effect in it."""
    given, log = facts(), ramp_log()
    before = [array.copy() for array in (given.axes, given.bias, given.scale_factor, log.sensor_degC)]
    actions = [example(effect) for effect in EFFECTS.values()]
    for _ in ForwardRun(given, NOISE, actions, log).blocks():
        pass
    after = [given.axes, given.bias, given.scale_factor, log.sensor_degC]
    assert all(np.array_equal(x, y) for x, y in zip(before, after, strict=True))


@pytest.mark.parametrize("name", [name for name, effect in EFFECTS.items() if effect.stage != Stage.NOISE])
def test_blocks_join_without_a_seam(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """The capture does not depend on how it is cut into blocks (noise apart, whose blocks are fixed)."""
    run = facts(table={"axis": [1.0, 0.0, 0.0], "profile": profile((0.06, 10.0), (-10.0, 10.0))})
    drawn = "fraction" in CONTRACT[name]  # draws go by block: only whole blocks give the same

    def made() -> np.ndarray:
        blocks = ForwardRun(run, None, [example(EFFECTS[name])], ramp_log(20.0), 3).blocks()
        return np.concatenate([np.vstack((b.time_us, b.counts)) for b in blocks], axis=1)

    whole = made()
    monkeypatch.setattr(
        importlib.import_module("fogreduce.simulate.forward"), "BLOCK", 7 if not drawn else 512
    )
    cut = made()
    if name in ("spikes",):
        assert np.array_equal(whole[[0, 1, 3, 4]], cut[[0, 1, 3, 4]])
    else:
        assert np.array_equal(whole, cut)
