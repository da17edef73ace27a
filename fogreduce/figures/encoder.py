"""The table's encoder against the command."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import NDArray

from fogreduce.datasets.logs import TableLog
from fogreduce.figures.envelope import bulk_range, thin_line
from fogreduce.figures.results import Results
from fogreduce.plotting import style

Array = NDArray[np.float64]

MILLI = 1e3


def draw(results: Results, log: TableLog) -> Figure:
    """Encoder less command over the run; edges between rates as upright lines."""
    figure, ((axes,),) = style.panels(results.identity, "Table encoder less commanded angle", 1, 3.6)
    departure = encoder_less_command(results, log) * MILLI
    low, high = bulk_range(departure, departure)
    axes.set_ylim(low, high)
    time_s, values = thin_line(log.time_s, departure)
    axes.plot(time_s, np.clip(values, 2 * low - high, 2 * high - low), color=style.MEAN, linewidth=0.9)
    for edge in results.setup.facts.profile.edges_s[1:-1].tolist():
        axes.axvline(edge, color=style.COMMAND, linewidth=1.0, dashes=(1, 1.5))
    outside = int(np.count_nonzero((departure < low) | (departure > high)))
    if outside:
        style.note(axes, f"{outside} rows beyond, from {departure.min():.3g} to {departure.max():.3g} mdeg")
    axes.set_xlim(min(0.0, log.time_s[0]), max(results.span_s[1], log.time_s[-1]))
    axes.set_xlabel(style.TIME_LABEL)
    axes.set_ylabel("encoder less command [mdeg]")
    handles = [Line2D([], [], color=style.MEAN, label="encoder less command, zero at the start")]
    if len(results.segments) > 1:
        label = "the commanded rate changes"
        handles.append(Line2D([], [], color=style.COMMAND, linewidth=1.0, dashes=(1, 1.5), label=label))
    style.legend(figure, results.identity, handles)
    return figure


def encoder_less_command(results: Results, log: TableLog) -> Array:
    """Angle by the encoder, counted from the run's start, less the commanded one [deg], row by row."""
    from_start = log.angle_deg - np.interp(0.0, log.time_s, log.angle_deg)
    return from_start - np.degrees(results.setup.facts.profile.angle_at(log.time_s))
