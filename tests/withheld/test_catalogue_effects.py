"""Every effect of the catalogue in its exact shape, each against arithmetic written here by hand."""

import numpy as np
import pytest
from bench import COUNTS_PER_DEG_H, SCALE, campaign, change, on, run, unit

from withheld.chain.campaign import Campaign
from withheld.chain.capture_file import encode
from withheld.chain.injector import exact_world, realistic_world, run_counts
from withheld.chain.link import MISSING, stamps_us
from withheld.effects.catalogue import NAMES, PARAMETERS, WITH_PHASE
from withheld.effects.entry import Entry

FAST = run(rate=9.0)
EARTH = np.rad2deg(7.2921151467e-5)
TOLERANCE = 1.001  # two roundings


def difference(entry, of=None, number=0):
    t, before, after = change(of or campaign(FAST), entry, number=number)
    return t, (after - before).astype(float), before.astype(float)


def rate_counts(deg_s):
    return np.asarray(deg_s) * SCALE / 1e-7


def table(effect, **parameters):
    return Entry(effect, ("table",), ("*",), parameters)


def close(got, expected):
    assert np.abs(np.asarray(got) - expected).max() <= TOLERANCE


# --- table, site, mounting ---------------------------------------------------------------------------------


def test_table_rate_error():
    t, d, _ = difference(table("table_rate_error", ppm=100.0))
    close(d[:, 0], rate_counts(9.0 * 1e-4))
    angle = np.deg2rad(9.0 * t)
    close(d[:, 2], rate_counts(EARTH * (np.cos(angle * (1 + 1e-4)) - np.cos(angle))))


def test_table_rate_ripple():
    t, d, _ = difference(table("table_rate_ripple", ppm=500.0, harmonic=3, phase_rad=0.4))
    close(d[:, 0], rate_counts(9.0 * 500e-6 * np.cos(3 * np.deg2rad(9.0 * t) + 0.4)))
    # the angle is the integral of the rate, here summed by the trapezoidal rule on a fine grid
    fine = np.linspace(0, 20, 400001)
    swing = 500e-6 * np.cos(3 * np.deg2rad(9.0 * fine) + 0.4)
    angle = np.deg2rad(9.0 * np.concatenate([[0], np.cumsum((1 + (swing[1:] + swing[:-1]) / 2) * fine[1])]))
    turned = np.interp(t, fine, angle)
    close(d[:, 2], rate_counts(EARTH * (np.cos(turned) - np.cos(np.deg2rad(9.0 * t)))))


def test_heading_error():
    # z points north; turned clockwise by 2 deg it points east of north, and y (east) south of east
    _, d, _ = difference(table("heading_error", deg=2.0), campaign(run()))
    close(d[:, 2], rate_counts(EARTH * (np.cos(np.deg2rad(2.0)) - 1.0)))
    close(d[:, 1], rate_counts(-EARTH * np.sin(np.deg2rad(2.0))))


def test_latitude_error():
    _, d, _ = difference(table("latitude_error", deg=3.0), campaign(run(latitude_deg=40.0)))
    close(d[:, 0], rate_counts(EARTH * (np.sin(np.deg2rad(43.0)) - np.sin(np.deg2rad(40.0)))))
    close(d[:, 2], rate_counts(EARTH * (np.cos(np.deg2rad(43.0)) - np.cos(np.deg2rad(40.0)))))


def test_rotation_sense():
    t, d, _ = difference(table("rotation_sense"))
    close(d[:, 0], rate_counts(-18.0))
    close(d[:, 1], rate_counts(-2 * EARTH * np.sin(np.deg2rad(9.0 * t))))


def test_start_offset():
    t, d, before = difference(table("start_offset", s=2.0))
    late = t < 2.0
    close(d[late, 0], -before[0, 0])
    close(d[~late, 0], 0.0)
    close((d + before)[late, 2], rate_counts(EARTH))
    close((d + before)[~late, 2], rate_counts(EARTH * np.cos(np.deg2rad(9.0 * (t[~late] - 2.0)))))


