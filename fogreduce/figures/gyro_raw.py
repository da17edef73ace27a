"""Each gyro's raw readings with its mean curve (the paper's figures 3 to 6)."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fogreduce.figures import parts
from fogreduce.figures.envelope import bulk_range, draw_band, mark_beyond
from fogreduce.figures.results import Results
from fogreduce.plotting import style
from fogreduce.stages.angles import fitted_curve


def draw(results: Results) -> Figure:
    """A panel a gyro: lowest to highest sample, means of bins, fitted curve, unstable intervals."""
    gyros, raw_unit = results.gyros, results.setup.facts.raw_unit
    title = f"Raw {raw_unit.quantity} of the gyros and their mean curves"
    figure, rows = style.panels(results.identity, title, len(gyros.names), 1.45)
    drawn = [
        parts.curves(results, name, lambda segment, item, time_s: fitted_curve(item, time_s))
        for name in gyros.names
    ]
    ranges = [bulk_range(gyros.lowest[k], gyros.highest[k], values) for k, (_, values) in enumerate(drawn)]
    answered = [bool(np.isfinite(mean).any()) for mean in gyros.mean]
    largest = float(np.max(np.abs(ranges)[answered], initial=0.0))
    scale, unit = parts.prefixed(raw_unit, largest)
    unstable = False

    def quantity(value: float) -> str:
        return parts.with_unit(raw_unit, value)

    for k, (name, (axes,)) in enumerate(zip(gyros.names, rows, strict=True)):
        axes.set_ylim(ranges[k][0] * scale, ranges[k][1] * scale)
        columns = gyros.columns(k)
        unstable |= parts.shade_unstable(axes, results, [name])
        draw_band(axes, columns, scale)
        axes.plot(drawn[k][0], drawn[k][1] * scale, color=style.CURVE, linewidth=2.6)
        axes.set_title(name)
        beyond = mark_beyond(axes, columns, gyros.lowest[k], gyros.highest[k], scale, quantity)
        style.note(axes, beyond, style.SPIKE)
        axes.set_ylabel(unit if unit == raw_unit.quantity else f"{raw_unit.quantity} [{unit}]")
        if not answered[k]:
            style.say_empty(axes, "no usable values")
    last = rows[-1][0]
    last.set_xlim(*results.span_s)
    last.set_xlabel(style.TIME_LABEL)
    handles = [
        *parts.band_handles("lowest to highest sample", "mean"),
        Line2D([], [], color=style.CURVE, linewidth=2.6, label="fitted curve"),
    ]
    style.legend(figure, results.identity, handles + ([parts.unstable_handle()] if unstable else []))
    return figure
