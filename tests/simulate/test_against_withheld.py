"""Each effect against the withheld bench's injector, written by somebody else from the same contract.

No noise, nothing drawn: the two chains have to agree to the last count. Where they differ it is by one, where
a value lies within the rounding errors of double precision of half a count.
"""

from __future__ import annotations

import numpy as np
import pytest

withheld = pytest.importorskip("withheld.chain.injector", reason="the withheld bench is not installed")

from simulated_runs import BIAS, SCALE, H, facts, profile, ramp_log  # noqa: E402

from fogreduce.effects.selection import action  # noqa: E402
from fogreduce.effects.table import EFFECTS  # noqa: E402
from fogreduce.simulate.forward import ForwardRun  # noqa: E402
from withheld.chain.campaign import Campaign, Run, Unit  # noqa: E402
from withheld.effects.entry import Entry  # noqa: E402

ZERO = (0.0,) * 4
RATES = ((10.0, 20.0), (-0.06, 20.0), (0.0, 10.0), (-10.0, 10.0))
SECONDS = 60.0
RUN = dict(
    azimuth_deg=30.0,
    frame_signs=[1, 1, -1],
    table={"axis": [0.0, 0.6, 0.8], "profile": profile(*RATES)},
    orientation={"y": "up", "x": "east"},
)


def mine(entries: list[dict]) -> tuple[np.ndarray, np.ndarray]:
    """Stamps and counts (n, N) of the simulator."""
    actions = [action(e["effect"], e["channels"], ["a"], e["parameters"], 4) for e in entries]
    run = ForwardRun(facts(**RUN), actions=actions, temperature=ramp_log(SECONDS, start=25.0))
    blocks = list(run.blocks())
    return np.concatenate([b.time_us for b in blocks]), np.concatenate([b.counts for b in blocks], axis=1)


def theirs(entries: list[dict]) -> tuple[np.ndarray, np.ndarray]:
    """The same of the withheld injector in its exact world."""
    unit = Unit(
        "TETRA-01", "2012a", tuple(map(tuple, H)), tuple(SCALE), tuple(BIAS),
        ZERO, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO,
    )  # fmt: skip
    run = Run(
        "a", "2014-05-12T13:00:00Z", -23.21132308, (0.0, 0.6, 0.8), RATES,
        (("y", "up"), ("x", "east")), 30.0, (1, -1, 1, 1), (1, 1, -1),
    )  # fmt: skip
    told = tuple(Entry(e["effect"], tuple(e["channels"]), ("a",), e["parameters"]) for e in entries)
    world = withheld.exact_world(Campaign("c", unit, (run,)), told)
    stamps, counts = withheld.run_counts(world, run)
    return stamps.astype(np.int64), counts.T


def entry(name: str, **parameters: object) -> dict:
    effect = EFFECTS[name]
    channels = ["gyro2"] if effect.channels == "gyro" else [effect.channels]
    return {"effect": name, "channels": channels, "parameters": parameters}


