"""Rates x, y, z less Earth's part, with fitted and offset-adjusted curve (the paper's figures 7 to 9)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from fogreduce.figures import parts
from fogreduce.figures.envelope import bulk_range, draw_band, mark_beyond
from fogreduce.figures.results import Results
from fogreduce.plotting import style
from fogreduce.stages.angles import fitted_curve
from fogreduce.stages.drift import adjusted_curve

Array = NDArray[np.float64]

_FITTED: dict[str, Any] = {"color": style.CURVE, "linewidth": 2.6}
_ADJUSTED: dict[str, Any] = {"color": style.ADJUSTED, "linewidth": 1.4, "dashes": (5, 2)}
_COMMANDED: dict[str, Any] = {"color": style.COMMAND, "linewidth": 1.0, "dashes": (1, 1.5)}


def draw(results: Results) -> Figure:
    """A panel an axis: lowest to highest sample, means of bins, both curves, the commanded rate."""
    names = results.setup.axes
    figure, rows = style.panels(results.identity, "Rates about x, y, z without Earth's rate", len(names), 2.0)
    unstable = [draw_axis(axes, results, k) for k, (axes,) in enumerate(rows)]
    last = rows[-1][0]
    last.set_xlim(*results.span_s)
    last.set_xlabel(style.TIME_LABEL)
    shaded = [parts.unstable_handle()] if any(unstable) else []
    style.legend(figure, results.identity, [*handles(), *shaded])
    return figure


def draw_axis(axes: Axes, results: Results, k: int) -> bool:
    """Draw axis k of x, y, z; whether an unstable interval was shaded."""
    family = results.axes
    assert family is not None
    name, sign = family.names[k], float(results.setup.facts.commanded_signs[k])

    def adjusted(segment: Mapping[str, Any], item: Mapping[str, Any], time_s: Array) -> Array:
        return adjusted_curve(segment, item, sign * segment["rate_deg_s"], time_s)

    time_s, fitted = parts.curves(results, name, lambda _, item, time: fitted_curve(item, time))
    _, moved = parts.curves(results, name, adjusted)
    lowest, highest, columns = family.lowest[k], family.highest[k], family.columns(k)
    axes.set_ylim(*bulk_range(lowest, highest, fitted, moved))
    shaded = parts.shade_unstable(axes, results, results.gyros.names)
    draw_band(axes, columns)
    axes.plot(time_s, fitted, **_FITTED)
    axes.plot(time_s, moved, **_ADJUSTED)
    for segment in results.segments:
        commanded = sign * segment["rate_deg_s"] + 0.0
        axes.plot([segment["start_s"], segment["stop_s"]], [commanded] * 2, **_COMMANDED)
    axes.set_title(name)
    style.note(axes, mark_beyond(axes, columns, lowest, highest, 1.0, _rate), style.SPIKE)
    axes.set_ylabel("rate [deg/s]")
    if not np.isfinite(family.mean[k]).any():
        style.say_empty(axes, "no record in which every gyro has a usable value")
    return shaded


def handles() -> list[Artist]:
    """Legend of a panel."""
    return [
        *parts.band_handles("lowest to highest", "mean"),
        Line2D([], [], **_FITTED, label="fitted curve"),
        Line2D([], [], **_ADJUSTED, label="offset adjusted"),
        Line2D([], [], **_COMMANDED, label="commanded"),
    ]


def _rate(value: float) -> str:
    return f"{parts.plain(value)} deg/s"
