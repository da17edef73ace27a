"""Allan deviation of every sample, its limits and the noise that describes it; the spectral density."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator
from numpy.typing import NDArray

from fogreduce.characterise.allan_channel import Channel, Deviations
from fogreduce.characterise.allan_fit import model_variance
from fogreduce.characterise.allan_freedom import Kind, limits
from fogreduce.plotting import style

_POINTS_PER_DECADE = 4  # with limits, of the many averaging times; the line goes through all
LIMITS_LABEL = "limits, 95 % (thin) and 68 %"


def draw_result(channels: Sequence[Channel], about: Mapping[str, Any], kind: Kind = "overlapping") -> Figure:
    """Deviations of every sample above, spectral densities below; gyros on the left, axes on the right.

    `about`: campaign, run_id, version_id and label of the data, as far as there are any.
    """
    identity = style.Identity(
        str(about.get("campaign", "")),
        str(about.get("run_id", "arrays")),
        str(about.get("version_id", "none")),
        str(about.get("label", "")),
    )
    axes_names = [one for one in channels if one.name in ("x", "y", "z")]
    others = [one for one in channels if one not in axes_names]
    groups = [group for group in (others, axes_names) if group]
    title = f"{kind.capitalize()} Allan deviation and spectral density"
    figure, rows = style.panels(identity, title, 2, 4.1, (1.0,) * len(groups), sharing=False)
    for column, group in enumerate(groups):
        above, below = rows[0][column], rows[1][column]
        for k, channel in enumerate(group):
            color, marker = style.CHANNELS[k % len(style.CHANNELS)]
            _draw_deviation(above, channel, kind, color, marker)
            _draw_density(below, channel, color)
        above.set_xlabel("averaging time [s]")
        below.set_xlabel("frequency [Hz]")
        for axes in (above, below):
            log_log(axes)
        above.legend(loc="lower left", fontsize=8.5)
    rows[0][0].set_ylabel("Allan deviation [deg/h]")
    rows[1][0].set_ylabel("density [(deg/h)²/Hz]")
    handles = [
        Line2D([], [], color=style.QUIET, linewidth=2.2, label=LIMITS_LABEL),
        Line2D([], [], color=style.QUIET, dashes=(5, 2), linewidth=1.0, label="fitted Q, N, B, K, R"),
    ]
    style.legend(figure, identity, handles)
    return figure


def _draw_deviation(axes: Axes, channel: Channel, kind: Kind, color: str, marker: str) -> None:
    """Line, limits at some points, and the fit where its variance is positive."""
    if kind not in channel.deviations:
        axes.plot([], [], marker, color=color, label=f"{channel.name}: nothing")
        return
    one = channel.deviations[kind]
    shown = _thinned(one)
    draw_limits(axes, one, shown, color)
    axes.plot(one.tau_s, one.deviation, color=color, linewidth=0.9)
    axes.plot(one.tau_s[shown], one.deviation[shown], marker, color=color, markersize=4.5, label=channel.name)
    if channel.coefficients and kind != "modified":  # the fit's model is that of the Allan variance
        model = model_variance(channel.coefficients, one.tau_s)
        model[model <= 0] = np.nan
        axes.plot(one.tau_s, np.sqrt(model), color=color, linewidth=1.0, dashes=(5, 2))


def _thinned(one: Deviations) -> NDArray[np.int64]:
    """Some of the averaging times, evenly on the logarithmic scale, the last among them."""
    if one.tau_s.size == 0:
        return np.zeros(0, np.int64)
    slots = np.floor(np.log10(one.tau_s / one.tau_s[-1]) * _POINTS_PER_DECADE + 1e-9)
    return np.flatnonzero(np.diff(np.concatenate((slots, [np.inf]))) > 0)


def draw_limits(axes: Axes, one: Deviations, shown: NDArray[np.int64], color: str) -> None:
    """Limits of 95 % and 68 % at some averaging times, numbers `shown` (s,), as upright lines."""
    for low, high, width in ((one.low_95, one.high_95, 0.8), (one.low_68, one.high_68, 2.2)):
        axes.vlines(one.tau_s[shown], low[shown], high[shown], color=color, linewidth=width)


def _draw_density(axes: Axes, channel: Channel, color: str) -> None:
    """Density as a line, its 95 % limits as a band."""
    one = channel.spectrum
    low, high = (one.density * factor**2 for factor in limits(one.freedom, 0.95))
    axes.fill_between(one.frequency_hz, low, high, color=color, alpha=0.15, linewidth=0)
    axes.plot(one.frequency_hz, one.density, color=color, linewidth=1.0)


def log_log(axes: Axes) -> None:
    """Both scales logarithmic, with plain numbers at 1, 2 and 5 of every decade that is short of ticks."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.margins(x=0.04)
    for axis, (low, high) in ((axes.xaxis, axes.get_xlim()), (axes.yaxis, axes.get_ylim())):
        subs = (1.0,) if high / low > 300 else (1.0, 2.0, 5.0)
        axis.set_major_locator(LogLocator(subs=subs, numticks=20))
        axis.set_minor_locator(NullLocator())
        axis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