ENTRIES = {
    "nothing": [],
    "table_rate_error": [entry("table_rate_error", ppm=-35.0)],
    "table_rate_ripple": [entry("table_rate_ripple", ppm=120.0, harmonic=3, phase_rad=0.7)],
    "heading_error": [entry("heading_error", deg=1.3)],
    "latitude_error": [entry("latitude_error", deg=-0.4)],
    "rotation_sense": [entry("rotation_sense")],
    "start_offset": [entry("start_offset", s=1.237)],
    "mount_rotation": [entry("mount_rotation", mrad=[0.7, -0.4, 1.1])],
    "base_motion": [entry("base_motion", deg_h=40.0, frequency_hz=7.3, axis=[0.0, 3.0, 4.0], phase_rad=0.4)],
    "bias_offset": [entry("bias_offset", deg_h=1.7)],
    "turn_on_bias": [entry("turn_on_bias", deg_h=-2.7)],
    "bias_ramp": [entry("bias_ramp", deg_h_per_h=30.0)],
    "bias_step": [entry("bias_step", deg_h=3.0, time_s=17.0)],
    "warm_up": [entry("warm_up", deg_h=5.0, tau_s=25.0)],
    "temperature_bias": [entry("temperature_bias", deg_h_per_degC=3.0)],
    "temperature_rate_bias": [entry("temperature_rate_bias", deg_h_per_degC_per_min=3.0)],
    "temperature_scale_factor": [entry("temperature_scale_factor", ppm_per_degC=80.0)],
    "scale_factor_error": [entry("scale_factor_error", ppm=90.0)],
    "scale_factor_asymmetry": [entry("scale_factor_asymmetry", ppm=90.0)],
    "scale_factor_nonlinearity": [entry("scale_factor_nonlinearity", ppm_at_10_deg_s=200.0)],
    "axis_misalignment": [entry("axis_misalignment", mrad=[0.5, 0.2, -0.9])],
    "acceleration_bias": [entry("acceleration_bias", deg_h_per_g=4.0)],
    "magnetic_bias": [entry("magnetic_bias", deg_h=4.0, field_direction=[0.1, 0.8, -0.6])],
    "dead_zone, threshold": [entry("dead_zone", deg_h=100.0, kind="threshold")],
    "dead_zone, subtractive": [entry("dead_zone", deg_h=100.0, kind="subtractive")],
    "periodic_interference": [entry("periodic_interference", deg_h=9.0, frequency_hz=11.1, phase_rad=1.0)],
    "lost_bits": [entry("lost_bits", bits=5)],
    "adc_nonlinearity": [entry("adc_nonlinearity", volts=1e-4, period_volts=0.03)],
    "saturation": [entry("saturation", volts=0.3)],
    "crosstalk": [entry("crosstalk", ppm=400.0, source="gyro1")],
    "low_pass": [entry("low_pass", time_constant_ms=90.0)],
    "low_pass, below a sample": [entry("low_pass", time_constant_ms=5.0)],
    "clock_error": [entry("clock_error", ppm=70.0)],
    "latency": [entry("latency", ms=333.0)],
    "channel_swap": [entry("channel_swap", **{"with": "gyro3"})],
    "polarity_error": [entry("polarity_error")],
    "several at once": [
        entry("mount_rotation", mrad=[0.7, -0.4, 1.1]),
        entry("bias_ramp", deg_h_per_h=30.0),
        entry("scale_factor_error", ppm=90.0),
        entry("scale_factor_nonlinearity", ppm_at_10_deg_s=200.0),
        entry("crosstalk", ppm=400.0, source="gyro1"),
        entry("low_pass", time_constant_ms=90.0),
        entry("lost_bits", bits=5),
        entry("polarity_error"),
        entry("clock_error", ppm=70.0),
    ],
}
#: What is random: the bench's draws are its own; tests/effects/test_meaning.py looks at the statistics.
RANDOM = {
    "angle_random_walk", "bias_instability", "rate_random_walk", "common_noise",
    "stuck_samples", "spikes", "dropouts",
}  # fmt: skip


def test_every_deterministic_effect_is_compared() -> None:
    compared = {e["effect"] for entries in ENTRIES.values() for e in entries}
    assert compared == set(EFFECTS) - RANDOM


@pytest.mark.parametrize("name", ENTRIES)
def test_counts_agree_within_rounding(name: str) -> None:
    stamps, counts = mine(ENTRIES[name])
    their_stamps, their_counts = theirs(ENTRIES[name])
    assert counts.shape == their_counts.shape
    assert np.array_equal(stamps, their_stamps)
    step = 32 if name == "lost_bits" or name == "several at once" else 1  # a carry moves a whole 2^5
    difference = np.abs(counts - their_counts)
    assert difference.max() <= step
    assert (difference > 0).mean() < 1e-3


@pytest.mark.parametrize("name", sorted(set(ENTRIES) - {"nothing", "clock_error"}))
def test_the_comparison_would_see_the_effect(name: str) -> None:
    _, counts = mine(ENTRIES[name])
    _, nothing = mine([])
    assert (counts != nothing).mean() > 0.01
