"""The search for spurious counts: it finds them, and leaves alone what only looks odd.

Noise is of 300 counts, as the published unit's; the floor is half of it, as ingest sets it from stated noise.
Seeds are fixed. At a threshold of 8 standard deviations chance makes one false alarm in 10^15 samples.
"""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.estimate.outliers import (
    CONTEXT,
    OutlierSearch,
    dense,
    isolated,
    narrow_scales,
    robust_scale,
    robust_scales,
)

SIGMA = 300.0
FLOOR = SIGMA / 2
SPIKE = 10_000_000  # a count out of +-2^30 is smaller than this once in a hundred times
THRESHOLD = 8.0
BLOCK = 4096


def noise(size: int, seed: int = 0, sigma: float = SIGMA) -> np.ndarray:
    return np.random.default_rng(seed).normal(0.0, sigma, size)


def counts(values: np.ndarray) -> np.ndarray:
    return np.rint(values).astype(np.int32)


def searched(values: np.ndarray, block: int = BLOCK, floor: float = FLOOR) -> np.ndarray:
    """Flags of one gyro's record, searched block by block with the neighbours at hand."""
    rows = values[None]
    search = OutlierSearch(THRESHOLD, np.array([floor]))
    found = []
    for start in range(0, values.size, block):
        stop = start + block
        before = rows[:, max(0, start - CONTEXT) : start] if start else None
        after = rows[:, stop : stop + CONTEXT] if stop < values.size else None
        found.append(search.flags(before, rows[:, start:stop], after)[0])
    return np.concatenate(found)


def nothing_in(values: np.ndarray) -> None:
    assert np.flatnonzero(searched(counts(values))).tolist() == []


# ------------------------------------------------------------------------------- what must be found


@pytest.mark.parametrize("sign", [1, -1])
def test_single_spikes_are_found_and_nothing_else(sign: int) -> None:
    values = counts(noise(50_000))
    where = np.array([5000, 5003, 20_000, 20_001, 33_333])
    values[where] += sign * SPIKE
    np.testing.assert_array_equal(np.flatnonzero(searched(values)), where)


def test_the_smallest_spikes_that_stand_out() -> None:
    """20 standard deviations: beyond the threshold whatever the scale's scatter and the spike's own noise."""
    values = noise(20_000, seed=3)
    values[4321] += 20 * SIGMA
    assert np.flatnonzero(searched(counts(values))).tolist() == [4321]


@pytest.mark.parametrize("block", [1000, 1024, 4096, 65_536])
@pytest.mark.parametrize("at", [0, 1, 999, 1000, 1001, 4095, 4096, 4097, 9998, 9999])
def test_a_spike_at_a_blocks_edge(block: int, at: int) -> None:
    """The first and last records of the record and of its blocks; 1000 and 4096 are ends of some blocks."""
    values = counts(noise(10_000, seed=at))
    values[at] += SPIKE
    assert np.flatnonzero(searched(values, block)).tolist() == [at]


@pytest.mark.parametrize("tail", [1, 2, 5, 8, 9])
def test_a_spike_in_a_last_block_of_a_few_records(tail: int) -> None:
    values = counts(noise(BLOCK + tail, seed=tail))
    values[-1] += SPIKE
    assert np.flatnonzero(searched(values)).tolist() == [values.size - 1]


def test_flags_do_not_depend_on_the_size_of_blocks() -> None:
    values = counts(noise(60_000, seed=5) + 3000 * np.sin(np.arange(60_000) / 500))
    where = np.sort(np.random.default_rng(6).choice(values.size, 200, replace=False))
    values[where] += SPIKE
    reference = searched(values, 65_536)
    for block in (512, 1000, 4096, 8192):
        np.testing.assert_array_equal(searched(values, block), reference)
    # Spikes five in a row or nearly so would be a step; 200 at random in 60 000 hold none.
    np.testing.assert_array_equal(np.flatnonzero(reference), where)


def test_a_spike_within_a_spin_up() -> None:
    ramp = np.clip(np.arange(20_000) - 8000, 0, 2000) * 2000.0
    values = counts(noise(20_000) + ramp)
    values[9000] += 100 * SPIKE
    assert np.flatnonzero(searched(values)).tolist() == [9000]


def test_a_spike_within_a_saturated_stretch_and_a_dead_zone() -> None:
    for level in (0.0, 1e6):
        values = noise(20_000)
        values[8000:12_000] = level
        values = counts(values)
        values[10_000] -= SPIKE
        assert np.flatnonzero(searched(values)).tolist() == [10_000]


def test_a_channel_frozen_but_for_its_spikes() -> None:
    values = np.full(20_000, 123_456, np.int32)
    values[[77, 15_000]] += SPIKE
    assert np.flatnonzero(searched(values)).tolist() == [77, 15_000]