def test_mount_rotation():
    t, d, _ = difference(table("mount_rotation", mrad=[0.0, 2.0, 0.0]))
    # theta x w for theta along y: (theta w_z, 0, -theta w_x)
    close(d[:, 0], rate_counts(-2e-3 * EARTH * np.cos(np.deg2rad(9.0 * t))))
    close(d[:, 2], rate_counts(2e-3 * 9.0))


def test_base_motion_at_a_true_frequency_above_half_the_sample_rate():
    entry = table("base_motion", deg_h=5.0, frequency_hz=70.0, axis=[0.0, 0.0, 2.0], phase_rad=0.3)
    t, d, _ = difference(entry)
    close(d[:, 2], 5.0 * COUNTS_PER_DEG_H * np.sin(2 * np.pi * 70.0 * t + 0.3))
    close(d[:, 0], 0.0)


# --- gyro --------------------------------------------------------------------------------------------------


def test_bias_offset():
    close(difference(on("bias_offset", deg_h=3.0))[1][:, 0], 3.0 * COUNTS_PER_DEG_H)


def test_turn_on_bias_in_one_run_only():
    of = campaign(run("a"), run("b"))
    entry = Entry("turn_on_bias", ("gyro2",), ("b",), {"deg_h": -2.0})
    close(difference(entry, of, 0)[1], 0.0)
    close(difference(entry, of, 1)[1][:, 1], -2.0 * COUNTS_PER_DEG_H)


def test_bias_ramp():
    t, d, _ = difference(on("bias_ramp", deg_h_per_h=100.0))
    close(d[:, 0], 100.0 * t / 3600.0 * COUNTS_PER_DEG_H)


def test_bias_step():
    t, d, _ = difference(Entry("bias_step", ("gyro1",), ("r1",), {"deg_h": 4.0, "time_s": 7.5}))
    close(d[:, 0], np.where(t >= 7.5, 4.0, 0.0) * COUNTS_PER_DEG_H)


def test_warm_up():
    t, d, _ = difference(on("warm_up", deg_h=6.0, tau_s=5.0))
    close(d[:, 0], 6.0 * np.exp(-t / 5.0) * COUNTS_PER_DEG_H)


def test_temperature_effects_on_a_ramp_of_a_hundredth_of_a_degree_a_second():
    t, d, before = difference(on("temperature_bias", deg_h_per_degC=20.0))
    close(d[:, 0], 20.0 * 0.01 * t * COUNTS_PER_DEG_H)
    _, d, _ = difference(on("temperature_rate_bias", deg_h_per_degC_per_min=5.0))
    close(d[:, 0], 5.0 * 0.6 * COUNTS_PER_DEG_H)
    _, d, _ = difference(on("temperature_scale_factor", ppm_per_degC=300.0))
    close(d[:, 0], before[:, 0] * 300e-6 * 0.01 * t)


def test_scale_factor_effects():
    negative = campaign(run(rate=-9.0))
    _, d, before = difference(on("scale_factor_error", ppm=200.0), negative)
    close(d[:, 0], 200e-6 * before[:, 0])
    _, d, before = difference(on("scale_factor_asymmetry", ppm=200.0), negative)
    close(d[:, 0], 200e-6 * np.abs(before[:, 0]))
    assert d[0, 0] > 0
    _, d, before = difference(on("scale_factor_nonlinearity", ppm_at_10_deg_s=200.0), negative)
    close(d[:, 0], 200e-6 * 0.81 * before[:, 0])


def test_axis_misalignment_without_its_part_along_the_axis():
    _, d, _ = difference(on("axis_misalignment", "gyro2", mrad=[1.0, 5.0, 0.0]))
    close(d[:, 1], rate_counts(9.0 * 1e-3))


def test_acceleration_bias():
    close(difference(on("acceleration_bias", deg_h_per_g=2.0))[1][:, 0], 2.0 * COUNTS_PER_DEG_H)
    close(difference(on("acceleration_bias", "gyro2", deg_h_per_g=2.0))[1], 0.0)


def test_magnetic_bias_of_a_field_to_the_north():
    t, d, _ = difference(on("magnetic_bias", "gyro3", deg_h=2.0, field_direction=[0.0, 1.0, 0.0]))
    close(d[:, 2], 2.0 * np.cos(np.deg2rad(9.0 * t)) * COUNTS_PER_DEG_H)


