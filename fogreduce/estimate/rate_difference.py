"""A measured mean curve held against what was commanded: mean rate, and the sine that Earth's rate leaves.

Earth's part has been taken away. What should be left of a curve is the commanded rate; a mean that
differs, or a sine at the table's rate, is judged by its combined covariance: that of the noise which the
residuals show and that of what calibration record and run.yaml state as uncertain.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.curve_terms import mean_rate_terms

Array = NDArray[np.float64]


@dataclass(frozen=True)
class RateDifference:
    """Mean rate of a channel over a segment, and the amplitude of the sine in it, against what was commanded.

    Attributes
    ----------
    duration_s : float
    measured, commanded : float
        Mean rates [deg/s]; the measured one NaN where the records determine none.
    noise, stated : float
        Standard errors of the measured one [deg/s]: by noise, and by what is stated as uncertain.
    sine, sine_err : float
        Amplitude of the sine and its combined standard error [deg/s]; NaN without a sine in the curve.
    sine_sigma : float
        Length of the vector (b sin d, b cos d) in units of its combined covariance.
    """

    duration_s: float
    measured: float
    commanded: float
    noise: float
    stated: float
    sine: float = math.nan
    sine_err: float = math.nan
    sine_sigma: float = math.nan

    @property
    def is_determined(self) -> bool:
        """Whether there is a measured rate."""
        return not math.isnan(self.measured)

    @property
    def difference(self) -> float:
        """Measured less commanded [deg/s]."""
        return self.measured - self.commanded

    @property
    def error(self) -> float:
        """Combined standard error of the difference [deg/s]."""
        return math.hypot(self.noise, self.stated)

    @property
    def sigma(self) -> float:
        """The difference in units of its error."""
        if self.error != 0:
            return self.difference / self.error
        return math.copysign(math.inf, self.difference) if self.difference else 0.0

    @property
    def chances(self) -> list[float]:
        """Probability of a mean, and of a sine, as far off or farther when nothing is wrong."""
        if not self.is_determined:
            return []
        found = [math.erfc(abs(self.sigma) / math.sqrt(2))]
        if not math.isnan(self.sine_sigma):
            found.append(
                math.exp(-(min(self.sine_sigma, 1e3) ** 2) / 2)
            )  # chi-squared of two degrees of freedom
        return found


def rate_difference(
    theta: Array,
    noise: Array,
    stated: Array,
    rate_rad_s: float,
    has_sine: bool,
    span_s: tuple[float, float],
    commanded: float,
) -> RateDifference:
    """Of one fitted curve.

    Parameters
    ----------
    theta : (4,) array
        a, p, q, e of the rate with Earth's part taken away, see `fogreduce.estimate.mean_curve`.
    noise : (4, 4) array
        Covariance of theta by noise.
    stated : (4, 4) array
        Covariance of theta by what is stated as uncertain.
    rate_rad_s : float
        c of the curve.
    has_sine : bool
    span_s : (start, stop)
        The segment [s].
    commanded : float
        Rate that the channel should read [deg/s].
    """
    terms = mean_rate_terms(*span_s, rate_rad_s)

    def deviation(covariance: Array) -> float:
        return math.sqrt(max(0.0, float(terms @ covariance @ terms)))

    measured = float(terms @ theta)
    found = RateDifference(span_s[1] - span_s[0], measured, commanded, deviation(noise), deviation(stated))
    if not has_sine:
        return found
    part = theta[1:3]
    amplitude = math.hypot(*part)
    along = part / amplitude if amplitude else np.array([1.0, 0.0])
    covariance = (noise + stated)[1:3, 1:3]
    error = math.sqrt(max(0.0, float(along @ covariance @ along)))
    return replace(found, sine=amplitude, sine_err=error, sine_sigma=_length(part, covariance))


def _length(part: Array, covariance: Array) -> float:
    """Length of a vector in units of its covariance."""
    return math.sqrt(max(0.0, float(part @ np.linalg.pinv(covariance, hermitian=True) @ part)))


def over_segments(parts: list[RateDifference], noise: float, stated: float) -> RateDifference:
    """Of the whole run, with its errors by noise and by what is stated [deg/s]: neither simply adds up."""
    whole = math.fsum(part.duration_s for part in parts)

    def mean(values: list[float]) -> float:
        return math.fsum(v * part.duration_s for v, part in zip(values, parts, strict=True)) / whole

    measured, commanded = ([getattr(part, name) for part in parts] for name in ("measured", "commanded"))
    return RateDifference(whole, mean(measured), mean(commanded), noise, stated)
