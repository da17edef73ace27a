"""The mean curve fitted by Levenberg-Marquardt: a check of the linear fit, and the fit with c free.

The linear fit (`fogreduce.estimate.mean_curve`) sums normal equations in one pass over the stream. Here the
same curve, ``m(t) = a + b sin(c t + d) + e t`` (the paper's eq. 7), is fitted to whole arrays by MINPACK's
Levenberg-Marquardt on residuals, from a Jacobian by QR: another algorithm, which may let c move too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.errors import FogreduceError
from fogreduce.estimate.mean_curve import HARDEST

Array = NDArray[np.float64]

_TOLERANCE = 4 * float(np.finfo(float).eps)
_MOST_STEPS = 200


@dataclass(frozen=True)
class FreeFit:
    """A mean curve fitted by Levenberg-Marquardt.

    Attributes
    ----------
    theta : (5,) array
        a, p = b sin d, q = b cos d, e, c; as `fogreduce.estimate.mean_curve.curve` takes them.
    covariance : (5, 5) array
        Of theta under white noise of standard deviation `sigma`; zero for c where it was held.
    sigma : float
        Residual sum of squares over (records - parameters fitted), its root.
    records : int
    evaluations : int
        How often the residuals were computed.
    """

    theta: Array
    covariance: Array
    sigma: float
    records: int
    evaluations: int


def fit_curve(time_s: Array, values: Array, rate_rad_s: float, *, free_rate: bool) -> FreeFit:
    """The least-squares mean curve of one channel over one segment.

    Parameters
    ----------
    time_s : (N,) array
        Times from the run's start [s].
    values : (N,) array
        Finite values in the channel's unit.
    rate_rad_s : float
        c [rad/s], the table's rate: held, or the start where `free_rate`. At 0 (a standstill) there is no
        sine, and a and e alone are fitted.
    free_rate : bool
        Whether c is fitted too; from the fit with c held, so that it starts in the right valley.

    Raises
    ------
    FogreduceError
        Where the iteration does not end, or the records do not determine the parameters.
    """
    scaled = _Scaled.of(time_s, values, rate_rad_s)
    free = [0, 3] if rate_rad_s == 0 else [0, 1, 2, 3]
    x, evaluations = _solve(scaled, np.zeros(5), free)
    if free_rate and rate_rad_s != 0:
        free = [0, 1, 2, 3, 4]
        x, more = _solve(scaled, x, free)
        evaluations += more
    return scaled.result(x, free, evaluations)


def _solve(scaled: _Scaled, start: Array, free: list[int]) -> tuple[Array, int]:
    """The scaled parameters with those in `free` fitted, and how many evaluations it took."""
    from scipy.optimize import least_squares  # costs a second to import: only who asks for this fit pays

    def spread(part: Array) -> Array:
        x = start.copy()
        x[free] = part
        return x

    found = least_squares(
        lambda part: scaled.residuals(spread(part)),
        start[free],
        jac=lambda part: scaled.jacobian(spread(part))[:, free],
        method="lm",
        ftol=_TOLERANCE,
        xtol=_TOLERANCE,
        gtol=_TOLERANCE,
        max_nfev=_MOST_STEPS,
    )
    if not found.success:
        raise FogreduceError(f"Levenberg-Marquardt: {found.message}")
    return spread(found.x), int(found.nfev)


@dataclass(frozen=True)
class _Scaled:
    """The problem in numbers near one: u = time from -1 to 1 about the middle, y = values about their mean.

    Parameters x: offset of the line in u, cosine and sine of c (t - middle), slope of the line in u, and
    (c - rate) half; y in units of `scale`.
    """

    u: Array
    y: Array
    middle: float
    half: float
    rate: float
    offset: float
    scale: float

    @classmethod
    def of(cls, time_s: Array, values: Array, rate_rad_s: float) -> _Scaled:
        if time_s.size < 6:
            raise FogreduceError(f"Levenberg-Marquardt: {time_s.size} records do not determine a mean curve")
        first, last = float(time_s.min()), float(time_s.max())
        middle, half = (first + last) / 2, (last - first) / 2
        offset, scale = float(np.mean(values)), float(np.std(values)) or 1.0
        return cls(
            (time_s - middle) / half, (values - offset) / scale, middle, half, rate_rad_s, offset, scale
        )

    def _phase(self, x: Array) -> Array:
        phase: Array = self.u * (self.rate * self.half + x[4])
        return phase

    def residuals(self, x: Array) -> Array:
        """Curve minus values."""
        phase = self._phase(x)
        left: Array = x[0] + x[1] * np.cos(phase) + x[2] * np.sin(phase) + x[3] * self.u - self.y
        return left

    def jacobian(self, x: Array) -> Array:
        """Derivatives of the residuals, (N, 5)."""
        phase = self._phase(x)
        cosine, sine = np.cos(phase), np.sin(phase)
        by_rate = self.u * (x[2] * cosine - x[1] * sine)
        return np.column_stack((np.ones_like(self.u), cosine, sine, self.u, by_rate))

    def result(self, x: Array, free: list[int], evaluations: int) -> FreeFit:
        """Back to theta, time from the run's start, the channel's own unit."""
        left, slopes = self.residuals(x), self.jacobian(x)[:, free]
        sigma = math.sqrt(float(left @ left) / (left.size - len(free)))
        triangle = np.linalg.qr(slopes, mode="r")
        if np.linalg.cond(triangle) > HARDEST:
            raise FogreduceError("Levenberg-Marquardt: the records do not determine the parameters")
        inverse = np.linalg.inv(triangle)
        covariance = np.zeros((5, 5))
        covariance[np.ix_(free, free)] = sigma**2 * (inverse @ inverse.T)
        rate = self.rate + x[4] / self.half
        cosine, sine = math.cos(rate * self.middle), math.sin(rate * self.middle)
        slope = x[3] / self.half
        a, p, q = x[0] - slope * self.middle, x[1] * cosine - x[2] * sine, x[1] * sine + x[2] * cosine
        turn = np.zeros((5, 5))  # d theta / d x, before the values' scale
        turn[0, [0, 3]] = 1.0, -self.middle / self.half
        turn[1, [1, 2, 4]] = cosine, -sine, -q * self.middle / self.half
        turn[2, [1, 2, 4]] = sine, cosine, p * self.middle / self.half
        turn[3, 3] = 1.0 / self.half
        turn[4, 4] = 1.0 / self.half
        units = np.array([self.scale, self.scale, self.scale, self.scale, 1.0])
        theta = units * np.array([a, p, q, slope, rate])
        theta[0] += self.offset
        turn *= units[:, None]
        return FreeFit(theta, turn @ covariance @ turn.T, self.scale * sigma, left.size, evaluations)
