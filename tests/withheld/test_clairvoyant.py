"""What can be known at best, against closed forms and against simulated noise."""

from dataclasses import replace

import numpy as np
import pytest
from bench import COUNTS_PER_DEG_H, SCALE, THREE, UP_Y, campaign, on, run
from scipy.linalg import toeplitz
from scipy.stats import chi2, multivariate_normal

from withheld.chain.electronics import first_order
from withheld.chain.injector import exact_world, realistic_world, run_counts
from withheld.clairvoyant.appraisal import appraise, effect_snr
from withheld.clairvoyant.blocks import block_count, difference, metric
from withheld.clairvoyant.closures import captured, full_rate_gain, subset_closure
from withheld.clairvoyant.covariance import block_covariance, walk
from withheld.clairvoyant.exchange import left_of, places
from withheld.clairvoyant.full_rate import Healthy, bernoulli_divergence
from withheld.clairvoyant.lines import motion_share
from withheld.clairvoyant.separation import left_by, snr
from withheld.effects.catalogue import NAMES
from withheld.effects.entry import Entry

ALL = frozenset(NAMES)
WHITE = {"instability_deg_h": (0.0,) * 3, "turn_on_deg_h": (0.0,) * 3}
HEALTHY = Healthy()


def found(of, entry, healthy=HEALTHY):
    world = exact_world(of, (entry,))
    return effect_snr(world, metric(world), entry, healthy)


def test_a_step_in_white_noise():
    of = campaign(run(duration=200.0, temperature=False), **WHITE, bias_sd=(0.0,) * 3)
    # half the run lies above: amplitude * sqrt(n) / sigma with every nuisance constant in time switched off
    step = Entry("bias_step", ("gyro1",), ("r1",), {"deg_h": 0.3, "time_s": 100.0})
    # (the latitude's uncertainty takes a two-thousandth of it)
    assert found(of, step) == pytest.approx(0.3 * np.sqrt(100 * 64) / (0.002 / 60 * 8 * 3600), rel=1e-3)


def test_an_offset_hides_behind_the_turn_on_bias():
    quiet = {"instability_deg_h": (0.0,) * 3, "bias_sd": (0.0,) * 3}
    of = campaign(run("a", duration=200.0), run("b", duration=200.0), **quiet)
    # two runs at a standstill, each with a fresh turn-on bias: sigma^2 = (0.05^2 + N^2 / T) / 2
    sigma = np.sqrt((0.05**2 + 0.002**2 * 3600 / 200) / 2)
    assert found(of, on("bias_offset", deg_h=1.0)) == pytest.approx(1.0 / sigma, rel=1e-3)


def test_a_scale_factor_error_hides_behind_its_uncertainty():
    of = campaign(run("a", 10.0, 200.0), run("b", -10.0, 200.0))
    # 400 ppm of which 20 are allowed by the calibration and 5 by the table: 400 / sqrt(20^2 + 5^2)
    assert found(of, on("scale_factor_error", ppm=400.0)) == pytest.approx(400 / np.sqrt(425), rel=2e-2)


def decoded_blocks(of, world):
    """Block means of a world's counts less the nominal prediction, run by run [deg/h]."""
    nominal, rows = exact_world(of), []
    for one in of.runs:
        blocks, length = block_count(one)
        per = int(length * one.sample_rate_hz)
        rate = [run_counts(w, one)[1][: blocks * per] * 1e-7 / SCALE * 3600 for w in (world, nominal)]
        rows.append((rate[0] - rate[1]).reshape(blocks, per, -1).mean(axis=1))
    return rows


def whitened_chi2(of, seed):
    """x' S^-1 x of a campaign with nothing wrong, decoded from its counts as a reduction would."""
    world = realistic_world(of, (), seed, noise_level_rel=0.0)
    inner = metric(world)
    white = inner.white(decoded_blocks(of, world))
    return float(inner.gram(white[:, None], white[:, None])[0, 0]), len(white)


def test_simulated_noise_is_white_in_the_metric():
    of = campaign(run("a", 8.0, 60.0), run("b", -8.0, 60.0), run("c", 0.0, 60.0), rrw_deg_h_sqrt_h=(0.3,) * 3)
    values = [whitened_chi2(of, seed) for seed in range(24)]
    total, n = sum(v for v, _ in values), sum(n for _, n in values)
    # noise and uncertainties together are a chi-square of n degrees of freedom; two-sided 1e-4
    assert 1e-4 < chi2.cdf(total, n) < 1 - 1e-4


