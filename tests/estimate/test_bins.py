"""Bins: against sums bin by bin, and an envelope that hides nothing."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.estimate.bins import MOST_BINS, Bins, bin_size, bins_of


def bin_by_bin(time_s: np.ndarray, values: np.ndarray, usable: np.ndarray, size: int) -> list[np.ndarray]:
    """time, count, mean, scatter, lowest, highest, the slow way."""
    rows = []
    for start in range(0, time_s.size, size):
        part = slice(start, start + size)
        here = []
        for channel in range(len(values)):
            good = values[channel, part][usable[channel, part]]
            there = values[channel, part][~np.isnan(values[channel, part])]
            here.append(
                [
                    good.size,
                    good.mean() if good.size else np.nan,
                    good.std(ddof=1) if good.size > 1 else np.nan,
                    there.min() if there.size else np.nan,
                    there.max() if there.size else np.nan,
                ]
            )
        rows.append((time_s[part].mean(), np.array(here).T))
    return [np.array([time for time, _ in rows]), *np.array([row for _, row in rows]).transpose(1, 2, 0)]


@pytest.mark.parametrize("size", [1, 7, 64, 500])
def test_against_sums_bin_by_bin(size: int) -> None:
    generator = np.random.default_rng(1)
    time_s = np.arange(1000) / 64
    values = generator.normal(5.0, 1.0, (3, 1000))
    usable = generator.random(values.shape) > 0.05
    values[0, generator.random(1000) < 0.03] = np.nan
    usable &= ~np.isnan(values)
    usable[1, 128:256] = False  # whole bins without a usable value
    values[2, 300:400] = np.nan
    usable[2, 300:400] = False
    bins = bins_of(time_s, values, usable, size)
    expected = bin_by_bin(time_s, values, usable, size)
    for name, wanted in zip(
        ("time_s", "count", "mean", "scatter", "lowest", "highest"), expected, strict=True
    ):
        np.testing.assert_allclose(getattr(bins, name), wanted, rtol=1e-12, atol=1e-12, err_msg=name)


def test_all_usable_is_the_same_as_no_mask() -> None:
    time_s, values = np.arange(300.0), np.random.default_rng(2).normal(size=(2, 300))
    plain, masked = (
        bins_of(time_s, values, None, 64),
        bins_of(time_s, values, np.ones(values.shape, bool), 64),
    )
    for name in ("time_s", "count", "mean", "scatter", "lowest", "highest"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(masked, name))


def test_the_envelope_shows_a_spike_that_the_mean_leaves_out() -> None:
    values = np.zeros((1, 128))
    usable = np.ones(values.shape, bool)
    values[0, 77], usable[0, 77] = 1e9, False
    bins = bins_of(np.arange(128.0), values, usable, 128)
    assert (bins.mean[0, 0], bins.highest[0, 0], bins.count[0, 0]) == (0.0, 1e9, 127)


def test_a_small_scatter_on_a_large_mean() -> None:
    """1e-6 on 1: squares summed would keep four digits, differences from the mean keep ten."""
    values = 1.0 + 1e-6 * np.random.default_rng(3).normal(size=(1, 4096))
    bins = bins_of(np.arange(4096.0), values, None, 4096)
    assert bins.scatter[0, 0] == pytest.approx(np.std(values - 1.0, ddof=1), rel=1e-9)


def test_blocks_joined_are_the_whole() -> None:
    time_s, values = np.arange(1024.0), np.random.default_rng(4).normal(size=(2, 1024))
    whole = bins_of(time_s, values, None, 64)
    parts = [bins_of(time_s[k : k + 256], values[:, k : k + 256], None, 64) for k in range(0, 1024, 256)]
    joined = Bins.joined(parts)
    np.testing.assert_array_equal(joined.mean, whole.mean)
    np.testing.assert_array_equal(joined.time_s, whole.time_s)
    stacked = whole.stacked(joined)
    assert stacked.mean.shape == (4, 16)


@pytest.mark.parametrize("records", [10, 1000, 19_200, 768_000, 7_680_000, 10**9])
@pytest.mark.parametrize("rate", [1.0, 64.0, 128.0, 10_000.0])
def test_size_of_a_bin(records: int, rate: float) -> None:
    """A power of two; not more than the most bins (as far as the block allows), and a second or so in
    between."""
    size = bin_size(records, rate, 65_536)
    assert size & (size - 1) == 0
    assert records / size <= MOST_BINS or size == 65_536
    if 512 <= records / rate <= 8192:
        assert 0.7 <= size / rate <= 1.42


def test_inputs_are_not_changed() -> None:
    values = np.array([[1.0, np.nan, 3.0, 4.0]])
    usable = ~np.isnan(values)
    bins_of(np.arange(4.0), values, usable, 2)
    np.testing.assert_array_equal(values, [[1.0, np.nan, 3.0, 4.0]])
    np.testing.assert_array_equal(usable, [[True, False, True, True]])
