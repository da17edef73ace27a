"""The envelope loses no spike and is not squashed by one."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.figures import gyro_raw
from fogreduce.figures.envelope import bulk_range, thin_line
from fogreduce.plotting import style
from fogreduce.stages.read_bins import MOST_COLUMNS

from .conftest import SPIKES


def noise(m, seed=0):
    generator = np.random.default_rng(seed)
    middle = generator.normal(0, 0.1, m)
    return middle - 1, middle + 1, middle


def test_a_spike_does_not_squash_the_scale():
    lowest, highest, _ = noise(1000)
    quiet = bulk_range(lowest, highest)
    highest[500] = 1e6
    low, high = bulk_range(lowest, highest)
    assert low == pytest.approx(quiet[0], abs=0.2)
    assert high < 2 * quiet[1]
    curve = np.array([7.0, np.nan])
    assert bulk_range(lowest, highest, curve)[1] > 7.0


def test_range_without_spikes_shows_everything():
    lowest, highest, _ = noise(1000)
    low, high = bulk_range(lowest, highest)
    assert low < lowest.min()
    assert high > highest.max()


def test_range_of_nothing_and_of_a_constant():
    none = np.full(5, np.nan)
    assert bulk_range(none, none) == (0.0, 1.0)
    for value in (0.0, -3.0):
        low, high = bulk_range(np.full(5, value), np.full(5, value))
        assert low < value < high


def test_spikes_are_marked_and_counted(results):
    run = results("spiked")
    figure = gyro_raw.draw(run)
    for gyro, axes in enumerate(figure.axes):
        low, high = axes.get_ylim()
        assert high - low < 100  # mV: the spikes reach to 9 V
        marks = {
            item.get_marker(): item.get_xdata() for item in axes.lines if item.get_color() == style.SPIKE
        }
        above = [record / 16 for record, where, counts in SPIKES if where == gyro and counts > 0]
        below = [record / 16 for record, where, counts in SPIKES if where == gyro and counts < 0]
        np.testing.assert_allclose(marks.get("^", []), above, atol=run.bin_s)
        np.testing.assert_allclose(marks.get("v", []), below, atol=run.bin_s)
        note = axes.get_title(loc="right")
        assert (f"▲ {len(above)} bin" in note) == bool(above)
        assert (f"▼ {len(below)} bin" in note) == bool(below)
    furthest = figure.axes[1].get_title(loc="right").split("to ")[1].split()
    assert furthest[1] == "V"
    assert float(furthest[0]) == pytest.approx(9.0, abs=0.1)  # 9e7 counts of 1e-7 V on some mV


def test_the_band_reaches_past_the_edge_at_a_spike(results):
    run = results("spiked")
    axes = gyro_raw.draw(run).axes[1]
    (band,) = axes.collections
    points = np.concatenate([path.vertices for path in band.get_paths()])
    low, high = axes.get_ylim()
    at_spike = points[np.abs(points[:, 0] - 700 / 16) < run.bin_s]
    assert at_spike[:, 1].max() > high
    # Clipped: not a million pixels off the paper.
    assert np.abs(points[:, 1] - low).max() <= 2.001 * (high - low)
    assert len(points) < 2 * MOST_COLUMNS + 16


def test_thin_line_keeps_extremes():
    values = np.random.default_rng(3).normal(size=50_000)
    time_s = np.arange(values.size) * 1.0
    thin_s, thin = thin_line(time_s, values)
    assert thin.size <= 2 * MOST_COLUMNS
    assert (np.diff(thin_s) > 0).all()
    assert (thin.min(), thin.max()) == (values.min(), values.max())
    assert (thin_s[0], thin_s[-1]) == (0.0, 49_999.0)
    assert thin_line(time_s[:10], values[:10])[1].size == 10
