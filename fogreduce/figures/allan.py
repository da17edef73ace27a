"""Allan deviation of a run's residual bins, with its limits and the noise that was fitted."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from fogreduce.characterise.allan_channel import channel_of
from fogreduce.characterise.allan_figure import LIMITS_LABEL, draw_limits, log_log
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.estimate.coloured import ColouredNoise
from fogreduce.figures.residuals import residuals
from fogreduce.figures.results import Results
from fogreduce.plotting import style
from fogreduce.stages import angles
from fogreduce.stages.read_bins import Family

Array = NDArray[np.float64]

_FEWEST_BINS = 3
_OCTAVES_PART = 8  # of the bins: octaves up to here


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
            _draw_bins(axes, results, family, k, segment, scale) for k, scale in enumerate(scales.tolist())
        ]
        axes.set_title(name)
        axes.set_xlabel("averaging time [s]")
        if any(drawn):
            log_log(axes)
        else:
            axes.set_xticks([])
            style.say_empty(axes, "too few bins")
        axes.legend(loc="upper right", fontsize=8.5)
    row[0].set_ylabel("Allan deviation [deg/h]")
    if len(results.segments) > 1:
        style.note(row[-1], f"segment {segment['segment']}, the longest")
    handles = [
        Line2D([], [], color=style.QUIET, marker="o", linestyle="", label="residual bins"),
        Line2D([], [], color=style.QUIET, linewidth=2.2, label=LIMITS_LABEL),
        Line2D([], [], color=style.QUIET, label="fitted white noise, flicker and random walk"),
    ]
    style.legend(figure, results.identity, handles)
    return figure


def _draw_bins(
    axes: Axes, results: Results, family: Family, channel: int, segment: dict[str, Any], scale: float
) -> bool:
    """Points and model of one channel; False where there are too few bins for either."""
    name = family.names[channel]
    item = angles.channel_of(segment, name)
    inside = (family.time_s >= segment["start_s"]) & (family.time_s < segment["stop_s"])
    color, marker = style.CHANNELS[channel % len(style.CHANNELS)]
    left = scale * residuals(results, family, channel)[inside]
    if item is None or item["noise"] is None or np.count_nonzero(np.isfinite(left)) < _FEWEST_BINS:
        axes.plot([], [], marker, color=color, markersize=4.5, label=f"{name}: too few bins")
        return False
    octaves = max(1, int(math.log2(max(1, left.size // _OCTAVES_PART))) + 1)
    factors = [2**k for k in range(octaves)]
    one = channel_of(name, left, results.bin_s, ("overlapping",), factors, "").deviations["overlapping"]
    draw_limits(axes, one, np.arange(one.tau_s.size), color)
    axes.plot(one.tau_s, one.deviation, marker, color=color, markersize=4.5, label=name)
    fine = np.geomspace(one.tau_s[0], one.tau_s[-1], 60)
    model = scale * np.sqrt(ColouredNoise(**item["noise"]).allan_variance(fine))
    axes.plot(fine, model, color=color, linewidth=1.0)
    return True