def test_values_in_volts_are_searched_as_counts_are() -> None:
    values = noise(20_000)
    values[[10, 4096]] += SPIKE
    np.testing.assert_array_equal(
        searched(values * 1e-7, floor=FLOOR * 1e-7), searched(counts(values), floor=FLOOR)
    )


# --------------------------------------------------------------------------- what must be left alone


def test_no_false_alarm_in_a_million_normal_samples() -> None:
    assert not searched(counts(noise(1_000_000, seed=11)), 65_536).any()


@pytest.mark.parametrize("step", [1e4, 1e6, 1e9])
@pytest.mark.parametrize("at", [4090, 4096, 7777])
def test_an_edge_between_two_rates(step: float, at: int) -> None:
    values = noise(20_000)
    values[at:] += step
    nothing_in(values)


@pytest.mark.parametrize("length", [3, 10, 100, 1000, 10_000])
def test_a_spin_up_of_any_steepness(length: int) -> None:
    nothing_in(noise(30_000) + np.clip((np.arange(30_000) - 9000) / length, 0, 1) * 7.5e6)


def test_a_long_ramp_and_a_turn() -> None:
    time = np.arange(50_000)
    nothing_in(noise(50_000) + 0.5 * time)
    nothing_in(noise(50_000) + 20_000 * np.sin(time / 300))


@pytest.mark.parametrize("rail", [0.0, 300.0, 600.0, 1000.0])
def test_a_rail_that_clips_part_of_the_noise(rail: float) -> None:
    """Clipped at 0 to 3.3 standard deviations above its mean, in a stretch and at all times."""
    values = noise(40_000)
    nothing_in(np.minimum(values, rail))
    values[10_000:20_000] = np.minimum(values[10_000:20_000], rail)
    nothing_in(values)


def test_a_saturated_stretch() -> None:
    """A rotation beyond the range: the rail for a while, steep edges on both sides."""
    values = noise(40_000) + 8e6 * np.exp(-(((np.arange(40_000) - 20_000) / 4000) ** 2))
    nothing_in(np.minimum(values, 3e6))


@pytest.mark.parametrize("width", [300.0, 900.0, 3000.0, 30_000.0])
def test_a_dead_zone(width: float) -> None:
    """Nought within the zone, unchanged outside; noise comes after it (the order of effects.md)."""
    slow = 1.5 * width * np.sin(np.arange(40_000) / 4000)
    nothing_in(np.where(np.abs(slow) < width, 0.0, slow) + noise(40_000))


@pytest.mark.parametrize("width", [300.0, 900.0])
def test_a_dead_zone_that_noise_reaches_over(width: float) -> None:
    """Noise within the sensor: now and then a sample leaps over the edge. (A lone leap of a zone wider than
    the threshold is a spike by any test.)"""
    values = noise(40_000) + 6000 * np.sin(np.arange(40_000) / 4000)
    nothing_in(np.where(np.abs(values) < width, 0.0, values))


@pytest.mark.parametrize("bits", [4, 8, 10, 12])
def test_lost_bits(bits: int) -> None:
    """Steps of 16 to 4096 counts, the last more than ten times the noise, between which a mean wanders."""
    for mean in (0.0, 1500.0, 2900.0, 3200.0):
        values = counts(noise(40_000) + mean) & ~(2**bits - 1)
        assert not searched(values).any()


def test_a_quiet_and_a_frozen_channel() -> None:
    nothing_in(noise(40_000, sigma=1.0))
    nothing_in(np.full(40_000, 5.0))
    frozen = noise(40_000)
    frozen[9000:12_000] = frozen[9000]
    nothing_in(frozen)


@pytest.mark.parametrize("factor", [2.0, 3.0, 5.0])
@pytest.mark.parametrize("length", [100, 1000, 10_000])
def test_a_burst_of_noise(factor: float, length: int) -> None:
    """At 128 Hz: 0.8 to 80 s of two to five times the noise, wherever the search's pieces lie."""
    for offset in range(0, 128, 8):
        values = noise(30_000, seed=offset)
        values[5000 + offset :][:length] *= factor
        nothing_in(values)


def test_a_level_that_lasts_is_no_spike() -> None:
    """Nine samples or more hold the running median: a step there and back is an edge."""
    values = noise(20_000)
    values[9000:9010] += 1e6
    nothing_in(values)


# ---------------------------------------------------------------------------------------- the parts


def test_robust_scale_is_the_standard_deviation_of_white_noise() -> None:
    """Median of 10^5 differences: good to 0.5 % (standard error 1.17 / sqrt(10^5) or so); 5 of these."""
    assert robust_scale(noise(100_000), 0.0) == pytest.approx(SIGMA, rel=0.025)
    spiked = noise(100_000)
    spiked[::10] += 1e9
    # 20 % of the differences hold a spike: the median moves to the 62.5 % quantile of the rest, 1.31 times.
    assert robust_scale(spiked, 0.0) == pytest.approx(1.31 * SIGMA, rel=0.03)