def test_the_metric_notices_noise_that_is_five_per_cent_larger():
    of = campaign(run("a", 8.0, 60.0), run("b", -8.0, 60.0), run("c", 0.0, 60.0))
    values = [whitened_chi2(of, seed) for seed in range(24)]
    total, n = sum(v for v, _ in values), sum(n for _, n in values)
    assert chi2.cdf(total * 1.05**2, n) > 1 - 1e-4


def test_a_matched_filter_finds_what_the_ratio_promises():
    of = campaign(run("a", 8.0, 60.0), run("b", -8.0, 60.0), run("c", 0.0, 60.0))
    entry = on("scale_factor_asymmetry", ppm=150.0)
    outputs = []
    for seed in range(40):
        world = realistic_world(of, (entry,), seed, noise_level_rel=0.0)
        inner = metric(world)
        data = inner.white(decoded_blocks(of, world))
        model = inner.white(difference(world, (entry,)))
        size = snr(inner, model)
        outputs.append(float(inner.gram(data[:, None], model[:, None])[0, 0]) / size - size)
    assert size > 5.0
    # a normal of mean 0 and deviation 1, forty times
    assert abs(np.mean(outputs)) < 4 / np.sqrt(40)
    assert np.std(outputs) == pytest.approx(1.0, abs=4 / np.sqrt(80))


def rivals_of(of, entry, catalogue=ALL):
    label = appraise(exact_world(of, (entry,)), catalogue, HEALTHY)["effects"][0]
    return label, {(r["effect"], *r["channels"]): r["separation"] for r in label["rivals"]}


def test_one_run_cannot_tell_an_offset_from_a_turn_on_bias_or_a_scale_factor():
    label, rivals = rivals_of(campaign(run("a", 8.0, 300.0)), on("bias_offset", deg_h=2.0))
    assert label["snr"] > 2.0
    assert rivals[("turn_on_bias", "gyro1")] < 1e-3
    assert rivals[("scale_factor_error", "gyro1")] < 1e-3  # Earth's rate on gyro 1 is constant, too


def test_two_senses_and_a_standstill_tell_them_apart():
    of = campaign(*(run(name, rate, 300.0) for name, rate in (("a", 8.0), ("b", -8.0), ("c", 0.0))))
    label, rivals = rivals_of(of, on("bias_offset", deg_h=2.0))
    assert rivals.get(("scale_factor_error", "gyro1"), 99.0) > 6.0
    assert label["snr"] > 8.0


def test_an_effect_out_of_the_catalogue_is_nobody_s_rival():
    of = campaign(run("a", 8.0, 300.0))
    _, rivals = rivals_of(of, on("bias_offset", deg_h=2.0), ALL - {"turn_on_bias"})
    assert ("turn_on_bias", "gyro1") not in rivals


def test_four_equal_scale_factors_are_the_table_s_rate():
    of = campaign(run("a", 8.0, 300.0))
    everyone = ("scale_factor_error", "gyro1", "gyro2", "gyro3")
    _, rivals = rivals_of(of, Entry("table_rate_error", ("table",), ("*",), {"ppm": 30.0}))
    assert rivals[everyone] < 1.0
    # a larger one turns the unit far enough for Earth's rate to show the angle
    _, rivals = rivals_of(of, Entry("table_rate_error", ("table",), ("*",), {"ppm": 200.0}))
    assert rivals.get(everyone, 99.0) > 4.0


def test_what_a_free_multiple_leaves():
    of = campaign(run(duration=100.0), **WHITE)
    world = exact_world(of)
    inner = metric(world)
    ramp = inner.white(difference(world, (on("bias_ramp", deg_h_per_h=30.0),)))
    assert left_by(inner, ramp, ramp[:, None] * 7.0) == pytest.approx(0.0, abs=1e-4 * snr(inner, ramp))
    step = Entry("bias_step", ("gyro1",), ("r1",), {"deg_h": 1.0, "time_s": 50.0})
    both = np.stack([ramp, inner.white(difference(world, (step,)))], axis=1)
    assert left_by(inner, ramp, both[:, 1:]) < snr(inner, ramp)


