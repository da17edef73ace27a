"""What a fitted curve and the run's bins say of angles and residuals, for figures and for a closer look.

All of it follows from the fits as `fogreduce.stages.fit_report.as_plain` gives them. Angles use the paper's
offset rule, as `fogreduce.stages.drift` does: the curve starts at the commanded rate, then it is integrated.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.mean_curve import curve, curve_integral

Array = NDArray[np.float64]
Segment = Mapping[str, Any]
Item = Mapping[str, Any]


def channel_of(segment: Segment, name: str) -> Item | None:
    """The fit of a channel in a segment; None where its records determined no curve."""
    return next((item for item in segment["channels"] if item is not None and item["channel"] == name), None)


def fitted_curve(item: Item, time_s: Array) -> Array:
    """The fitted mean curve at times [s], in the channel's unit."""
    return curve(time_s, np.append(item["theta"], item["rate_rad_s"]))


def binned_curve(item: Item, time_s: Array, bin_s: float) -> Array:
    """Means of the fitted curve over bins of length `bin_s` [s] about their middles `time_s` [s]."""
    theta = np.append(item["theta"], item["rate_rad_s"])
    # A bin's mean of the sine is its middle value times sinc of half the turn within the bin.
    theta[1:3] *= np.sinc(item["rate_rad_s"] * bin_s / (2 * np.pi))
    return curve(time_s, theta)


def residual_bins(
    segments: Sequence[Segment], name: str, time_s: Array, mean: Array, bin_s: float, guard_s: float
) -> Array:
    """Bins less the fitted curve, one channel.

    Parameters
    ----------
    segments : sequence of mappings
        The fits.
    name : str
        The channel.
    time_s, mean : (m,) arrays
        Middles of the bins [s] and their means.
    bin_s, guard_s : float
        Length of a bin; what the fit leaves out on both sides of an edge between segments [s].

    Returns
    -------
    (m,) array
        NaN where a bin is not wholly inside a segment (guard left out) that has a curve.
    """
    found = np.full(time_s.shape, np.nan)
    for segment, inside in inside_segments(segments, time_s, bin_s, guard_s):
        item = channel_of(segment, name)
        if item is not None:
            found[inside] = mean[inside] - binned_curve(item, time_s[inside], bin_s)
    return found


def less_commanded(
    segments: Sequence[Segment], sign: float, time_s: Array, mean: Array, bin_s: float, guard_s: float
) -> Array:
    """Bins of an axis less the commanded rate about it [deg/s].

    Parameters
    ----------
    segments : sequence of mappings
        The fits.
    sign : float
        The axis' part of the table's axis, by which the table's rate is multiplied.
    time_s, mean : (m,) arrays
        Middles of the bins [s] and their means [deg/s], Earth's rate taken away.
    bin_s, guard_s : float
        As for `residual_bins`.

    Returns
    -------
    (m,) array
        NaN where a bin is not wholly inside a segment (guard left out).
    """
    found = np.full(time_s.shape, np.nan)
    for segment, inside in inside_segments(segments, time_s, bin_s, guard_s):
        found[inside] = mean[inside] - sign * segment["rate_deg_s"]
    return found


def inside_segments(
    segments: Sequence[Segment], time_s: Array, bin_s: float, guard_s: float
) -> Iterator[tuple[Segment, NDArray[np.bool_]]]:
    """Each segment, and which bins (m,) lie wholly inside it, the guard [s] at its edges left out."""
    for k, segment in enumerate(segments):
        low = -np.inf if k == 0 else segment["start_s"] + guard_s + bin_s / 2
        high = np.inf if k == len(segments) - 1 else segment["stop_s"] - guard_s - bin_s / 2
        yield segment, (time_s >= low) & (time_s < high)


def error_angle(segments: Sequence[Segment], axis: str, time_s: Array) -> Array:
    """Angle by the offset-adjusted curve less the commanded one [deg], at times [s], over all segments.

    At a segment's end it is the sum of the segments' accumulated errors up to there (drift.csv). NaN
    before the first segment, after the last, and from the first segment on that determines no drift.
    """
    found = np.full(time_s.shape, np.nan)
    before = 0.0
    for segment in segments:
        item = channel_of(segment, axis)
        if item is None or not item["has_slope"]:
            break
        edges = np.array([segment["start_s"], segment["stop_s"]])
        inside = (time_s >= edges[0]) & (time_s <= edges[1])
        theta = np.append(item["theta"], item["rate_rad_s"])
        at_start = curve(edges[:1], theta)[0]
        times = np.append(time_s[inside], edges[1])
        turned = curve_integral(times, theta) - curve_integral(edges[:1], theta)
        angles = turned - at_start * (times - edges[0])
        found[inside] = before + angles[:-1]
        before += float(angles[-1])
    return found


def measured_error_angle(residual: Array, length_s: Array, curve_error: Array) -> Array:
    """Angle by the measured bins less the commanded one [deg], at the ends of bins.

    Parameters
    ----------
    residual : (m,) array
        From `residual_bins` [deg/s]; where it is NaN, the curve stands in.
    length_s : (m,) array
        Lengths of the bins [s].
    curve_error : (m,) array
        `error_angle` at the bins' ends [deg].
    """
    return curve_error + np.cumsum(np.nan_to_num(residual) * length_s)
