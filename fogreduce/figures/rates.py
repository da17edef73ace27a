"""Rates x, y, z less Earth's part, with fitted and offset-adjusted curve (the paper's figures 7 to 9)."""

from __future__ import annotations

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fogreduce.figures import parts, style
from fogreduce.figures.envelope import bulk_range, draw_band, mark_beyond
from fogreduce.figures.results import Results
from fogreduce.stages.angles import fitted_curve
from fogreduce.stages.drift import adjusted_curve


def draw(results: Results) -> Figure:
    """A panel an axis: lowest to highest sample, means of bins, both curves, the commanded rate."""
    family = results.axes
    assert family is not None
    figure, rows = style.panels(
        results.identity, "Rates about x, y, z without Earth's rate", len(family.names), 2.0
    )
    unstable = False
    signs = results.setup.facts.commanded_signs.tolist()
    for k, (name, sign, (axes,)) in enumerate(zip(family.names, signs, rows, strict=True)):
        time_s, fitted = parts.curves(results, name, lambda segment, item, time: fitted_curve(item, time))
        _, adjusted = parts.curves(
            results,
            name,
            lambda segment, item, time, sign=sign: adjusted_curve(  # type: ignore[misc]
                segment, item, sign * segment["rate_deg_s"], time
            ),
        )
        axes.set_ylim(*bulk_range(family.lowest[k], family.highest[k], fitted, adjusted))
        columns = family.columns(k)
        unstable |= parts.shade_unstable(axes, results, results.gyros.names)
        draw_band(axes, columns)
        axes.plot(time_s, fitted, color=style.CURVE, linewidth=2.6)
        axes.plot(time_s, adjusted, color=style.ADJUSTED, linewidth=1.4, dashes=(5, 2))
        for segment in results.segments:
            commanded = sign * segment["rate_deg_s"] + 0.0
            span = [segment["start_s"], segment["stop_s"]]
            axes.plot(span, [commanded] * 2, color=style.COMMAND, linewidth=1.0, dashes=(1, 1.5))
        axes.set_title(name)
        beyond = mark_beyond(
            axes,
            columns,
            family.lowest[k],
            family.highest[k],
            1.0,
            lambda value: f"{parts.plain(value)} deg/s",
        )
        style.note(axes, beyond, style.SPIKE)
        axes.set_ylabel("rate [deg/s]")
    last = rows[-1][0]
    last.set_xlim(*results.span_s)
    last.set_xlabel(style.TIME_LABEL)
    handles = [
        *parts.band_handles("lowest to highest", "mean"),
        Line2D([], [], color=style.CURVE, linewidth=2.6, label="fitted curve"),
        Line2D([], [], color=style.ADJUSTED, linewidth=1.4, dashes=(5, 2), label="offset adjusted"),
        Line2D([], [], color=style.COMMAND, linewidth=1.0, dashes=(1, 1.5), label="commanded"),
    ]
    style.legend(figure, results.identity, handles + ([parts.unstable_handle()] if unstable else []))
    return figure
