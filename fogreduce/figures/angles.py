"""Integrated angles and their last seconds (the paper's figures 10 to 13)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from fogreduce.figures import parts
from fogreduce.figures.envelope import thin_line
from fogreduce.figures.results import Results
from fogreduce.plotting import style
from fogreduce.stages.angles import error_angle, measured_error_angle, residual_bins

Array = NDArray[np.float64]

_MEASURED: dict[str, Any] = {"color": style.BAND, "linewidth": 3.5, "solid_capstyle": "butt"}

LAST_S = 20.0  # how much of the run's end the right-hand panels show [s], at most a tenth of the run


def draw(results: Results) -> Figure:
    """A row an axis: angle less the commanded one over the run, and the whole angle in the last seconds."""
    family = results.axes
    assert family is not None
    figure, rows = style.panels(
        results.identity, "Angles: rates integrated from the commanded rate on", 3, 1.95, (2.0, 1.0)
    )
    stop = float(results.segments[-1]["stop_s"])
    start = stop - min(LAST_S, stop / 10)
    signs = results.setup.facts.commanded_signs.tolist()
    times = np.unique(np.concatenate(parts.segment_times(results)))
    for k, (name, sign, (whole, end)) in enumerate(zip(family.names, signs, rows, strict=True)):
        measured_s, measured = measured_errors(results, k)
        whole.plot(*thin_line(measured_s, measured), **_MEASURED)
        error = error_angle(results.segments, name, times)
        whole.plot(times, error, color=style.ADJUSTED, linewidth=1.2)
        whole.axhline(0.0, color=style.COMMAND, linewidth=1.0, dashes=(1, 1.5))
        whole.margins(y=0.08)
        whole.set_title(f"{name} less the commanded angle")
        whole.set_ylabel("angle [deg]")
        if not np.isfinite(error).any():
            style.say_empty(whole, "no fitted curve")
        _draw_end(end, results, name, sign, np.linspace(start, stop, 101), measured_s, measured)
    _say_drifts(results, [row[0] for row in rows], [row[1] for row in rows])
    for axes, span in zip(rows[-1], ((0.0, stop), (start, stop)), strict=True):
        axes.set_xlim(*span)
    rows[-1][0].set_xlabel(style.TIME_LABEL)
    rows[-1][1].set_xlabel("time [s]")
    handles = [
        Line2D([], [], **_MEASURED, label="measured rates, summed"),
        Line2D([], [], color=style.ADJUSTED, linewidth=1.2, label="integral of the offset-adjusted curve"),
        Line2D([], [], color=style.COMMAND, linewidth=1.0, dashes=(1, 1.5), label="commanded"),
    ]
    style.legend(figure, results.identity, handles)
    return figure


def measured_errors(results: Results, axis: int) -> tuple[Array, Array]:
    """Ends of bins [s], and the angle by the measured bins less the commanded one [deg]."""
    family = results.axes
    assert family is not None
    name, segments = family.names[axis], results.segments
    ends = np.minimum(family.time_s + results.bin_s / 2, segments[-1]["stop_s"])
    residual = residual_bins(segments, name, family.time_s, family.mean[axis], results.bin_s, results.guard_s)
    lengths = 2 * np.maximum(ends - family.time_s, 0.0)  # the last bin may hold fewer records
    return ends, measured_error_angle(residual, lengths, error_angle(segments, name, ends))


def _draw_end(
    axes: Axes, results: Results, name: str, sign: float, times: Array, measured_s: Array, measured: Array
) -> None:
    """The whole angle in the last seconds."""
    profile = results.setup.facts.profile

    def commanded(time_s: Array) -> Array:
        return sign * np.degrees(profile.angle_at(time_s)) + 0.0

    inside = measured_s >= times[0] - results.bin_s
    axes.plot(measured_s[inside], measured[inside] + commanded(measured_s[inside]), **_MEASURED)
    curve = error_angle(results.segments, name, times) + commanded(times)
    axes.plot(times, curve, color=style.ADJUSTED, linewidth=1.2)
    axes.plot(times, commanded(times), color=style.COMMAND, linewidth=1.0, dashes=(1, 1.5))
    axes.plot(times[-1:], curve[-1:], "o", color=style.ADJUSTED, markersize=5, clip_on=False, zorder=5)
    axes.margins(y=0.12)
    axes.set_title(f"{name}, the end")
    if not np.isfinite(curve).any():
        style.say_empty(axes, "no fitted curve")


def _say_drifts(results: Results, whole: list[Axes], ends: list[Axes]) -> None:
    """Numbers of drift.csv above the panels: those of the whole run where there are several segments."""
    wanted = "all" if len(results.segments) > 1 else "1"
    # Drift leaves out how far the mean rate is off: the two stand together.
    offsets = {
        (row["axis"], row["segment"]): f", mean rate {float(row['difference_deg_h']):+.3g} deg/h off"
        for row in results.rates
        if row["difference_deg_h"]
    }
    for row in results.drift:
        if row["segment"] != wanted or not row["drift_deg_h"]:
            continue
        k = results.setup.axes.index(row["axis"])
        drift = _with_error(row, "drift_deg_h", "drift_err_coloured_deg_h", "drift_err_deg_h")
        offset = offsets.get((row["axis"], wanted), "")
        style.note(whole[k], f"drift {drift} deg/h{offset}", style.ADJUSTED)
        end = _with_error(row, "final_angle_deg", "accumulated_err_coloured_deg", "accumulated_err_deg")
        style.note(ends[k], f"{end} deg", style.ADJUSTED)


def _with_error(row: Mapping[str, str], value: str, *errors: str) -> str:
    """A value of a table and the first of its standard errors that is there."""
    error = next((row[name] for name in errors if row[name]), "nan")
    return parts.plus_minus(float(row[value]), float(error))
