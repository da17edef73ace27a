"""Which parameters of a mean curve a record determines.

Over a short part of a turn sine, offset and slope are nearly the same function: their errors grow beyond
anything that was measured, and only their sum means something. Not determined is

- the sine, where its standard error exceeds Earth's rate, which is the largest that it can be beforehand, and
  where either it is not three of its errors large, so that leaving it out errs by less than its error, or its
  error exceeds the standard deviation of all values of the segment, so that the record says less of it than a
  single reading;
- the slope, where the error of its change over the segment, by white noise, exceeds that standard deviation.

The curve is then fitted without it.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.mean_curve import CurveFit, amplitude_and_phase

Array = NDArray[np.float64]

#: A sine of so many standard errors is seen, whatever its error.
_SEEN = 3.0
#: What is said of a sine that has no phase.
NO_PHASE = "d: b is no larger than its expanded error"
#: Amplitude in standard errors that 95 % of all sines of noise alone stay below: Rayleigh, sqrt(-2 ln 0.05).
_NOISE_STAYS_BELOW = math.sqrt(-2.0 * math.log(0.05))


def why_undetermined(
    fit: CurveFit, covariance: Array, largest_sine: float, turn_deg: float, duration_s: float
) -> str:
    """Why the last parameter of a curve, the sine or else the slope, is not determined; empty where it is.

    Parameters
    ----------
    fit : CurveFit
    covariance : (4, 4) array
        Of theta, by the noise that the residuals show.
    largest_sine : float
        The largest amplitude that the sine can have beforehand, in the channel's unit.
    turn_deg, duration_s : float
        How far the table turned in the segment, and how long it lasted.
    """
    if fit.has_sine:
        error = _largest_error(covariance[1:3, 1:3])
        b = amplitude_and_phase(fit.theta, covariance)[0]
        if error > largest_sine and (b < _SEEN * error or error > fit.scatter):
            return f"b and d: {abs(turn_deg):.4g} deg of turn and this noise do not tell the sine from a line"
    elif fit.has_slope and math.sqrt(fit.covariance[3, 3]) * duration_s > fit.scatter:
        return "e: too few records or too short a part of the segment"
    return ""


def has_phase(fit: CurveFit, covariance: Array) -> bool:
    """Whether the sine is larger than its expanded error by `covariance` (4, 4): else no phase is known."""
    if not fit.has_sine:
        return False
    b, error, _, _ = amplitude_and_phase(fit.theta, covariance)
    return b > _NOISE_STAYS_BELOW * error


def _largest_error(covariance: Array) -> float:
    """The largest standard error of b in any direction of its phase."""
    return math.sqrt(max(0.0, float(np.linalg.eigvalsh(covariance)[-1])))
