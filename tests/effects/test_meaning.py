"""What each effect's parameters mean, by arithmetic done by hand.

The unit: three gyros along x, y, z, C = 0.1 V/(deg/s), no bias, 1e-7 V a count. 1 deg/s is a million counts
and 3.6 deg/h is 1000. Earth's rate, 7.2921151467e-5 rad/s, is 4178.0746 counts (x 180 / pi x 1e6).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from simulated_runs import profile, ramp_log, run_data

from fogreduce.effects.selection import action
from fogreduce.effects.table import EFFECTS
from fogreduce.metadata.facts import RunFacts
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.nominal_noise import NoiseCoefficients

W = 4178.0746
IDENTITY = {
    "H": np.eye(3).tolist(),
    "scale_factor_V_per_deg_s": [0.1, 0.1, 0.1],
    "bias_V": [0.0, 0.0, 0.0],
}
RATE_HZ = 10.0
CHECKED: set[str] = set()


def capture(
    *effects: tuple[str, str, dict[str, Any]],
    rate: float = 10.0,
    latitude: float = 90.0,
    noise: NoiseCoefficients | None = None,
    seed: int = 0,
    seconds: float = 20.0,
    rate_hz: float = RATE_HZ,
    **changes: Any,
) -> tuple[np.ndarray, np.ndarray]:
    """Stamps [us] (N,) and counts (3, N) as floats; x up, z north (so y east), turning about x."""
    data = run_data(
        site={"latitude_deg": latitude},
        azimuth_deg=0.0,
        capture={"sample_rate_hz": rate_hz, "polarity": [1, 1, 1]},
        **{"table": {"axis": [1.0, 0.0, 0.0], "profile": profile((rate, seconds))}, **changes},
    )
    actions = [action(name, [channel], ["a"], parameters, 3) for name, channel, parameters in effects]
    CHECKED.update(name for name, _, _ in effects)
    run = ForwardRun(RunFacts.of(data, IDENTITY), noise, actions, ramp_log(seconds, per_s=0.1), seed)
    blocks = list(run.blocks())
    counts = np.concatenate([block.counts for block in blocks], axis=1)
    return np.concatenate([block.time_us for block in blocks]), counts.astype(float)


def counts(*effects: tuple[str, str, dict[str, Any]], **options: Any) -> np.ndarray:
    return capture(*effects, **options)[1]


def near(found: float, expected: float) -> None:
    """Equal but for the rounding of a count, and that of the constant W."""
    assert abs(found - expected) <= 0.51


def test_nothing() -> None:
    still = counts(rate=0.0)
    near(still[0, 0], W)
    assert np.all(counts()[1:] == 0)
    near(counts()[0, 57], 10e6 + W)


# ------------------------------------------------------------------------- table, site, mounting


def test_table_rate_error() -> None:
    near(counts(("table_rate_error", "table", {"ppm": 100.0}))[0, 7], 10e6 + W + 1000)


def test_table_rate_ripple() -> None:
    rippled = counts(("table_rate_ripple", "table", {"ppm": 100.0, "harmonic": 2, "phase_rad": 0.0}))[0]
    near(rippled[0], 10e6 + W + 1000)  # alpha = 0
    near(rippled[45], 10e6 + W)  # 45 deg: cos 90 deg
    near(rippled[90], 10e6 + W - 1000)  # 90 deg: cos 180 deg


def test_table_rate_ripple_moves_the_angle() -> None:
    """10 % at n = 1: alpha = 90 deg + 0.1 rad after 9 s; at the equator Earth's rate lies along z first."""
    rippled = counts(
        ("table_rate_ripple", "table", {"ppm": 1e5, "harmonic": 1, "phase_rad": 0.0}), latitude=0.0
    )
    near(rippled[1, 90], W * math.cos(0.1))
    near(rippled[2, 90], -W * math.sin(0.1))


def test_heading_error() -> None:
    """On the equator Earth's rate points north. Turned 30 deg clockwise, z lies 30 deg east of north."""
    turned = counts(("heading_error", "table", {"deg": 30.0}), rate=0.0, latitude=0.0)
    near(turned[2, 0], W * math.sqrt(3) / 2)
    near(turned[1, 0], -W / 2)


