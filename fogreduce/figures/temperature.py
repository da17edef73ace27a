"""Temperatures logged beside a run."""

from __future__ import annotations

from matplotlib.figure import Figure

from fogreduce.datasets.logs import TemperatureLog
from fogreduce.figures import parts
from fogreduce.figures.envelope import thin_line
from fogreduce.figures.results import Results
from fogreduce.plotting import style


def draw(results: Results, log: TemperatureLog) -> Figure:
    """Electronics and sensor, each on its own scale: what matters is how they change."""
    logged = {"electronics": log.electronics_degC, "sensor": log.sensor_degC}
    shown = {name: values for name, values in logged.items() if values is not None}
    figure, rows = style.panels(results.identity, "Temperatures beside the run", len(shown), 2.0)
    unstable = False
    for (axes,), (name, values) in zip(rows, shown.items(), strict=True):
        unstable |= parts.shade_unstable(axes, results, results.gyros.names)
        axes.plot(*thin_line(log.time_s, values), color=style.MEAN)
        axes.margins(y=0.08)
        axes.set_title(name)
        change = values[-1] - values[0]
        style.note(axes, f"{values[0]:.2f} to {values[-1]:.2f} degC, change {change:+.2f}")
        axes.set_ylabel("temperature [degC]")
    last = rows[-1][0]
    last.set_xlim(min(0.0, log.time_s[0]), max(results.span_s[1], log.time_s[-1]))
    last.set_xlabel(style.TIME_LABEL)
    if unstable:
        style.legend(figure, results.identity, [parts.unstable_handle()])
    return figure
