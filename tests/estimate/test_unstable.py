"""Intervals in which a gyro is unstable: found where they are, and nowhere else."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.estimate.bins import bins_of
from fogreduce.estimate.unstable import Unstable, unstable_intervals

RATE_HZ = 128
THRESHOLD, SHORTEST_S = 1.25, 10.0  # the configuration's defaults


def search(values: np.ndarray, usable: np.ndarray | None = None, bin_records: int = 128) -> list[Unstable]:
    time_s = np.arange(values.shape[1]) / RATE_HZ
    bins = bins_of(time_s, values, usable, bin_records)
    return unstable_intervals(bins.time_s, bins.count, bins.scatter, THRESHOLD, SHORTEST_S)


def noise(duration_s: float, seed: int, gyros: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).normal(0.0, 300.0, (gyros, int(duration_s * RATE_HZ)))


def louder(values: np.ndarray, gyro: int, start_s: float, stop_s: float, factor: float) -> None:
    values[gyro, int(start_s * RATE_HZ) : int(stop_s * RATE_HZ)] *= factor


@pytest.mark.parametrize("factor", [1.5, 2.0, 5.0])
def test_the_papers_interval_is_found_in_its_gyros(factor: float) -> None:
    """5600 to 5800 s on gyros 1 to 3 of 4; edges are promised to half a window of ten bins of 1 s."""
    values = noise(6000, 1, 4)
    for gyro in (0, 1, 2):
        louder(values, gyro, 5600, 5800, factor)
    found = search(values)
    assert [item.gyro for item in found] == [0, 1, 2]
    for item in found:
        assert item.start_s == pytest.approx(5600, abs=6)
        assert item.stop_s == pytest.approx(5800, abs=6)
        # A few quiet bins at either edge are counted in: 5 % of the interval.
        assert item.noise_ratio == pytest.approx(factor, rel=0.06)


@pytest.mark.parametrize("seed", range(5))
def test_nothing_is_found_in_plain_noise(seed: int) -> None:
    assert search(noise(6000, 100 + seed, 4)) == []


def test_nothing_is_found_in_a_slow_turn_or_a_drift() -> None:
    """Scatter is about each bin's mean: 7 mV/h and Earth's sine move a count or two within a second."""
    values = noise(3000, 7)
    time_s = np.arange(values.shape[1]) / RATE_HZ
    assert search(values + 20 * time_s + 3000 * np.sin(time_s / 955)) == []


@pytest.mark.parametrize(("length_s", "found"), [(3.0, 0), (60.0, 1)])
def test_a_burst_shorter_than_the_shortest_interval_does_not_count(length_s: float, found: int) -> None:
    """Three seconds at 1.4 times the noise fill a third of the window: 1.14 of it, below the threshold."""
    values = noise(2000, 9)
    louder(values, 0, 1000, 1000 + length_s, 1.4)
    assert len(search(values)) == found


@pytest.mark.parametrize(("start", "stop"), [(0, 100), (1900, 2000)])
def test_intervals_at_the_records_ends(start: float, stop: float) -> None:
    values = noise(2000, 10)
    louder(values, 0, start, stop, 2.0)
    (item,) = search(values)
    assert item.start_s == pytest.approx(start, abs=6)
    assert item.stop_s == pytest.approx(stop, abs=6)
    assert 0 <= item.start_s < item.stop_s <= 2000 + 1e-9


def test_two_intervals_far_apart_are_two() -> None:
    values = noise(3000, 11)
    louder(values, 0, 500, 600, 2.0)
    louder(values, 0, 2000, 2100, 2.0)
    assert [round(item.start_s, -2) for item in search(values)] == [500, 2000]


def test_samples_left_out_do_not_make_a_gyro_unstable() -> None:
    """Spurious counts, flagged; and a minute without any answer."""
    values = noise(1000, 12)
    usable = np.ones(values.shape, bool)
    where = np.random.default_rng(13).choice(values.shape[1], 200)
    values[0, where] = 1e9
    usable[0, where] = False
    gone = slice(300 * RATE_HZ, 360 * RATE_HZ)
    values[0, gone], usable[0, gone] = np.nan, False
    assert search(values, usable) == []


def test_a_gyro_without_noise_or_answers_is_passed_over() -> None:
    values = noise(500, 14, 3)
    values[0], values[1] = 5.0, np.nan
    usable = ~np.isnan(values)
    louder(values, 2, 100, 200, 2.0)
    assert [item.gyro for item in search(values, usable)] == [2]


def test_a_record_of_a_few_bins_is_not_judged() -> None:
    assert search(noise(3, 15)) == []