def test_latitude_error() -> None:
    moved = counts(("latitude_error", "table", {"deg": 30.0}), rate=0.0, latitude=0.0)
    near(moved[0, 0], W / 2)
    near(moved[2, 0], W * math.sqrt(3) / 2)


def test_rotation_sense() -> None:
    reversed_ = counts(("rotation_sense", "table", {}), latitude=0.0)
    near(reversed_[0, 3], -10e6)
    # After 9 s the unit has turned by -90 deg about x: north, along z at first, lies along -y.
    near(reversed_[1, 90], -W)


def test_start_offset() -> None:
    late = counts(("start_offset", "table", {"s": 2.0}))[0]
    near(late[19], W)
    near(late[20], 10e6 + W)
    near(late[199], 10e6 + W)
    early = counts(("start_offset", "table", {"s": -2.0}))[0]
    near(early[0], 10e6 + W)
    near(early[180], W)


def test_mount_rotation() -> None:
    """Theta = 1 mrad about y: theta x w = (0, 0, -1e-3 w_x)."""
    tilted = counts(("mount_rotation", "table", {"mrad": [0.0, 1.0, 0.0]}))
    near(tilted[2, 5], 1e-3 * (10e6 + W))
    near(tilted[1, 5], 0.0)


def test_base_motion() -> None:
    shaken = counts(
        (
            "base_motion",
            "table",
            {"deg_h": 3.6, "frequency_hz": 1.0, "axis": [0.0, 3.0, 4.0], "phase_rad": math.pi / 2},
        )
    )
    near(shaken[1, 0], 600)
    near(shaken[2, 0], 800)
    near(shaken[2, 5], -800)  # half a period later


# ------------------------------------------------------------------------------------------ gyro


@pytest.mark.parametrize("name", ["bias_offset", "turn_on_bias"])
def test_constant_bias(name: str) -> None:
    biased = counts((name, "gyro2", {"deg_h": 3.6}))
    assert np.all(biased[1] == 1000)
    near(biased[0, 3], 10e6 + W)


def test_bias_ramp() -> None:
    """3600 deg/h an hour after 10 s: 10 deg/h."""
    near(counts(("bias_ramp", "gyro2", {"deg_h_per_h": 3600.0}))[1, 100], 10 / 3.6 * 1000)


def test_bias_step() -> None:
    stepped = counts(("bias_step", "gyro2", {"deg_h": 3.6, "time_s": 5.0}))[1]
    assert stepped[49] == 0
    assert stepped[50] == stepped[-1] == 1000


def test_warm_up() -> None:
    cooling = counts(("warm_up", "gyro2", {"deg_h": 3.6, "tau_s": 10.0}))[1]
    assert cooling[0] == 1000
    near(cooling[100], 1000 / math.e)


def test_temperature_effects() -> None:
    """The log rises by 0.1 degC/s: 1 degC after 10 s, 6 degC/min."""
    near(counts(("temperature_bias", "gyro2", {"deg_h_per_degC": 3.6}))[1, 100], 1000)
    near(counts(("temperature_rate_bias", "gyro2", {"deg_h_per_degC_per_min": 3.6}))[1, 100], 6000)
    near(
        counts(("temperature_scale_factor", "gyro1", {"ppm_per_degC": 100.0}))[0, 100],
        (10e6 + W) * (1 + 100e-6),
    )


def test_temperature_holds_beyond_the_log() -> None:
    """The log ends at 20 s; the record goes on to 30 s."""
    facts = RunFacts.of(
        run_data(
            site={"latitude_deg": 90.0},
            table={"axis": [1.0, 0.0, 0.0], "profile": profile((0.0, 30.0))},
            capture={"sample_rate_hz": RATE_HZ, "polarity": [1, 1, 1]},
        ),
        IDENTITY,
    )
    warmed = action("temperature_bias", ["gyro2"], ["a"], {"deg_h_per_degC": 3.6}, 3)
    (block,) = ForwardRun(facts, None, [warmed], ramp_log(20.0, per_s=0.1)).blocks()
    assert block.counts[1, 199] == 1990
    assert np.all(block.counts[1, 200:] == 2000)


