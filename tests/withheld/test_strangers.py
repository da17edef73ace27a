"""Effects that never were in the catalogue: each is what its name says, on its gyro alone."""

import numpy as np
import pytest
from bench import COUNTS_PER_DEG_H, campaign, change, run

from withheld.chain.injector import exact_world, realistic_world, run_counts
from withheld.effects.catalogue import NAMES as CATALOGUE
from withheld.effects.entry import Entry
from withheld.effects.strangers import NAMES, in_run

OF = campaign(run(rate=9.0, duration=40.0))
ALPHA = 9.0  # deg/s

PARAMETERS = {
    "telegraph_bias": {"deg_h": 50.0, "mean_s": 4.0, "seed": 5},
    "gain_switching": {"ppm": 300.0, "mean_s": 4.0, "seed": 6},
    "glitch_train": {"deg_h": 200.0, "mean_s": 4.0, "decay_s": 0.5, "seed": 7},
    "sawtooth_bias": {"deg_h": 20.0, "period_s": 8.0},
    "rate_squared": {"deg_h_at_10_deg_s": 30.0},
    "third_harmonic": {"deg_h": 10.0, "phase_rad": 0.5},
    "temperature_squared": {"deg_h_per_degC2": 100.0},
    "rate_after_effect": {"ppm": 500.0, "tau_s": 5.0},
    "saturation_recovery": {"deg_h": 40.0, "tau_s": 6.0},
    "line_intermodulation": {"deg_h": 20.0, "frequency_1_hz": 10.0, "frequency_2_hz": 3.0},
    "encoder_ripple_bias": {"deg_h": 10.0, "lines_per_turn": 12, "phase_rad": 0.0},
    "band_limited_noise": {"deg_h": 100.0, "low_hz": 5.0, "high_hz": 10.0},
}


def entry(effect):
    return Entry(effect, ("gyro1",), ("*",), PARAMETERS[effect])


def difference(effect):
    """Times [s] and what the effect adds to gyro 1 [deg/h]; the other gyros must not change."""
    t, before, after = change(OF, entry(effect))
    assert (before[:, 1:] == after[:, 1:]).all()
    return t, (after - before)[:, 0] / COUNTS_PER_DEG_H


def test_the_list():
    assert set(PARAMETERS) == set(NAMES)
    assert not set(NAMES) & set(CATALOGUE)


EXPECTED = {
    "sawtooth_bias": lambda t: 20.0 * ((t / 8.0) % 1.0 - 0.5),
    "rate_squared": lambda t: np.full_like(t, 30.0 * 0.81),
    "third_harmonic": lambda t: 10.0 * np.cos(3 * np.deg2rad(ALPHA * t) + 0.5),
    "temperature_squared": lambda t: 100.0 * (0.01 * t) ** 2,
    "saturation_recovery": lambda t: 40.0 / (1 + t / 6.0),
    "encoder_ripple_bias": lambda t: 10.0 * np.sin(12 * np.deg2rad(ALPHA * t)),
    "line_intermodulation": lambda t: (
        20.0
        * (
            np.sin(20 * np.pi * t)
            + np.sin(6 * np.pi * t)
            + 0.6 * np.sin(26 * np.pi * t)
            + 0.6 * np.sin(14 * np.pi * t)
        )
    ),
}


@pytest.mark.parametrize("effect", EXPECTED)
def test_waveforms_by_hand(effect):
    t, found = difference(effect)
    assert found == pytest.approx(EXPECTED[effect](t), abs=1.01 / COUNTS_PER_DEG_H)


def test_the_telegraph_has_two_levels_and_turns_at_random_times():
    _, found = difference("telegraph_bias")
    levels = np.unique(np.round(found))
    assert levels.tolist() == [-25.0, 25.0]
    turns = np.count_nonzero(np.diff(np.sign(found)))
    assert 2 <= turns <= 25  # ten on average


def test_a_gain_switches_between_two_values():
    _, found = difference("gain_switching")
    assert np.unique(np.round(found, 1)) == pytest.approx([-150e-6 * 9 * 3600, 150e-6 * 9 * 3600], abs=0.1)


def test_glitches_die_away():
    t, found = difference("glitch_train")
    times = in_run(entry("glitch_train"), "r1").parameters["times_s"]
    first = times[times > 0][0]
    after = (t > first) & (t < min(times[times > first][0], first + 1.0))
    assert found[after] == pytest.approx(200.0 * np.exp(-(t[after] - first) / 0.5), abs=0.1)


def test_times_are_drawn_afresh_in_each_run():
    a, b = (in_run(entry("telegraph_bias"), name).parameters["times_s"] for name in "ab")
    assert a[0] != b[0]


def test_the_after_effect_grows_with_its_time_constant_from_rest():
    t, found = difference("rate_after_effect")
    grown = 500e-6 * 9 * 3600 * (1 - np.exp(-t / 5.0))
    assert found == pytest.approx(grown, abs=0.02)


def test_band_limited_noise_is_there_and_in_its_band():
    with_it, without = (
        run_counts(realistic_world(OF, entries, 1), OF.runs[0])[1]
        for entries in ((entry("band_limited_noise"),), ())
    )
    added = (with_it - without)[:, 0] / COUNTS_PER_DEG_H
    assert added.std() == pytest.approx(100.0, rel=0.15)
    power = np.abs(np.fft.rfft(added)) ** 2
    frequency = np.fft.rfftfreq(added.size, 1 / 64.0)
    assert power[(frequency > 4.9) & (frequency < 10.1)].sum() > 0.999 * power.sum()
    # in a world without noise there is none
    still = run_counts(exact_world(OF, (entry("band_limited_noise"),)), OF.runs[0])[1]
    assert (still == run_counts(exact_world(OF), OF.runs[0])[1]).all()