@pytest.mark.parametrize("kind", ["threshold", "subtractive"])
def test_dead_zone(kind):
    _, d, before = difference(on("dead_zone", "gyro3", deg_h=8.0, kind=kind))
    m = before[:, 2] / COUNTS_PER_DEG_H
    outside = m if kind == "threshold" else m - 8.0 * np.sign(m)
    clear = np.abs(np.abs(m) - 8.0) > 0.01
    close((d + before)[clear, 2], (np.where(np.abs(m) < 8.0, 0.0, outside) * COUNTS_PER_DEG_H)[clear])


# --- noise -------------------------------------------------------------------------------------------------


def test_periodic_interference_and_its_phase_drawn_per_run():
    entry = on("periodic_interference", deg_h=5.0, frequency_hz=11.0, phase_rad=1.0)
    t, d, _ = difference(entry)
    close(d[:, 0], 5.0 * np.sin(2 * np.pi * 11.0 * t + 1.0) * COUNTS_PER_DEG_H)
    free = on("periodic_interference", deg_h=5.0, frequency_hz=11.0)
    assert free.phase_rad("a") != free.phase_rad("b")
    assert 0.0 <= free.phase_rad("a") < 2 * np.pi


NOISY = campaign(run(duration=400.0), instability_deg_h=(0.0,) * 3, turn_on_deg_h=(0.0,) * 3)


def noise_counts(*entries):
    world = realistic_world(NOISY, entries, 3, noise_level_rel=0.0)
    _, counts = run_counts(world, NOISY.runs[0])
    return counts - counts.mean(axis=0)


def test_angle_random_walk_replaces_the_level():
    white = 0.005 / 60 * np.sqrt(64.0) * SCALE / 1e-7
    spread = noise_counts(on("angle_random_walk", deg_sqrt_h=0.005)).std(axis=0)
    assert spread == pytest.approx([white, 0.4 * white, 0.4 * white], rel=0.02)


def test_common_noise_correlates_and_keeps_the_level():
    entry = Entry("common_noise", ("gyro1", "gyro3"), ("*",), {"correlation": 0.5})
    counts = noise_counts(entry)
    found = np.corrcoef(counts.T)
    assert found[0, 2] == pytest.approx(0.5, abs=0.02)  # 3 / sqrt(25600) = 0.02
    assert abs(found[0, 1]) < 0.02
    assert counts.std(axis=0) == pytest.approx(0.002 / 60 * 8 * SCALE / 1e-7, rel=0.02)


@pytest.mark.parametrize(
    ("effect", "parameters"),
    [("bias_instability", {"deg_h": 5.0}), ("rate_random_walk", {"deg_h_sqrt_h": 100.0})],
)
def test_further_processes_leave_the_record_s_own_noise_as_it_was(effect, parameters):
    plain, more = noise_counts(), noise_counts(on(effect, **parameters))
    assert (plain[:, 1:] == more[:, 1:]).all()
    assert (more - plain)[:, 0].std() > 1.0 * COUNTS_PER_DEG_H


# --- electronics -------------------------------------------------------------------------------------------


def test_lost_bits_of_negative_counts_too():
    _, d, before = difference(on("lost_bits", "gyro3", bits=4))
    after = (d + before)[:, 2]
    assert (after % 16 == 0).all()
    assert ((before[:, 2] - after) >= 0).all()
    assert ((before[:, 2] - after) < 16).all()


def test_adc_nonlinearity():
    _, d, before = difference(on("adc_nonlinearity", "gyro3", volts=3e-6, period_volts=4e-5))
    expected = 30.0 * np.sin(2 * np.pi * before[:, 2] * 1e-7 / 4e-5)
    # half a count in the argument is another quarter of a count in the sine
    assert np.abs(d[:, 2] - expected).max() <= TOLERANCE + 0.25


def test_saturation():
    _, d, before = difference(on("saturation", "gyro3", volts=2e-4), campaign(FAST, bias=(0.0,) * 3))
    close((d + before)[:, 2], np.clip(before[:, 2], -2000, 2000))