def test_scale_factor_effects() -> None:
    near(counts(("scale_factor_error", "gyro1", {"ppm": 100.0}))[0, 9], (10e6 + W) * (1 + 100e-6))
    near(counts(("scale_factor_asymmetry", "gyro1", {"ppm": 100.0}))[0, 9], (10e6 + W) * (1 + 100e-6))
    # The other sense: M = -10 deg/s + W; the asymmetry still adds.
    near(
        counts(("scale_factor_asymmetry", "gyro1", {"ppm": 100.0}), rate=-10.0)[0, 9],
        (-10e6 + W) * (1 - 100e-6),
    )
    m = 10e6 + W
    near(
        counts(("scale_factor_nonlinearity", "gyro1", {"ppm_at_10_deg_s": 100.0}))[0, 9],
        m + 1e-4 * m * (m / 10e6) ** 2,
    )


def test_axis_misalignment() -> None:
    """Gyro 2, along y, tips by 1 mrad to x; the 5 mrad along its own axis are removed."""
    near(counts(("axis_misalignment", "gyro2", {"mrad": [1.0, 5.0, 0.0]}))[1, 5], 1e-3 * (10e6 + W))


def test_acceleration_bias() -> None:
    pulled = counts(("acceleration_bias", "gyro1", {"deg_h_per_g": 3.6}), rate=0.0)
    near(pulled[0, 0], W + 1000)
    assert np.all(counts(("acceleration_bias", "gyro2", {"deg_h_per_g": 3.6}))[1] == 0)


def test_acceleration_bias_turns_with_a_level_axis() -> None:
    """About y, which points east: after 9 s x has turned from up to north, and z from north to down."""
    table = {"axis": [0.0, 1.0, 0.0], "profile": profile((10.0, 20.0))}
    plain = counts(table=table)
    pulled = counts(("acceleration_bias", "gyro3", {"deg_h_per_g": 3.6}), table=table) - plain
    assert abs(pulled[2, 0]) <= 1
    # R(y, -90 deg) takes x, which was up, to z.
    assert abs(pulled[2, 90] - 1000) <= 1


def test_magnetic_bias() -> None:
    """F 53.13 deg above north. After 9 s, turned by 90 deg about x, north has gone from z to y."""
    plain = counts()
    field = {"deg_h": 3.6, "field_direction": [0.0, 3.0, 4.0]}
    for gyro, start, later in (("gyro1", 800, 800), ("gyro2", 0, 600), ("gyro3", 600, 0)):
        row = int(gyro[4]) - 1
        change = (counts(("magnetic_bias", gyro, field)) - plain)[row]
        assert abs(change[0] - start) <= 1
        assert abs(change[90] - later) <= 1


def test_dead_zone() -> None:
    """Earth at the pole is 15.04 deg/h: inside 20, outside 10 deg/h (2777.78 counts)."""

    def still(width: float, kind: str, **options: Any) -> float:
        return counts(("dead_zone", "gyro1", {"deg_h": width, "kind": kind}), rate=0.0, **options)[0, 0]

    assert still(20.0, "threshold") == still(20.0, "subtractive") == 0
    near(still(10.0, "threshold"), W)
    near(still(10.0, "subtractive"), W - 2777.7778)
    near(still(10.0, "subtractive", latitude=-90.0), -W + 2777.7778)


def test_crosstalk() -> None:
    near(counts(("crosstalk", "gyro3", {"ppm": 100.0, "source": "gyro1"}))[2, 3], 1e-4 * (10e6 + W))


def test_crosstalk_takes_what_was_there_before_any_crosstalk() -> None:
    """1 -> 2 and 2 -> 3: what gyro 2 receives does not go on to gyro 3."""
    both = counts(
        ("crosstalk", "gyro2", {"ppm": 1e5, "source": "gyro1"}),
        ("crosstalk", "gyro3", {"ppm": 1e5, "source": "gyro2"}),
    )
    near(both[1, 3], 0.1 * (10e6 + W))
    assert both[2, 3] == 0


# ----------------------------------------------------------------------------------------- noise

LONG = {"rate": 0.0, "seconds": 4000.0, "rate_hz": 10.0}
QUIET = NoiseCoefficients([0.006] * 3, [0.0] * 3, [0.0] * 3)


