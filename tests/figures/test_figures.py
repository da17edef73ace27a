"""What stands in the figures of a run: who it is, how many panels, and curves that are the fits' own."""

from __future__ import annotations

import csv
import dataclasses
import math

import numpy as np
import published_drift
import pytest
from matplotlib.figure import Figure

from fogreduce.figures import (
    allan,
    angles,
    encoder,
    flags,
    gyro_raw,
    rates,
    residuals,
)
from fogreduce.figures.catalogue import STEMS, plan
from fogreduce.plotting import style

BINS = ("mean", "lowest", "highest", "count")
LABEL = "made up for a test"

#: Panels of each figure for a unit of four gyros.
PANELS = {
    "gyro_volts": 4,
    "rates": 3,
    "angles": 6,
    "residuals_gyros": 4,
    "residuals_axes": 3,
    "allan": 2,
    "temperature": 2,
    "encoder": 1,
    "flags": 1,
}


@pytest.fixture(scope="module")
def drawn(campaign, results) -> dict[str, Figure]:
    """All figures of the run with spikes and logs."""
    planned = plan(results("spiked"), campaign / "campaign" / "runs" / "spiked")
    assert planned.left_out == {}
    with style.style():
        return {stem: draw() for stem, draw in planned.drawn.items()}


def rows_of(campaign, run, table):
    with (campaign / "results" / run / "tables" / f"{table}.csv").open() as file:
        return list(csv.DictReader(file))


def line(axes, color):
    """The first line of a colour in a panel, (times, values)."""
    return next(item for item in axes.lines if item.get_color() == color).get_data()


def test_every_figure_says_where_it_comes_from(drawn, results):
    assert tuple(drawn) == STEMS
    version = results("spiked").setup.version_id
    for stem, figure in drawn.items():
        texts = [text.get_text() for text in figure.texts]
        assert any("campaign / spiked" in text for text in texts), stem
        assert any(version in text for text in texts), stem
        assert LABEL in texts, stem
        assert any(text.get_fontweight() == "bold" and text.get_text() == LABEL for text in figure.texts)


def test_panels_and_units(drawn):
    assert {stem: len(figure.axes) for stem, figure in drawn.items()} == PANELS
    for stem, figure in drawn.items():
        bottom = min(figure.axes, key=lambda axes: axes.get_position().y0)
        assert bottom.get_xlabel(), stem
        if stem != "flags":
            assert any("[" in axes.get_ylabel() for axes in figure.axes), stem


def test_curve_of_volts_is_the_tables_formula(campaign, drawn):
    for row, axes in zip(rows_of(campaign, "spiked", "gyro_fit"), drawn["gyro_volts"].axes, strict=True):
        a, p, q, c, e = (float(row[name]) for name in ("a_V", "p_V", "q_V", "c_rad_s", "e_V_s"))
        time_s, values = line(axes, style.CURVE)
        there = np.isfinite(values)
        time_s, values = time_s[there], values[there]
        assert (time_s[0], time_s[-1]) == (0.0, 600.0)
        expected = [a + p * math.cos(c * t) + q * math.sin(c * t) + e * t for t in time_s]
        scale = {"volts [V]": 1.0, "volts [mV]": 1e3, "volts [µV]": 1e6}[axes.get_ylabel()]
        np.testing.assert_allclose(values / scale, expected, rtol=1e-9, atol=1e-12)


def test_adjusted_curve_starts_at_the_commanded_rate(results):
    figure = rates.draw(results("steps"))
    for axes, sign in zip(figure.axes, (-1, 0, 0), strict=True):  # frame_signs[0] is -1, the table's axis x
        time_s, values = line(axes, style.ADJUSTED)
        for start, rate in ((0.0, 0.0), (60.0, 5.0), (180.0, -2.0)):
            # the last of the points at an edge begins the new segment
            first = np.flatnonzero((time_s == start) & np.isfinite(values))[-1]
            assert values[first] == pytest.approx(sign * rate, abs=1e-12)