def test_what_else_is_wrong_is_profiled_out():
    of = campaign(run(duration=300.0, temperature=False))
    offset, ramp = on("bias_offset", deg_h=3.0), on("bias_ramp", deg_h_per_h=30.0)
    world = exact_world(of, (ramp,))
    alone = appraise(world, ALL, HEALTHY)["effects"][0]
    beside = appraise(replace(world, entries=(ramp, offset)), ALL, HEALTHY)["effects"][0]
    assert beside["snr"] == pytest.approx(alone["snr"])
    assert alone["attainable_std"] == pytest.approx(1 / alone["snr"])
    assert beside["attainable_std"] > alone["attainable_std"]
    assert beside["best_rival"] <= alone["best_rival"] + 1e-5 * alone["snr"]


def test_full_rate_ratios_by_hand():
    of = campaign(run(duration=200.0))
    n = 200 * 64
    both = Entry("common_noise", ("gyro1", "gyro2"), ("*",), {"correlation": 0.1})
    assert found(of, both) == pytest.approx(np.sqrt(-n * np.log(1 - 0.01)))
    assert found(of, on("lost_bits", bits=3)) == pytest.approx(np.sqrt(2 * n * 3 * np.log(2)))
    level = on("angle_random_walk", deg_sqrt_h=0.002 * np.exp(0.1))
    assert found(of, level) == pytest.approx(0.1 / np.sqrt(1 / (2 * n) + 0.02**2))
    line = on("periodic_interference", deg_h=0.5, frequency_hz=10.0, phase_rad=0.0)
    sigma = 0.002 / 60 * 8 * 3600
    assert found(of, line) == pytest.approx(0.5 / sigma * np.sqrt(n / 2), rel=2e-3)
    clock = Entry("clock_error", ("clock",), ("*",), {"ppm": 1.0})
    t = np.arange(n) / 64.0
    assert found(of, clock) == pytest.approx(np.sqrt(12 * np.sum((t * 1.0) ** 2)), rel=0.02)


def test_a_further_walk_against_likelihood_ratios_of_simulated_blocks():
    of = campaign(run(duration=60.0))
    entry = on("rate_random_walk", deg_h_sqrt_h=8.0)
    before = block_covariance(60, 1.0, 0.002, 0.03, 0.0, 0.05)
    after = before + 64.0 * walk(60, 1.0)
    x = np.random.default_rng(1).multivariate_normal(np.zeros(60), after, size=4000)
    ratios = multivariate_normal(np.zeros(60), after).logpdf(x) - multivariate_normal(
        np.zeros(60), before
    ).logpdf(x)
    spread = 2 * ratios.std() / np.sqrt(4000)
    assert found(of, entry) ** 2 == pytest.approx(2 * ratios.mean(), abs=4 * spread)


def test_filtered_noise_against_the_exact_gaussian_divergence():
    n, tau, step = 1000, 4e-3, 1 / 64.0
    of = campaign(run(duration=n * step))
    impulse = first_order(np.concatenate([np.zeros(200), [1.0], np.zeros(200)]), step, tau)
    lags = np.array([impulse[: impulse.size - k] @ impulse[k:] for k in range(60)])
    covariance = toeplitz(np.concatenate([lags, np.zeros(n - 60)]))
    exact = np.trace(covariance) - n - np.linalg.slogdet(covariance)[1]
    ratio = found(of, on("low_pass", "gyro2", time_constant_ms=4.0), Healthy(noise_level_rel=0.0))
    assert ratio**2 == pytest.approx(exact, rel=0.02)  # ends of the record: a few of 1000 samples


def test_bernoulli_divergence():
    assert bernoulli_divergence(0.3, 0.3) == pytest.approx(0.0, abs=1e-15)
    assert bernoulli_divergence(1.0, 0.5) == pytest.approx(np.log(2))


def test_small_converter_error_against_a_likelihood_ratio_by_simulation():
    of = campaign(run(duration=200.0), bias_sd=(0.0,) * 3)
    sigma = 0.002 / 60 * 8 * SCALE
    period, size = 3.0 * sigma, 0.02 * sigma
    ratio = found(of, on("adc_nonlinearity", "gyro2", volts=size, period_volts=period))
    rng = np.random.default_rng(1)
    v = sigma * rng.standard_normal(2_000_000)  # gyro 2 reads 0 at this standstill
    # density of v + g(v) to first order, and the sample's own log likelihood ratio
    turn = 2 * np.pi / period
    score = -size * turn * np.cos(turn * v) + size * np.sin(turn * v) * v / sigma**2
    assert ratio == pytest.approx(np.sqrt(200 * 64 * np.mean(score**2)), rel=0.02)


