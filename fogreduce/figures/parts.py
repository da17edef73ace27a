"""Pieces that several figures share: curves of all segments, unstable intervals, units."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from numpy.typing import NDArray

from fogreduce.figures.results import Results
from fogreduce.physics.raw_quantity import RawUnit
from fogreduce.plotting import style
from fogreduce.stages.angles import channel_of

Array = NDArray[np.float64]

_CURVE_POINTS = 800  # over the whole run


def segment_times(results: Results) -> list[Array]:
    """Times [s] on which each segment's curve is drawn, its first and last instant among them."""
    whole = float(results.segments[-1]["stop_s"])
    found = []
    for segment in results.segments:
        length = segment["stop_s"] - segment["start_s"]
        points = max(16, round(_CURVE_POINTS * length / whole))
        found.append(np.linspace(segment["start_s"], segment["stop_s"], points))
    return found


def curves(
    results: Results, channel: str, evaluate: Callable[[Mapping[str, Any], Mapping[str, Any], Array], Array]
) -> tuple[Array, Array]:
    """A curve over all segments up to the last record, broken (NaN) between them: times [s] and values.

    Parameters
    ----------
    results : Results
        The run.
    channel : str
        Its name.
    evaluate : callable
        (segment, fit of the channel, times) -> values; not asked where a channel has no curve.
    """
    times, values = [np.empty(0)], [np.empty(0)]
    end = results.gyros.time_s[-1] + results.bin_s
    for segment, whole in zip(results.segments, segment_times(results), strict=True):
        item, time_s = channel_of(segment, channel), whole[whole <= end]
        if item is None or time_s.size == 0:
            continue
        times += [time_s, time_s[-1:]]
        values += [evaluate(segment, item, time_s), np.array([np.nan])]
    return np.concatenate(times), np.concatenate(values)


def shade_unstable(axes: Axes, results: Results, gyros: Iterable[str]) -> bool:
    """Shade the intervals in which one of these gyros is unstable; whether there was one."""
    wanted = set(gyros)
    found = [item for item in results.fits["unstable"] if item["gyro"] in wanted]
    for start, stop in _merged([(item["start_s"], item["stop_s"]) for item in found]):
        axes.axvspan(start, stop, facecolor=style.UNSTABLE, edgecolor="none", zorder=0)
    return bool(found)


def _merged(intervals: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Intervals that overlap, taken together."""
    merged: list[tuple[float, float]] = []
    for start, stop in sorted(intervals):
        if merged and start <= merged[-1][1]:
            merged[-1] = merged[-1][0], max(stop, merged[-1][1])
        else:
            merged.append((start, stop))
    return merged


def band_handles(band: str, mean: str) -> list[Patch | Line2D]:
    """Legend of a band and its mean."""
    return [Patch(color=style.BAND, label=band), Line2D([], [], color=style.MEAN, label=mean)]


def unstable_handle() -> Patch:
    """Legend of an unstable interval."""
    return Patch(color=style.UNSTABLE, label="unstable")


def plain(value: float) -> str:
    """A number with three digits, without a power of ten where it can be helped."""
    return f"{value:,.0f}" if 100 <= abs(value) < 1e9 else f"{value:.3g}"


def with_unit(raw_unit: RawUnit, value: float) -> str:
    """A raw reading in the unit in which it reads well."""
    scale, unit = prefixed(raw_unit, abs(value))
    return f"{plain(value * scale)} {unit}"


def plus_minus(value: float, error: float) -> str:
    """A value and its standard error, both to the error's second digit."""
    if not error > 0:
        return f"{value:.6g}"
    digits = min(12, max(0, 1 - math.floor(math.log10(error))))
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def prefixed(raw_unit: RawUnit, largest: float) -> tuple[float, str]:
    """Factor and unit in which raw readings up to `largest` [raw unit] read well."""
    if raw_unit.name == "count":
        return 1.0, "counts"
    for scale, prefix in ((1.0, ""), (1e3, "m")):
        if largest * scale >= 1:
            return scale, prefix + raw_unit.name
    return 1e6, "µ" + raw_unit.name