@pytest.mark.parametrize("run", ["spiked", "steps"])
def test_angles_end_where_the_drift_table_ends(campaign, results, run):
    rows = rows_of(campaign, run, "drift")
    wanted = "all" if run == "steps" else "1"
    figure = angles.draw(results(run))
    for k, axis in enumerate("xyz"):
        (row,) = [row for row in rows if row["axis"] == axis and row["segment"] == wanted]
        whole, end = figure.axes[2 * k : 2 * k + 2]
        _, error = line(whole, style.ADJUSTED)
        assert error[0] == 0
        assert error[-1] == pytest.approx(float(row["accumulated_error_deg"]), rel=1e-9, abs=1e-12)
        _, angle = line(end, style.ADJUSTED)
        assert angle[-1] == pytest.approx(float(row["final_angle_deg"]), rel=1e-9, abs=1e-12)
        (rate,) = [
            row for row in rows_of(campaign, run, "rates") if row["axis"] == axis and row["segment"] == wanted
        ]
        said = f"mean rate {float(rate['difference_deg_h']):+.3g} deg/h off"
        assert said in whole.get_title(loc="right")


def test_measured_angle_ends_at_the_curves(results):
    # Residuals of a least-squares fit that has a constant sum to zero over each segment; a few bins at edges
    # and the uneven number of records in the last bin leave a little: one bin's noise at most.
    run = results("spiked")
    for axis in range(3):
        _, measured = angles.measured_errors(run, axis)
        curve = angles.error_angle(run.segments, run.axes.names[axis], np.array([600.0]))
        assert measured[-1] == pytest.approx(curve[0], abs=1e-3 * run.bin_s)


def test_unstable_intervals_are_shaded(results):
    run = results("spiked")
    fits = dict(run.fits) | {
        "unstable": [
            {"gyro": "gyro2", "start_s": 100.0, "stop_s": 150.0, "noise_ratio": 2.0},
            {"gyro": "gyro3", "start_s": 140.0, "stop_s": 170.0, "noise_ratio": 2.0},
        ]
    }
    changed = type(run)(run.setup, run.gyros, run.axes, fits, run.ingest, run.drift, run.rates)

    def shaded(axes):
        return [
            (patch.get_x(), patch.get_x() + patch.get_width())
            for patch in axes.patches
            if patch.get_facecolor()[:3] == pytest.approx((0xF4 / 255, 0xE3 / 255, 0xAE / 255))
        ]

    volts = gyro_raw.draw(changed)
    assert [shaded(axes) for axes in volts.axes] == [[], [(100, 150)], [(140, 170)], []]
    assert [shaded(axes) for axes in rates.draw(changed).axes] == [[(100, 170)]] * 3
    assert "unstable" in [text.get_text() for text in volts.legends[0].texts]


def test_residuals_scatter_as_white_noise_says(results):
    # The simulated noise is white but for a little flicker: bins scatter by sigma / sqrt(records in a bin),
    # to a twentieth for some 500 bins (1 / sqrt(2 x 500) is 3 %), twice that allowed.
    run = results("spiked")
    for k, name in enumerate(run.gyros.names):
        left = residuals.residuals(run, run.gyros, k)
        expected = residuals.white_of_bins(run, name)[0]
        assert np.nanstd(left) == pytest.approx(expected, rel=0.12)


def test_residuals_leave_out_bins_at_edges(results):
    run = results("steps")
    left = residuals.residuals(run, run.gyros, 0)
    near = np.min(np.abs(run.gyros.time_s[:, None] - [60.0, 180.0]), axis=1)
    assert np.isnan(left[near < run.guard_s]).all()
    assert np.isfinite(left[near > run.guard_s + run.bin_s]).all()


def test_allan_draws_points_and_model_of_every_channel(results):
    figure = allan.draw(results("spiked"))
    for axes, names in zip(figure.axes, (["gyro1", "gyro2", "gyro3", "gyro4"], ["x", "y", "z"]), strict=True):
        assert [text.get_text() for text in axes.get_legend().texts] == names
        assert len(axes.lines) == 2 * len(names)
        for points, model in zip(axes.lines[::2], axes.lines[1::2], strict=True):
            assert model.get_xdata()[0] == pytest.approx(points.get_xdata()[0])
            assert (np.asarray(points.get_ydata()) > 0).all()