def test_a_low_pass_whitens_nothing_away():
    of = campaign(run(duration=200.0))
    weak, strong = (found(of, on("low_pass", time_constant_ms=ms)) for ms in (0.5, 5.0))
    assert 0 < weak < strong
    exact = found(of, on("low_pass", time_constant_ms=5.0), Healthy(noise_level_rel=0.0))
    assert exact > strong  # a level that is not known hides a part


def test_a_motion_of_three_gyros_is_any_line():
    of = campaign(run())
    assert motion_share(exact_world(of), np.array([4.0, 0.0, 0.0])) == pytest.approx(1.0)
    four = campaign(run(polarity=(1,) * 4), n=4)
    # four axes, three motions: a line on the fourth alone is half a motion (its leverage)
    axes = np.vstack([np.eye(3), np.ones(3) / np.sqrt(3)])
    leverage = (axes @ np.linalg.inv(axes.T @ axes) @ axes.T)[3, 3]
    assert motion_share(exact_world(four), np.array([0, 0, 0, 9.0])) == pytest.approx(leverage)


def test_the_oracle_closes_all_of_an_exact_gap_and_less_of_a_departed_one():
    of = campaign(run("a", 8.0, 100.0))
    entry = on("bias_offset", deg_h=20.0)
    assert appraise(exact_world(of, (entry,)), ALL, HEALTHY)["oracle_closure"] == pytest.approx(1.0)
    wobble = {"wobble": 0.3, "wobble_period_s": 50.0, "wobble_phase_rad": 0.0}
    departed = appraise(exact_world(of, (replace(entry, departure=wobble),)), ALL, HEALTHY)
    assert departed["oracle_closure"] < 0.999


def test_a_step_that_takes_its_time_is_known_at_the_instant_of_the_same_integral():
    of = campaign(run(duration=200.0, temperature=False), **WHITE, bias_sd=(0.0,) * 3)
    step = Entry("bias_step", ("gyro1",), ("r1",), {"deg_h": 2.0, "time_s": 100.0}, {"rise_s": 4.0})
    closes = appraise(exact_world(of, (step,)), ALL, HEALTHY)["oracle_closure"]
    # of (1 - exp(-t/r))^2 over 100 s, which is 100 - 1.5 r, the sudden step leaves r (2/e - 1/2)
    assert 1.0 - closes == pytest.approx(4.0 * (2.0 / np.e - 0.5) / 94.0, rel=0.03)


def test_nothing_wrong_has_no_label():
    assert appraise(exact_world(campaign()), ALL, HEALTHY) == {
        "effects": [],
        "slow_snr": 0.0,
        "oracle_closure": None,
        "closure_gram": None,
        "linear": None,
    }


def test_closures_of_single_effects():
    of = campaign(*THREE)
    entries = (on("bias_offset", deg_h=1.0), on("scale_factor_error", "gyro2", ppm=400.0))
    world = exact_world(of, entries)
    known = appraise(world, ALL, HEALTHY)
    gram, snrs = np.array(known["closure_gram"]), [e["snr"] for e in known["effects"]]
    # different gyros: their parts of the gap add up to all of it, in the ratio of their SNR^2
    parts = [s**2 / sum(x**2 for x in snrs) for s in snrs]
    assert subset_closure(gram, [0]) == pytest.approx(parts[0], abs=1e-3)
    assert subset_closure(gram, [1]) == pytest.approx(parts[1], abs=1e-3)
    assert subset_closure(gram, [0, 1]) == pytest.approx(known["oracle_closure"], abs=1e-6)
    assert subset_closure(gram, []) == 0.0


