"""What the fitted curves leave of gyros and axes, in bins, with what white noise alone would leave."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.figures import parts
from fogreduce.figures.envelope import bulk_range, draw_band, mark_beyond
from fogreduce.figures.results import Results
from fogreduce.plotting import style
from fogreduce.stages.angles import channel_of, residual_bins
from fogreduce.stages.read_bins import Family, columns_of

Array = NDArray[np.float64]

WHITE_SIGMAS = 2.0
_REACH = 1.5  # bins are means without spurious samples: more of them is worth seeing


def draw_gyros(results: Results) -> Figure:
    """A panel a gyro, in microvolts or in what reads well of another raw unit."""
    gyros, raw_unit = results.gyros, results.setup.facts.raw_unit
    largest = 0.0
    if raw_unit.name != "V":
        left = np.abs([residuals(results, gyros, k) for k in range(len(gyros.names))])
        largest = float(np.max(left, where=np.isfinite(left), initial=0.0))
    title = "Residuals of the gyros: bins less the fitted curve"
    return _draw(results, gyros, title, *parts.prefixed(raw_unit, largest))


def draw_axes(results: Results) -> Figure:
    """A panel an axis, degrees an hour."""
    assert results.axes is not None
    title = "Residuals of x, y, z: bins less the fitted curve"
    return _draw(results, results.axes, title, SECONDS_PER_HOUR, "deg/h")


def residuals(results: Results, family: Family, channel: int) -> Array:
    """Residual of each bin, in the family's unit; NaN where the fit left the bin out."""
    return residual_bins(
        results.segments,
        family.names[channel],
        family.time_s,
        family.mean[channel],
        results.bin_s,
        results.guard_s,
    )


def _draw(results: Results, family: Family, title: str, scale: float, unit: str) -> Figure:
    height = 1.45 if len(family.names) > 3 else 2.0
    figure, rows = style.panels(results.identity, title, len(family.names), height)
    unstable = False

    def quantity(value: float) -> str:
        return f"{parts.plain(value * scale)} {unit}"

    for k, (name, (axes,)) in enumerate(zip(family.names, rows, strict=True)):
        left = residuals(results, family, k)
        columns = columns_of(family.time_s, left, left, left, family.count[k])
        white = WHITE_SIGMAS * white_of_bins(results, name) * scale
        low, high = bulk_range(left * scale, left * scale, white, -white, reach=_REACH)
        axes.set_ylim(low, high)
        watched = [name] if name in results.gyros.names else results.gyros.names
        unstable |= parts.shade_unstable(axes, results, watched)
        draw_band(axes, columns, scale)
        for segment, level in zip(results.segments, white.tolist(), strict=True):
            for sign in (-1, 1):
                span = [segment["start_s"], segment["stop_s"]]
                axes.plot(span, [sign * level] * 2, color=style.ADJUSTED, linewidth=1.0, dashes=(5, 2))
        axes.set_title(name)
        style.note(axes, mark_beyond(axes, columns, left, left, scale, quantity), style.SPIKE)
        axes.set_ylabel(f"residual [{unit}]")
        if not np.isfinite(left).any():
            style.say_empty(axes, "no fitted curve")
    last = rows[-1][0]
    last.set_xlim(*results.span_s)
    last.set_xlabel(f"{style.TIME_LABEL}, bins of {results.bin_s:g} s")
    white_text = f"±{WHITE_SIGMAS:g} sigma of white noise in a bin"
    handles = [
        *parts.band_handles("lowest to highest bin", "mean"),
        Line2D([], [], color=style.ADJUSTED, linewidth=1.0, dashes=(5, 2), label=white_text),
    ]
    style.legend(figure, results.identity, handles + ([parts.unstable_handle()] if unstable else []))
    return figure


def white_of_bins(results: Results, channel: str) -> Array:
    """Standard deviation of a bin's mean in each segment if a sample's noise were white; NaN = no curve."""
    per_bin = max(1.0, results.bin_s * results.setup.facts.sample_rate_hz)
    items = [channel_of(segment, channel) for segment in results.segments]
    return np.array([math.nan if item is None else item["sigma"] / math.sqrt(per_bin) for item in items])
