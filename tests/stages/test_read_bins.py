"""Bins gathered into columns: none lost, means by count, gaps in time left open."""

from __future__ import annotations

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from fogreduce.stages.read_bins import MOST_COLUMNS, columns_of


def noise(m, seed=0):
    generator = np.random.default_rng(seed)
    middle = generator.normal(0, 0.1, m)
    return middle - 1, middle + 1, middle


@settings(max_examples=60, deadline=None)
@given(m=st.integers(1, 4000), seed=st.integers(0, 99), missing=st.floats(0, 0.5))
def test_columns_hold_every_bin(m, seed, missing):
    lowest, highest, mean = noise(m, seed)
    gone = np.random.default_rng(seed + 1).random(m) < missing
    for part in (lowest, highest, mean):
        part[gone] = np.nan
    columns = columns_of(np.arange(m) + 0.5, lowest, highest, mean, np.where(gone, 0.0, 8.0))
    assert columns.time_s.size <= MOST_COLUMNS
    if gone.all():
        assert np.isnan(columns.lowest).all()
        return
    assert np.nanmin(columns.lowest) == np.nanmin(lowest)
    assert np.nanmax(columns.highest) == np.nanmax(highest)
    there = np.isfinite(columns.mean)
    assert (columns.lowest[there] <= columns.mean[there]).all()
    assert (columns.mean[there] <= columns.highest[there]).all()


def test_mean_is_weighted():
    m = 2 * MOST_COLUMNS
    mean, count = np.tile([1.0, 4.0], MOST_COLUMNS), np.tile([3.0, 1.0], MOST_COLUMNS)
    columns = columns_of(np.arange(m) * 1.0, mean, mean, mean, count)
    np.testing.assert_allclose(columns.mean, 1.75)  # (3 x 1 + 1 x 4) / 4


def test_a_gap_in_time_breaks_the_band():
    time_s = np.concatenate((np.arange(50), np.arange(80, 130))) * 1.0
    columns = columns_of(time_s, *noise(100), np.ones(100))
    assert columns.time_s.size == 101
    (broken,) = np.flatnonzero(np.isnan(columns.lowest))
    assert 49 < columns.time_s[broken] < 80