def test_crosstalk():
    _, d, before = difference(on("crosstalk", "gyro3", ppm=50.0, source="gyro1"))
    close(d[:, 2], 50e-6 * before[:, 0])


def test_low_pass_lags_by_its_time_constant():
    of = campaign(run(profile=((1.0, 10.0), (3.0, 10.0))))
    t, d, before = difference(on("low_pass", time_constant_ms=200.0), of)
    after, base = (d + before)[:, 0], before[0, 0]
    jump = before[-1, 0] - base
    later = t >= 10.0
    # the step lies between the samples before and at 10 s: half a sample of doubt
    grown = base + jump * (1 - np.exp(-(t[later] - 10.0) / 0.2))
    assert np.abs(after[later] - grown).max() < jump * (1 / 64) / 0.2 * 0.6
    close(after[~later], base)


# --- clock, link, wiring -----------------------------------------------------------------------------------


def test_clock_error():
    stamps = stamps_us(FAST, (Entry("clock_error", ("clock",), ("*",), {"ppm": 1000.0}),))
    t = np.arange(FAST.samples) / 64.0
    assert np.abs(stamps - t / 1.001 * 1e6).max() <= 0.5


def test_latency_sees_the_first_reading_before_the_start():
    t, d, before = difference(on("latency", "gyro3", ms=500.0))
    close((d + before)[:, 2], rate_counts(EARTH * np.cos(np.deg2rad(9.0 * np.maximum(t - 0.5, 0.0)))))


def test_link_faults_strike_their_share_each_independently():
    of = campaign(run(duration=400.0))
    world = realistic_world(of, (on("dropouts", fraction=0.01), on("spikes", "gyro2", fraction=0.01),
                                 on("stuck_samples", "gyro3", fraction=0.01)), 5)  # fmt: skip
    _, counts = run_counts(world, of.runs[0])
    n = len(counts)
    four_sigma = 4 * np.sqrt(0.01 / n)
    assert (counts[:, 0] == MISSING).mean() == pytest.approx(0.01, abs=four_sigma)
    assert (np.abs(counts[:, 1]) > 1e6).mean() == pytest.approx(0.01 * (1 - 1e6 / 2**30), abs=four_sigma)
    assert np.abs(counts[:, 1]).max() <= 2**30
    repeats = (counts[1:, 2] == counts[:-1, 2]).mean()
    sigma = 0.002 / 60 * 8 * SCALE / 1e-7
    assert repeats == pytest.approx(0.01 + 1 / (2 * sigma * np.sqrt(np.pi)), abs=four_sigma + 5e-4)


def test_channel_swap_and_polarity_error():
    of = campaign(FAST)
    _, _, after = change(of, on("channel_swap", "gyro1", **{"with": "gyro3"}))
    _, before, wrong = change(of, on("polarity_error", "gyro1"))
    assert (after == before[:, [2, 1, 0]]).all()
    assert (wrong == before * [-1, 1, 1]).all()


def test_order_noise_before_filter_bits_before_dropouts_before_swap():
    of = campaign(run(duration=60.0))
    entries = (on("low_pass", "gyro3", time_constant_ms=500.0), on("lost_bits", "gyro3", bits=6),
               on("dropouts", "gyro3", fraction=0.1), on("channel_swap", "gyro1", **{"with": "gyro3"}),
               on("polarity_error", "gyro1"))  # fmt: skip
    _, counts = run_counts(realistic_world(of, entries, 5), of.runs[0])
    column = counts[:, 0]
    answered = column[column != MISSING]
    assert len(answered) < len(column)  # the missing stay missing through swap and sign
    assert (answered % 64 == 0).all()
    assert (answered < 0).all()  # Earth's rate along z, in gyro 1's column, with the other sign
    assert np.diff(answered).std() < 0.3 * np.diff(counts[:, 1]).std()  # the filter smoothed the noise


# --- the whole table ---------------------------------------------------------------------------------------

