"""Fits as JSON-ready data, every digit kept (reports/fit.json): what later steps, figures and pages read."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.curve_terms import drift_terms, plain_terms
from fogreduce.estimate.mean_curve import CurveFit
from fogreduce.estimate.unstable import Unstable
from fogreduce.stages.fit import ChannelFit, RunFits, SegmentFit

Array = NDArray[np.float64]
Terms = Callable[[float, float, float], Array]


def as_plain(fits: RunFits, unstable: list[Unstable], bin_s: float) -> dict[str, Any]:
    """Fits, unstable intervals, and the noise that errors rest on.

    A segment has under `unit_forms` the covariance (3, 4, 4) of theta under white noise, flicker and walk of
    coefficient 1, for curves of so many terms; under `noise_spread` the covariance of the three coefficients
    of each channel's noise, which is how well they are known; `projection` is that by which most of its
    records gave x, y, z; `axes_noise_covariance` (12, 12) is that of theta of x, y and z together, rounding
    not in it. `whole` is the noise of what is published of all segments together.
    """
    return {
        "bin_s": bin_s,
        "unstable": [
            {"gyro": f"gyro{item.gyro + 1}", "start_s": item.start_s, "stop_s": item.stop_s}
            | {"noise_ratio": item.noise_ratio}
            for item in unstable
        ],
        "segments": [
            {
                "segment": segment.number,
                "start_s": segment.start_s,
                "stop_s": segment.stop_s,
                "rate_deg_s": segment.rate_deg_s,
                "channels": [None if item is None else _plain_channel(item) for item in segment.channels],
                "complete_records": [
                    None if item is None else _plain_curve(item) for item in segment.complete
                ],
                **_plain_noise(fits, segment),
            }
            for segment in fits.segments
        ],
        "whole": _whole(fits) if len(fits.segments) > 1 else None,
    }


def _plain_curve(item: CurveFit) -> dict[str, Any]:
    """What the drift of a curve needs, white noise its only error."""
    return {
        "theta": item.theta.tolist(),
        "covariance": item.covariance.tolist(),
        "coloured_covariance": None,
        "stated_covariance": None,
        "records": item.records,
        "has_slope": item.has_slope,
        "rate_rad_s": item.rate_rad_s,
    }


def _plain_channel(item: ChannelFit) -> dict[str, Any]:
    noise = item.noise
    return {
        "channel": item.channel,
        "theta": item.curve.theta.tolist(),
        "covariance": item.curve.covariance.tolist(),
        "sigma": item.curve.sigma,
        "records": item.curve.records,
        "has_sine": item.curve.has_sine,
        "has_slope": item.curve.has_slope,
        "has_phase": item.has_phase,
        "undetermined": item.undetermined,
        "rate_rad_s": item.curve.rate_rad_s,
        "coloured_covariance": None if item.coloured is None else item.coloured.tolist(),
        "rounding_covariance": None if item.rounding is None else item.rounding.tolist(),
        "stated_covariance": None if item.stated is None else item.stated.tolist(),
        "noise": None
        if noise is None
        else {"white": noise.white, "flicker": noise.flicker, "walk": noise.walk},
    }


def _plain_noise(fits: RunFits, segment: SegmentFit) -> dict[str, Any]:
    """Unit forms of the curves in use, and the covariance of x, y, z together; None where none is known."""
    k = segment.number - 1
    with_noise = [item for item in segment.channels if item is not None and item.coloured is not None]
    forms = {str(item.terms): fits.noise.forms(k, item.terms).tolist() for item in with_noise}
    axes = [item for item in with_noise if item.stated is not None]
    across = None
    if len(axes) == 3:
        across = fits.noise.across(k, [item.terms for item in axes]).reshape(12, 12).tolist()
    projection = fits.noise.segments[k].projection
    spreads = {
        name: fits.noise.of_channel(channel, k).spread.tolist() for channel, name in enumerate(fits.channels)
    }
    return {
        "noise_spread": spreads,
        "projection": None if projection is None else projection.tolist(),
        "unit_forms": forms,
        "axes_noise_covariance": across,
    }


def _whole(fits: RunFits) -> dict[str, Any] | None:
    """Noise of drift and plain integral of the whole run: x, y, z, or the gyros where there are no axes.

    For each a covariance matrix of those channels, and of each channel the variance of its variance; None
    where a channel lacks a curve or its noise in any segment.
    """
    axes = [name for name in fits.channels if not name.startswith("gyro")]
    channels = axes or fits.channels
    first = fits.channels.index(channels[0])
    items = [segment.channels[first : first + len(channels)] for segment in fits.segments]
    if any(item is None or item.coloured is None for row in items for item in row):
        return None

    def noise(of: Terms, least: int) -> dict[str, Any] | None:
        def weights(k: int, channel: int) -> tuple[int, Array]:
            item, segment = items[k][channel], fits.segments[k]
            assert item is not None
            return item.terms, of(segment.start_s, segment.stop_s, item.curve.rate_rad_s)

        if any(item is None or item.terms < least for row in items for item in row):
            return None
        covariance, spread = fits.noise.over_segments(weights, bool(axes))
        return {"covariance": covariance.tolist(), "spread": spread.tolist()}

    return {"channels": channels, "drift": noise(drift_terms, 2), "integral": noise(plain_terms, 1)}
