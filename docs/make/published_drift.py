"""The picture of the README: x's rate and the angles that integrate from x, y and z."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from fogreduce.figures import parts, rates
from fogreduce.figures.results import Results
from fogreduce.plotting import style
from fogreduce.stages.angles import error_angle


def draw(results: Results) -> Figure:
    """Rate about x above, angles of x, y, z less the commanded ones below, with their drifts."""
    figure, ((rate,), (angle,)) = style.panels(
        results.identity, "The published run: from rates to drift", 2, 2.1
    )
    rates.draw_axis(rate, results, 0)
    times = np.unique(np.concatenate(parts.segment_times(results)))
    drifts = {row["axis"]: float(row["drift_deg_h"]) for row in results.drift}
    for k, name in enumerate(results.setup.axes):
        color, _ = style.CHANNELS[k]
        values = error_angle(results.segments, name, times)
        angle.plot(times, values, color=color, linewidth=1.8)
        text = f"{name}: {drifts[name]:.2f} deg/h"
        offset = (-4, 3) if values[-1] > 0 else (-4, 14)  # clear of the curve, which comes from the left
        angle.annotate(
            text, (times[-1], values[-1]), offset, textcoords="offset points", color=color, ha="right"
        )
    angle.set_title("angles: integrals of the offset-adjusted curves less the commanded angle")
    angle.set_ylabel("angle [deg]")
    angle.margins(y=0.16)
    angle.set_xlim(*results.span_s)
    angle.set_xlabel(style.TIME_LABEL)
    style.legend(figure, results.identity, [*rates.handles(), parts.unstable_handle()])
    return figure
