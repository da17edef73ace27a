"""A run reduced with each gyro left out: what its loss costs in drift and noise.

Bins of raw readings are projected by the gyros that are left (generalised least squares), Earth's part is
taken away, and the mean curve and drift are those of the reduction.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.noise import GyroNoise
from fogreduce.calibrate.readings import Readings
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.estimate.mean_curve import CurveBasis, CurveFit, CurveSums
from fogreduce.physics.earth_rate import remove_earth_rate
from fogreduce.physics.redundancy import projection, spans_space, variance_trace
from fogreduce.stages.drift import accumulated_error

Array = NDArray[np.float64]


@dataclass(frozen=True)
class LeftOut:
    """A run without one gyro.

    Attributes
    ----------
    gyro : int or None
        From 0; None: all gyros.
    trace : float
        Trace of ``(G' G)^-1``: variance of x, y, z together for gyros of noise 1.
    noise_deg_sqrt_h : (3,) array
        White noise of x, y, z; NaN where the gyros left lie in a plane.
    drift_deg_h, drift_err_deg_h : (3,) arrays
        Of the longest segment, with the error of white noise; NaN where it is not determined.
    segment : int
        That segment, from 1.
    """

    gyro: int | None
    trace: float
    noise_deg_sqrt_h: Array
    drift_deg_h: Array
    drift_err_deg_h: Array
    segment: int


def each_left_out(one: Readings, noise: list[GyroNoise]) -> list[LeftOut]:
    """All gyros, then each of them left out."""
    n = one.facts.n_gyros
    white = np.array([each.white_deg_sqrt_h for each in noise])
    segment = int(np.argmax(one.facts.profile.duration_s))
    return [_without(one, white, gyro, segment) for gyro in (None, *range(n))]


def axis_rates_by(one: Readings, kept: NDArray[np.bool_], white: Array) -> Array:
    """Rates x, y, z with Earth's part taken away, by the gyros kept (n,): (3, m) [deg/s]."""
    facts = one.facts
    rates = (one.raw[kept] - facts.bias[kept, None]) / facts.scale_factor[kept, None]
    weights = white[kept] if (white[kept] > 0).all() else None
    axis = projection(facts.axes[kept], weights) @ rates
    return remove_earth_rate(axis, facts.earth, facts.profile.angle_at(one.time_s))


def _without(one: Readings, white: Array, gyro: int | None, segment: int) -> LeftOut:
    facts = one.facts
    kept = np.arange(facts.n_gyros) != (-1 if gyro is None else gyro)
    nothing = np.full(3, np.nan)
    if not spans_space(facts.axes[kept]):
        return LeftOut(gyro, float("inf"), nothing, nothing, nothing, segment + 1)
    weights = white[kept] if (white[kept] > 0).all() else None
    noise = np.sqrt(projection(facts.axes[kept], weights) ** 2 @ white[kept] ** 2)
    curves = _curves(one, axis_rates_by(one, kept, white), segment)
    edges = facts.profile.edges_s
    span = {"start_s": float(edges[segment]), "stop_s": float(edges[segment + 1])}
    per_hour = SECONDS_PER_HOUR / (span["stop_s"] - span["start_s"])
    drift, error = nothing.copy(), nothing.copy()
    for k, found in enumerate(curves):
        if found is not None:
            angle = accumulated_error(span, _item(found))
            drift[k], error[k] = angle.value * per_hour, angle.white * per_hour
    return LeftOut(gyro, variance_trace(facts.axes[kept]), noise, drift, error, segment + 1)


def _curves(one: Readings, rates: Array, segment: int) -> list[CurveFit | None]:
    """Mean curves of x, y, z over a segment, from bins."""
    profile = one.facts.profile
    edges = profile.edges_s
    basis = CurveBasis.of(
        float(edges[segment]), float(edges[segment + 1]), float(profile.rate_deg_s[segment])
    )
    inside = (one.segment == segment) & np.isfinite(rates).all(axis=0)
    sums = CurveSums(basis, 3)
    sums.add(basis.columns(one.time_s[inside]), rates[:, inside], None)
    return [sums.fit(k) for k in range(3)]


def _item(curve: CurveFit) -> dict[str, object]:
    return {
        "theta": curve.theta,
        "covariance": curve.covariance,
        "coloured_covariance": None,
        "stated_covariance": None,
        "has_slope": curve.has_slope,
        "rate_rad_s": curve.rate_rad_s,
    }