EXAMPLES = {
    "table_rate_error": table("table_rate_error", ppm=0.0),
    "table_rate_ripple": table("table_rate_ripple", ppm=0.0, harmonic=1, phase_rad=0.0),
    "heading_error": table("heading_error", deg=0.0),
    "latitude_error": table("latitude_error", deg=0.0),
    "start_offset": table("start_offset", s=0.0),
    "mount_rotation": table("mount_rotation", mrad=[0.0, 0.0, 0.0]),
    "base_motion": table("base_motion", deg_h=0.0, frequency_hz=3.0, axis=[1.0, 0.0, 0.0]),
    "bias_offset": on("bias_offset", deg_h=0.0),
    "turn_on_bias": on("turn_on_bias", deg_h=0.0),
    "bias_ramp": on("bias_ramp", deg_h_per_h=0.0),
    "bias_step": on("bias_step", deg_h=0.0, time_s=3.0),
    "warm_up": on("warm_up", deg_h=0.0, tau_s=3.0),
    "temperature_bias": on("temperature_bias", deg_h_per_degC=0.0),
    "temperature_rate_bias": on("temperature_rate_bias", deg_h_per_degC_per_min=0.0),
    "temperature_scale_factor": on("temperature_scale_factor", ppm_per_degC=0.0),
    "scale_factor_error": on("scale_factor_error", ppm=0.0),
    "scale_factor_asymmetry": on("scale_factor_asymmetry", ppm=0.0),
    "scale_factor_nonlinearity": on("scale_factor_nonlinearity", ppm_at_10_deg_s=0.0),
    "axis_misalignment": on("axis_misalignment", mrad=[0.0, 0.0, 0.0]),
    "acceleration_bias": on("acceleration_bias", deg_h_per_g=0.0),
    "magnetic_bias": on("magnetic_bias", deg_h=0.0, field_direction=[0.0, 1.0, 0.0]),
    "dead_zone": on("dead_zone", deg_h=0.0, kind="threshold"),
    "bias_instability": on("bias_instability", deg_h=0.0),
    "rate_random_walk": on("rate_random_walk", deg_h_sqrt_h=0.0),
    "common_noise": Entry("common_noise", ("gyro1", "gyro2"), ("*",), {"correlation": 0.0}),
    "periodic_interference": on("periodic_interference", deg_h=0.0, frequency_hz=3.0),
    "lost_bits": on("lost_bits", bits=0),
    "adc_nonlinearity": on("adc_nonlinearity", volts=0.0, period_volts=1e-5),
    "saturation": on("saturation", volts=1e9),
    "crosstalk": on("crosstalk", ppm=0.0, source="gyro2"),
    "low_pass": on("low_pass", time_constant_ms=1e-9),
    "clock_error": Entry("clock_error", ("clock",), ("*",), {"ppm": 0.0}),
    "latency": on("latency", ms=0.0),
    "dropouts": on("dropouts", fraction=0.0),
    "spikes": on("spikes", fraction=0.0),
    "stuck_samples": on("stuck_samples", fraction=0.0),
}
NEVER_OFF = {"rotation_sense", "channel_swap", "polarity_error", "angle_random_walk"}


def test_the_table_is_whole():
    assert len(NAMES) == 40
    assert set(PARAMETERS) == set(NAMES)
    assert set(EXAMPLES) | NEVER_OFF == set(NAMES)


@pytest.mark.parametrize("effect", sorted(EXAMPLES))
def test_the_examples_state_what_the_catalogue_asks(effect):
    stated = set(EXAMPLES[effect].parameters)
    assert set(PARAMETERS[effect]) <= stated
    assert stated <= set(PARAMETERS[effect]) | ({"phase_rad"} if effect in WITH_PHASE else set())


@pytest.mark.parametrize("effect", sorted(EXAMPLES))
def test_off_is_identity(effect):
    of = Campaign("hand", unit(), (run(rate=5.0, duration=5.0),))
    plain, off = (run_counts(realistic_world(of, e, 1), of.runs[0]) for e in ((), (EXAMPLES[effect],)))
    assert encode(of.runs[0], of.unit, *plain) == encode(of.runs[0], of.unit, *off)


def test_exact_worlds_have_no_noise_and_are_the_same_for_ever():
    one = exact_world(campaign(FAST))
    assert encode(FAST, unit(), *run_counts(one, FAST)) == encode(FAST, unit(), *run_counts(one, FAST))