def test_encoder_less_command_is_what_was_put_in(drawn):
    (axes,) = drawn["encoder"].axes
    time_s, values = axes.lines[0].get_data()
    np.testing.assert_allclose(values, 2.0 * np.sin(time_s / 9), atol=1e-5)  # mdeg; the log has nine decimals


def test_encoder_is_counted_from_the_runs_start(results):
    from fogreduce.datasets.logs import TableLog

    time_s = np.arange(-2.0, 10.0, 0.5)
    log = TableLog(time_s, 100.0 + 0.6 * (time_s + 2))  # turns before the command does
    departure = encoder.encoder_less_command(results("spiked"), log)
    np.testing.assert_allclose(departure[time_s >= 0], 0.0, atol=1e-9)


def test_flags_are_those_of_the_report(drawn, results):
    counts = flags.counts_of(results("spiked"))
    assert counts["gyro2 spurious"] == 3
    assert counts["gyro4 spurious"] == 1
    assert counts["lost"] == counts["repeated"] == counts["gyro1 missing"] == 0
    (axes,) = drawn["flags"].axes
    assert [text.get_text() for text in axes.texts] == [f"{count:,}" for count in counts.values()]


def test_units_of_one_and_two_gyros_lack_x_y_z(campaign, results):
    for run, n in (("one", 1), ("two", 2)):
        assert rows_of(campaign, run, "rate_fit") == []
        planned = plan(results(run), None)
        assert {"rates", "angles", "residuals_axes"} <= set(planned.left_out)
        assert "one or two gyros" in planned.left_out["rates"]
        figures = {stem: draw() for stem, draw in planned.drawn.items()}
        assert list(figures) == ["gyro_volts", "residuals_gyros", "allan", "flags"]
        assert [len(figures[stem].axes) for stem in figures] == [n, n, 1, 1]


def test_logs_need_the_runs_folder(results):
    left_out = plan(results("spiked"), None).left_out
    assert set(left_out) == {"temperature", "encoder"}
    assert "--run" in left_out["temperature"]


def test_a_gyro_that_never_answered_leaves_its_panels_empty(results):
    run = results("spiked")
    silent = dataclasses.replace(run.gyros, **{name: getattr(run.gyros, name).copy() for name in BINS})
    for name in BINS:
        getattr(silent, name)[2] = 0.0 if name == "count" else np.nan
    without = [None if item["channel"] == "gyro3" else item for item in run.segments[0]["channels"]]
    fits = dict(run.fits) | {"segments": [dict(run.segments[0]) | {"channels": without}]}
    changed = dataclasses.replace(run, gyros=silent, fits=fits)
    for draw in (gyro_raw.draw, residuals.draw_gyros):
        said = [[text.get_text() for text in axes.texts] for axes in draw(changed).axes]
        assert [bool(texts) for texts in said] == [False, False, True, False]
        assert said[2][0].startswith("no ")
    legend = [text.get_text() for text in allan.draw(changed).axes[0].get_legend().texts]
    assert legend == ["gyro1", "gyro2", "gyro3: too few bins", "gyro4"]
    # The silent gyro's panel does not change the others' unit.
    assert gyro_raw.draw(changed).axes[0].get_ylabel() == gyro_raw.draw(run).axes[0].get_ylabel()


def test_a_capture_that_ends_early_has_no_curve_beyond_its_end(results):
    run = results("spiked")
    cut = {name: getattr(run.gyros, name)[..., :100] for name in ("time_s", *BINS)}
    changed = dataclasses.replace(run, gyros=dataclasses.replace(run.gyros, **cut))
    for axes in gyro_raw.draw(changed).axes:
        time_s, _ = line(axes, style.CURVE)
        assert time_s.max() <= cut["time_s"][-1] + run.bin_s


def test_picture_of_the_readme_carries_the_label(results):
    figure = published_drift.draw(results("spiked"))
    assert LABEL in [text.get_text() for text in figure.texts]
    assert len(figure.axes) == 2