def test_angle_random_walk_replaces_the_record() -> None:
    """0.06 deg/sqrt(h) at 10 Hz: 0.001 sqrt(10) deg/s = 3162.28 counts; 0.006 is a tenth of that."""
    noisy = counts(("angle_random_walk", "gyro2", {"deg_sqrt_h": 0.06}), noise=QUIET, **LONG)
    # 40 000 samples: a standard deviation is known to 1 / sqrt(2 N) = 0.35 %
    assert abs(noisy[1].std() / 3162.28 - 1) < 0.018
    assert abs(noisy[2].std() / 316.228 - 1) < 0.018
    assert abs(np.corrcoef(noisy[1, 1:], noisy[1, :-1])[0, 1]) < 0.025


def test_bias_instability_adds_flicker() -> None:
    """What it adds: an Allan deviation of sqrt(2 ln 2 / pi) 36 deg/h = 23.913 deg/h = 6642.5 counts, flat."""
    plain = counts(noise=QUIET, **LONG)[1]
    with_it = counts(("bias_instability", "gyro2", {"deg_h": 36.0}), noise=QUIET, **LONG)[1]
    added = with_it - plain
    for samples in (10, 40, 160):
        means = added[: len(added) // samples * samples].reshape(-1, samples).mean(axis=1)
        allan = math.sqrt(0.5 * np.mean(np.diff(means) ** 2))
        # K clusters: flicker's Allan variance is known to about 1 / sqrt(K); 4 standard deviations
        assert abs(allan / 6642.5 - 1) < 4 * 0.75 / math.sqrt(len(means))


def test_rate_random_walk_adds_a_walk() -> None:
    """36 deg/h/sqrt(h) at 10 Hz: steps of 36 / 60 sqrt(0.1) = 0.18974 deg/h = 52.705 counts, from 0."""
    plain = counts(noise=QUIET, **LONG)[1]
    with_it = counts(("rate_random_walk", "gyro2", {"deg_h_sqrt_h": 36.0}), noise=QUIET, **LONG)[1]
    added = with_it - plain
    assert abs(added[0]) <= 1
    steps = np.diff(added)
    assert abs(steps.std() / 52.705 - 1) < 0.018  # the two roundings add 0.4 counts in square: nothing
    assert abs(np.corrcoef(steps[1:], steps[:-1])[0, 1]) < 0.025


@pytest.mark.parametrize("correlation", [0.3, 0.9, -0.4])
def test_common_noise(correlation: float) -> None:
    shared = action("common_noise", ["gyro1", "gyro2", "gyro3"], ["a"], {"correlation": correlation}, 3)
    CHECKED.add("common_noise")
    facts = RunFacts.of(
        run_data(
            table={"axis": [1.0, 0.0, 0.0], "profile": profile((0.0, 4000.0))},
            capture={"sample_rate_hz": 10.0, "polarity": [1, 1, 1]},
        ),
        IDENTITY,
    )
    run = ForwardRun(facts, QUIET, [shared])
    noise = np.concatenate([block.counts for block in run.blocks()], axis=1).astype(float)
    found = np.corrcoef(noise)
    assert np.allclose(found[np.triu_indices(3, 1)], correlation, atol=0.025)  # 5 / sqrt(40 000)
    assert np.allclose(noise.std(axis=1), 316.228, rtol=0.018)


def test_periodic_interference() -> None:
    line = counts(
        ("periodic_interference", "gyro2", {"deg_h": 3.6, "frequency_hz": 1.0, "phase_rad": math.pi / 2})
    )[1]
    assert line[0] == 1000
    assert line[5] == -1000


# ----------------------------------------------------------------------------------- electronics


def test_lost_bits() -> None:
    """-1000 = ...11111110000011000 in two's complement; its lowest 4 bits gone: -1008."""
    assert (
        counts(("bias_offset", "gyro2", {"deg_h": -3.6}), ("lost_bits", "gyro2", {"bits": 4}))[1, 0] == -1008
    )
    assert counts(("bias_offset", "gyro2", {"deg_h": 3.6}), ("lost_bits", "gyro2", {"bits": 4}))[1, 0] == 992


def test_adc_nonlinearity() -> None:
    """v = 1000 counts = 1e-4 V is a twelfth of the period: sin 30 deg = 0.5."""
    bent = counts(
        ("bias_offset", "gyro2", {"deg_h": 3.6}),
        ("adc_nonlinearity", "gyro2", {"volts": 2e-5, "period_volts": 12e-4}),
    )
    assert bent[1, 0] == 1100


def test_saturation() -> None:
    clipped = counts(("saturation", "gyro1", {"volts": 0.5}))
    assert np.all(clipped[0] == 5_000_000)
    assert np.all(counts(("saturation", "gyro1", {"volts": 0.5}), rate=-10.0)[0] == -5_000_000)


def test_low_pass() -> None:
    """A ramp of 1000 counts a second lags by tau once settled; at first by tau (1 - exp(-t / tau))."""
    ramp = ("bias_ramp", "gyro2", {"deg_h_per_h": 3.6 * 3600})
    lagging = counts(ramp, ("low_pass", "gyro2", {"time_constant_ms": 2000.0}))[1]
    assert lagging[0] == 0
    near(lagging[20], 1000 * (2 - 2 * (1 - 1 / math.e)))
    near(lagging[199], 1000 * (19.9 - 2 * (1 - math.exp(-9.95))))


# ---------------------------------------------------------------------------- clock, link, wiring


def test_clock_error() -> None:
    """A clock that is 1 % slow: 10.1 s are stamped 10 s. Counts are untouched."""
    stamps, slow = capture(("clock_error", "clock", {"ppm": 1e4}))
    assert stamps[101] == 10_000_000
    assert np.array_equal(slow, counts())


def test_latency() -> None:
    stepped = counts(
        ("bias_step", "gyro2", {"deg_h": 3.6, "time_s": 5.0}), ("latency", "gyro2", {"ms": 700.0})
    )
    assert stepped[1, 56] == 0
    assert stepped[1, 57] == 1000


def share(found: np.ndarray, fraction: float) -> None:
    """A share of independent events lies within 5 of its standard deviations."""
    assert abs(found.mean() - fraction) < 5 * math.sqrt(fraction * (1 - fraction) / found.size)


def test_dropouts() -> None:
    lost = counts(("dropouts", "gyro2", {"fraction": 0.03}), **LONG)
    share(lost[1] == -(2**31), 0.03)
    assert np.all(lost[[0, 2]] > -(2**31))
    missing = (lost[1] == -(2**31)).astype(float)
    share(missing[1:] * missing[:-1], 0.03**2)  # independent


def test_spikes() -> None:
    struck = counts(("spikes", "gyro2", {"fraction": 0.03}), **LONG)[1]
    struck_by = struck[struck != 0]
    share(struck != 0, 0.03)
    assert np.abs(struck_by).max() <= 2**30
    # uniform over +-2^30: standard deviation 2^30 / sqrt(3); of its estimate from 1200: 1.3 %
    assert abs(struck_by.std() / (2**30 / math.sqrt(3)) - 1) < 0.065
    assert abs(struck_by.mean()) < 5 * 2**30 / math.sqrt(3 * len(struck_by))


def test_stuck_samples() -> None:
    """On a ramp of 100 counts a sample nothing repeats by itself."""
    ramp = ("bias_ramp", "gyro2", {"deg_h_per_h": 3.6 * 3600})
    repeated = counts(ramp, ("stuck_samples", "gyro2", {"fraction": 0.3}), **LONG)[1]
    stuck = np.diff(repeated) == 0
    share(stuck, 0.3)
    fresh = np.flatnonzero(~stuck) + 1
    assert np.allclose(repeated[fresh], 100 * fresh, atol=0.51)  # what is not stuck is true


def test_channel_swap() -> None:
    swapped = counts(("channel_swap", "gyro1", {"with": "gyro3"}), latitude=0.0)
    plain = counts(latitude=0.0)
    assert np.array_equal(swapped, plain[[2, 1, 0]])


def test_polarity_error() -> None:
    wrong = counts(("dropouts", "gyro1", {"fraction": 0.1}), ("polarity_error", "gyro1", {}))
    assert set(np.unique(wrong[0])) == {-(2.0**31), -round(10e6 + W)}


def test_every_effect_was_checked_by_hand() -> None:
    """Runs last in this file; meaningless on a selection of tests."""
    if len(CHECKED) < len(EFFECTS) // 2:
        pytest.skip("a selection of this file's tests was run")
    assert set(EFFECTS) == CHECKED
