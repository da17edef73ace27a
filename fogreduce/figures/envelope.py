"""A long record as a band: no more points than a screen has columns, and no extreme lost.

A spike must neither vanish nor squash the scale: the range comes from the bulk of the bins, and what lies
beyond is marked at the edge and counted.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from fogreduce.plotting import style
from fogreduce.stages.read_bins import MOST_COLUMNS, Columns

Array = NDArray[np.float64]

_BULK = 2.0  # percent of the bins that may lie outside the bulk, on either side
BEYOND_BULK = 0.4
_MARGIN = 0.04


def thin_line(time_s: Array, values: Array) -> tuple[Array, Array]:
    """A line of at most twice `MOST_COLUMNS` points that keeps the extremes of every stretch."""
    if time_s.size <= 2 * MOST_COLUMNS:
        return time_s, values
    kept = [0, time_s.size - 1]
    for part in np.array_split(np.arange(time_s.size), MOST_COLUMNS - 1):
        inside = values[part]
        if np.isfinite(inside).any():
            kept += [int(part[np.nanargmin(inside)]), int(part[np.nanargmax(inside)])]
        else:
            kept.append(int(part[0]))
    index = np.unique(kept)
    return time_s[index], values[index]


def bulk_range(
    lowest: Array, highest: Array, *curves: Array, reach: float = BEYOND_BULK
) -> tuple[float, float]:
    """Range of values that shows the bulk of the bins and all of the curves (NaN = not there).

    `reach` is how far it may go beyond the bulk to show what lies there, in widths of the bulk.
    """
    low, high = (
        float(np.percentile(part[np.isfinite(part)], percent)) if np.isfinite(part).any() else np.nan
        for part, percent in ((lowest, _BULK), (highest, 100 - _BULK))
    )
    width = high - low
    low = float(np.fmax(low - reach * width, np.fmin.reduce(lowest, initial=np.nan)))
    high = float(np.fmin(high + reach * width, np.fmax.reduce(highest, initial=np.nan)))
    for part in curves:
        low = float(np.fmin(low, np.fmin.reduce(part, initial=np.nan)))
        high = float(np.fmax(high, np.fmax.reduce(part, initial=np.nan)))
    if np.isnan(low):
        return 0.0, 1.0
    margin = _MARGIN * (high - low) or 0.5 * (abs(high) or 1.0)
    return low - margin, high + margin


def draw_band(axes: Axes, columns: Columns, scale: float = 1.0) -> None:
    """Band and mean line (above curves), `scale` times the values; the axes' range must be set before.

    What lies far outside the range is drawn as a stroke to beyond the edge: a renderer need not cope with
    coordinates a million times the picture's size.
    """
    low, high = axes.get_ylim()
    height = high - low
    bottom, top = (
        np.clip(part * scale, low - height, high + height) for part in (columns.lowest, columns.highest)
    )
    axes.fill_between(columns.time_s, bottom, top, facecolor=style.BAND, edgecolor=style.BAND, linewidth=0.6)
    axes.plot(columns.time_s, columns.mean * scale, color=style.MEAN, linewidth=0.8, zorder=3)


def mark_beyond(
    axes: Axes,
    columns: Columns,
    lowest: Array,
    highest: Array,
    scale: float,
    quantity: Callable[[float], str],
) -> str:
    """Mark what lies beyond the axes' range at the edge; how many bins do, and how far, as text.

    `quantity` puts a value (not scaled) into words with its unit.
    """
    low, high = axes.get_ylim()
    texts = []
    for part, bins, sign, edge, marker, arrow in (
        (columns.highest, highest, 1, high, "^", "▲"),
        (columns.lowest, lowest, -1, low, "v", "▼"),
    ):
        beyond = sign * part * scale > sign * edge
        if not beyond.any():
            continue
        times = columns.time_s[beyond]
        axes.plot(
            times,
            np.full(times.size, edge),
            marker,
            color=style.SPIKE,
            markersize=5,
            clip_on=False,
            zorder=5,
        )
        number = int(np.count_nonzero(sign * bins * scale > sign * edge))
        furthest = quantity(float(np.nanmax(sign * bins)) * sign)
        texts.append(f"{arrow} {number} {'bin' if number == 1 else 'bins'} beyond, to {furthest}")
    return "    ".join(texts)