def test_what_only_the_full_rate_shows_is_a_part_of_the_gap():
    of = campaign(*THREE)
    entries = (on("bias_offset", deg_h=1.0), on("dropouts", "gyro3", fraction=2e-3))
    known = appraise(exact_world(of, entries), ALL, HEALTHY)
    gram, snrs = np.array(known["closure_gram"]), [e["snr"] for e in known["effects"]]
    parts = [subset_closure(gram, [k]) for k in (0, 1)]
    assert sum(parts) == pytest.approx(subset_closure(gram, [0, 1])) == pytest.approx(1.0, abs=1e-6)
    # some 77 readings were lost: their number is known to an eighth
    assert parts[1] / parts[0] == pytest.approx((snrs[1] / snrs[0]) ** 2, rel=0.4)
    # a unit whose link alone is at fault
    link = appraise(exact_world(of, entries[1:]), ALL, HEALTHY)
    assert subset_closure(np.array(link["closure_gram"]), [0]) == pytest.approx(1.0)


def test_a_line_in_the_captures_gains_what_it_is():
    of = campaign(*THREE)
    line = on("periodic_interference", deg_h=6.0, frequency_hz=7.3)
    exact = exact_world(of, (line,))
    assert full_rate_gain(exact, line, HEALTHY) == pytest.approx(found(of, line) ** 2, rel=1e-6)
    gains = [full_rate_gain(realistic_world(of, (line,), seed), line, HEALTHY) for seed in range(12)]
    # |c + n|^2 - |n|^2 scatters by 2 |c|
    size = found(of, line)
    assert np.mean(gains) == pytest.approx(size**2, abs=2.0 * size)
    assert 0.8 * size < np.std(gains) < 4.0 * size


def test_the_gap_of_these_captures_has_their_noise_in_it():
    of = campaign(run("a", 8.0, 100.0), run("b", 0.0, 100.0))
    world = realistic_world(of, (on("bias_offset", deg_h=1.0),), 3)
    still = exact_world(of)
    for one, means in zip(of.runs, captured(world), strict=True):
        _, counts = run_counts(world, one)
        _, predicted = run_counts(still, one)
        samples = (counts - predicted) / COUNTS_PER_DEG_H
        blocks, length = block_count(one)
        each = samples.reshape(blocks, -1, 3).mean(axis=1)
        assert length == 1.0
        # counts are whole, and a scale factor is 20 ppm off
        np.testing.assert_allclose(means, each, atol=2.0 / COUNTS_PER_DEG_H)
    known = appraise(world, ALL, HEALTHY)
    # noise along the offset is in the gap and, to first order, in what closes
    assert subset_closure(np.array(known["closure_gram"]), [0]) == pytest.approx(1.0, abs=0.05)


def test_a_further_random_process_has_no_closure_to_compare_with():
    of = campaign(*THREE)
    world = exact_world(of, (on("bias_offset", deg_h=1.0), on("rate_random_walk", deg_h_sqrt_h=3.0)))
    assert appraise(world, ALL, HEALTHY)["closure_gram"] is None


def test_a_set_of_causes_that_does_what_the_true_set_does():
    up_z = (("z", "up"), ("y", "north"))
    of = campaign(
        run("a", 8.0, 100.0), run("b", 8.0, 100.0, axis=(0.0, 1.0, 0.0), orientation=UP_Y),
        run("c", 8.0, 100.0, axis=(0.0, 0.0, 1.0), orientation=up_z),
    )  # fmt: skip
    every = [
        on("axis_misalignment", "gyro1", mrad=[0.0, 0.3, 0.1]),
        on("axis_misalignment", "gyro2", mrad=[0.2, 0.0, -0.4]),
        on("axis_misalignment", "gyro3", mrad=[0.5, 0.1, 0.0]),
        on("bias_offset", "gyro1", deg_h=1.0),
    ]
    table = appraise(exact_world(of, tuple(every)), ALL, HEALTHY)["linear"]
    size = left_of(table, [])
    tipped = [("axis_misalignment", (f"gyro{i}",), ("*",)) for i in (1, 2, 3)]
    offset, mount = ("bias_offset", ("gyro1",), ("*",)), ("mount_rotation", ("table",), ("*",))
    assert size > 20.0
    assert left_of(table, [*tipped, offset]) < 0.1
    assert left_of(table, [mount, *tipped[:2], offset]) < 0.1
    assert left_of(table, [mount, *tipped[:1], offset]) > 4.0
    # on gyros at right angles an axis that tips reads what the other two read
    cross = [("crosstalk", (f"gyro{i}",), ("*",)) for i in (1, 2, 3)]
    assert left_of(table, [*cross, offset]) < 0.1
    assert ("warm_up", ("gyro1",), ("*",)) not in places(table)  # a grid of time constants
