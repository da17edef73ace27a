"""Allan deviation of the residuals, with the white noise, flicker and random walk that describe it."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.estimate.coloured import ColouredNoise, allan_variance
from fogreduce.figures import style
from fogreduce.figures.residuals import residuals
from fogreduce.figures.results import Family, Results
from fogreduce.stages.angles import channel_of


def draw(results: Results) -> Figure:
    """Gyros (raw readings over scale factor) and axes side by side, of the longest segment, in deg/h."""
    segment = max(results.segments, key=lambda item: float(item["stop_s"] - item["start_s"]))
    quantity = results.setup.facts.raw_unit.quantity
    families = [(f"gyros ({quantity} over scale factor)", results.gyros)]
    if results.axes is not None:
        families.append(("x, y, z", results.axes))
    title = "Allan deviation of the residuals"
    figure, (row,) = style.panels(results.identity, title, 1, 4.1, (1.0,) * len(families))
    per_reading = SECONDS_PER_HOUR / np.abs(results.setup.facts.scale_factor)
    for axes, (name, family) in zip(row, families, strict=True):
        scales = per_reading if family is results.gyros else np.full(3, SECONDS_PER_HOUR)
        drawn = [
            _draw_channel(axes, results, family, k, segment, scale) for k, scale in enumerate(scales.tolist())
        ]
        axes.set_title(name)
        axes.set_xlabel("averaging time [s]")
        if any(drawn):
            _log_log(axes)
        else:
            axes.set_xticks([])
            style.say_empty(axes, "too few bins")
        axes.legend(loc="upper right", fontsize=8.5)
    row[0].set_ylabel("Allan deviation [deg/h]")
    if len(results.segments) > 1:
        style.note(row[-1], f"segment {segment['segment']}, the longest")
    handles = [
        Line2D([], [], color=style.QUIET, marker="o", linestyle="", label="residual bins, ± one sigma"),
        Line2D([], [], color=style.QUIET, label="fitted white noise, flicker and random walk"),
    ]
    style.legend(figure, results.identity, handles)
    return figure


def _draw_channel(
    axes: Axes, results: Results, family: Family, channel: int, segment: dict[str, Any], scale: float
) -> bool:
    """Points and model of one channel; False where there are too few bins for either."""
    name = family.names[channel]
    item = channel_of(segment, name)
    inside = (family.time_s >= segment["start_s"]) & (family.time_s < segment["stop_s"])
    color, marker = style.CHANNELS[channel % len(style.CHANNELS)]
    left = residuals(results, family, channel)[inside]
    if item is None or item["noise"] is None or left.size < 3:
        axes.plot([], [], marker, color=color, markersize=4.5, label=f"{name}: too few bins")
        return False
    tau, variance, freedom = allan_variance(left, results.bin_s)
    deviation = scale * np.sqrt(variance)
    error = deviation / np.sqrt(2 * freedom)
    axes.vlines(
        tau, np.maximum(deviation - error, deviation / 10), deviation + error, color=color, linewidth=1
    )
    axes.plot(tau, deviation, marker, color=color, markersize=4.5, label=name)
    fine = np.geomspace(tau[0], tau[-1], 60)
    model = scale * np.sqrt(ColouredNoise(**item["noise"]).allan_variance(fine))
    axes.plot(fine, model, color=color, linewidth=1.0)
    return True


def _log_log(axes: Axes) -> None:
    """Both scales logarithmic, with plain numbers at 1, 2 and 5 of every decade that is short of ticks."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.margins(x=0.04)
    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        subs = (1.0,) if high / low > 300 else (1.0, 2.0, 5.0)
        axis.set_major_locator(LogLocator(subs=subs, numticks=20))
        axis.set_minor_locator(NullLocator())
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