def test_robust_scale_of_steps_and_of_nothing() -> None:
    assert robust_scale(np.full(100, 7.0), 3.0) == 3.0
    assert robust_scale(np.repeat([0.0, 40.0], 50), 3.0, idle=24.0) == 24.0  # one step in a hundred
    assert robust_scale(np.tile([0.0, 0.0, 8.0], 50), 3.0) == pytest.approx(8.0 / 0.9539, rel=1e-3)


def test_isolated_leaves_edges_alone() -> None:
    values = np.concatenate((np.zeros(50), np.full(50, 10.0)))
    assert not isolated(values, 1.0).any()
    values[[20, 70]] = [5.0, 3.0]
    assert np.flatnonzero(isolated(values, 1.0)).tolist() == [20, 70]


def test_inputs_are_not_changed() -> None:
    values = counts(noise(5000))
    values[100] = SPIKE
    kept = values.copy()
    searched(values)
    np.testing.assert_array_equal(values, kept)


def test_the_scales_of_many_stretches_are_those_of_each() -> None:
    generator = np.random.default_rng(5)
    parts = np.rint(generator.normal(0.0, 3.0, (40, 6, 64))).astype(np.int32)
    parts[3] = 7  # at rest
    parts[4, :, 2:] = 0  # all but at rest
    one_by_one = [[robust_scale(part, 0.5, 4.0) for part in row] for row in parts]
    np.testing.assert_array_equal(robust_scales(parts, 0.5, 4.0), one_by_one)


def test_the_threshold_is_what_it_says() -> None:
    """Values 10 sigma off are themselves scattered by 1 and held against a median scattered by 0.4: with a
    threshold of 8, at best 97 in 100 are found, and at least 90 must be."""
    hits = spikes = 0
    for seed in range(5):
        generator = np.random.default_rng(seed)
        values = generator.normal(0.0, 1.0, (1, 65_536))
        at = np.arange(100, 65_000, 653)
        values[0, at] += 10 * generator.choice([-1, 1], at.size)
        flags = OutlierSearch(8.0, np.array([1e-6])).flags(None, values, None)[0]
        hits += np.count_nonzero(flags[at])
        spikes += at.size
        assert np.count_nonzero(flags) == np.count_nonzero(flags[at])
    assert hits > 0.9 * spikes


# ------------------------------------------------------------------------------- where they are many


@pytest.mark.parametrize("share", [0.15, 0.2, 0.3, 0.4, 0.45])
def test_many_spurious_samples_are_found_among_the_good(share: float) -> None:
    rng = np.random.default_rng(int(100 * share))
    values, struck = counts(noise(20_000)), rng.random(20_000) < share
    values[struck] = rng.integers(-(2**30), 2**30, int(struck.sum()))
    found = dense(values.astype(float), np.diff(values) == 0, THRESHOLD, FLOOR)
    assert found is not None
    # within the threshold of +-2^30, whatever its scale, a spurious count is as good as another
    assert np.count_nonzero(found != struck) <= 2


@pytest.mark.parametrize(
    "values",
    [
        noise(20_000),
        noise(20_000) * np.repeat([1.0, 1000.0], 10_000),  # a burst of noise
        noise(20_000) * np.repeat(np.tile([0.001, 1.0], 50), 200),  # dead by turns
        np.clip(noise(20_000), -SIGMA, SIGMA / 4),  # a rail
        np.rint(noise(20_000) / (3 * SIGMA)) * 3 * SIGMA,  # coarse counts
        noise(20_000)[np.arange(20_000) // 2 * 2],  # repeats
        np.sin(np.arange(20_000) * 0.3) * 100 * SIGMA + noise(20_000),  # a line
        np.where(np.random.default_rng(3).random(20_000) < 0.02, 1e6, noise(20_000)),  # a few spikes
    ],
    ids=["noise", "burst", "dead", "rail", "coarse", "repeats", "line", "few"],
)
def test_what_is_one_noise_at_a_time_holds_no_two_widths(values: np.ndarray) -> None:
    assert dense(values, np.diff(values) == 0, THRESHOLD, 1.0) is None


def test_narrow_scales_are_those_of_the_noise() -> None:
    values = noise(64_000)
    struck = np.random.default_rng(1).random(values.size) < 0.2
    plain, one = narrow_scales(np.abs(np.diff(values))[None])
    spoilt, two = narrow_scales(np.abs(np.diff(np.where(struck, 1e8, values)))[None])
    assert not one.any()
    assert two.all()
    np.testing.assert_allclose(plain, SIGMA, rtol=0.02)
    # of differences, 68 in 100 are noise (or nil between two spikes): their tenth is farther out
    assert SIGMA < spoilt[0] < 2.0 * SIGMA
    assert narrow_scales(np.zeros((2, 8)))[0].tolist() == [0.0, 0.0]
