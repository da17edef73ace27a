"""A filter of one pole fitted to the samples of a swing: time constant, delay, scale factor and bias.

The model is ``K y(t - d) + B``, y the response of `fogreduce.physics.low_pass` to the table's rate; readings
of increments are its means over their intervals. Squares of the samples are least after an autoregression of
what is left has whitened them (a filter colours the noise that passes it). Delay and time constant both make
the answer late; they are told apart by what each does to the edges' shape, the gain.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import solve_toeplitz
from scipy.optimize import least_squares, minimize_scalar

from fogreduce.estimate.swing import RateSteps
from fogreduce.physics.low_pass import of_steps

Array = NDArray[np.float64]

#: Terms of the autoregression: noise that passed the simulator's filter of 2.5 samples has a zero at 0.9 of
#: the unit circle, of which 32 terms leave 0.9^32 = 3 %.
_TERMS = 32
#: What is left beyond so many standard deviations is a spurious sample: of a normal one in 10^15 is.
_SPURIOUS = 8.0
_FEWEST = 10 * _TERMS
_COARSE = 4096  # samples of the first search
_TIMES = 8  # constants of the first search
_STARTS = 4
_LEAST = 1e-3  # time constant that stands for none, in samples
#: chi-square of one freedom that a one-sided probability of 95 % allows, 1.645^2.
_ONE_SIDED = 2.706
#: That two standard errors allow.
_SEEN = 4.0


@dataclass(frozen=True)
class OnePole:
    """What a swing says of a gyro.

    Attributes
    ----------
    tau_s, std_s : float
        Time constant and its standard error.
    delay_s : float
    scale : float
        K over the record's.
    bias_deg_s : float
    seen : bool
        Whether tau is larger than two of its errors, and fits better than none by as much.
    bound_s : float or None
        95 % upper bound of tau; None where the swing sets none.
    """

    tau_s: float
    std_s: float
    delay_s: float
    scale: float
    bias_deg_s: float
    seen: bool
    bound_s: float | None


@dataclass(frozen=True)
class Samples:
    """Samples (N,) of a gyro at equal intervals, and the motion along its axis.

    Attributes
    ----------
    time_s, rate : (N,) arrays
        Instants [s], readings [deg/s]; NaN where there is none.
    steps : RateSteps
        The table's rate.
    along : float
        What the gyro reads of 1 deg/s of it.
    half_s : float
        Half a period of the swing [s].
    averaged : bool
        Whether a reading is the mean over the interval before its instant.
    whitening : (p + 1,) array
        Of the noise, its first term 1.
    """

    time_s: Array
    rate: Array
    steps: RateSteps
    along: float
    half_s: float
    averaged: bool
    whitening: Array

    @property
    def step_s(self) -> float:
        """Time between samples [s]."""
        return float(self.time_s[-1] - self.time_s[0]) / (self.time_s.size - 1)

    @cached_property
    def white(self) -> Array:
        """Whitened readings; NaN where one that is needed is missing."""
        return self.whitened(self.rate)

    @cached_property
    def there(self) -> NDArray[np.bool_]:
        """Of which whitened readings there are."""
        return np.isfinite(self.white)

    def whitened(self, values: Array) -> Array:
        """Values (N,) after the whitening filter of k terms, (N - k + 1,)."""
        return np.convolve(values, self.whitening, mode="valid")

    def response(self, tau_s: float, delay_s: float) -> Array:
        """What the gyro reads of the table by its record [deg/s]."""
        edge, v = self.steps.edge_s, self.along * self.steps.rate_deg_s
        at = self.time_s - delay_s
        late = of_steps(edge, v, tau_s, at)
        if not self.averaged:
            return late
        # The integral of y is that of v less tau times what y gained.
        before = at - self.step_s
        turned = self.along * (self.steps.angle_at(at) - self.steps.angle_at(before))
        mean: Array = (turned - tau_s * (late - of_steps(edge, v, tau_s, before))) / self.step_s
        return mean

    def columns(self, tau_s: float, delay_s: float) -> Array:
        """Whitened response and constant, (2, m)."""
        white = self.whitened(self.response(tau_s, delay_s))[self.there]
        return np.vstack((white, np.full(white.size, self.whitening.sum())))

    def left(self, tau_s: float, delay_s: float) -> Array:
        """What the best scale factor and bias leave, whitened (m,)."""
        columns, target = self.columns(tau_s, delay_s), self.white[self.there]
        solved = np.linalg.solve(columns @ columns.T, columns @ target)
        left: Array = target - solved @ columns
        return left

    def squares(self, tau_s: float, delay_s: float) -> float:
        """Their sum of squares."""
        left = self.left(tau_s, delay_s)
        return float(left @ left)


def fit_one_pole(samples: Samples) -> tuple[Samples, OnePole] | None:
    """The filter that describes the samples best, and the samples without spurious ones; None if too few.

    Parameters
    ----------
    samples : Samples
        Whitening is found here; that of `samples` is where to start.
    """
    for _ in range(2):  # spurious samples first, then the noise's colour
        if np.count_nonzero(samples.there) < _FEWEST:
            return None
        starts = _starts(samples)
        if not starts:
            return None
        tau, delay = _best(samples, starts)
        left = samples.rate - _fitted(samples, tau, delay)
        spread = 1.4826 * float(np.nanmedian(np.abs(left)))
        spurious = np.abs(left) > max(_SPURIOUS * spread, 1e-12)
        samples = replace(samples, rate=np.where(spurious, np.nan, samples.rate))
    left = samples.rate - _fitted(samples, tau, delay)
    samples = replace(samples, whitening=_autoregression(left))
    if np.count_nonzero(samples.there) < _FEWEST:
        return None
    tau, delay = _best(samples, [(tau, delay)])
    return samples, _judged(samples, tau, delay)


def fitted(samples: Samples, pole: OnePole) -> Array:
    """What the fitted filter makes of the table's rate, (N,) [deg/s]."""
    return _fitted(samples, pole.tau_s, pole.delay_s)


def _starts(samples: Samples) -> list[tuple[float, float]]:
    """Time constants and delays [s] to begin with, by a search over the first samples."""
    few = replace(samples, time_s=samples.time_s[:_COARSE], rate=samples.rate[:_COARSE])
    step = samples.step_s
    found = [
        (few.squares(tau, delay), tau, delay)
        for tau in np.geomspace(step / 8, max(2 * samples.half_s, step), _TIMES).tolist()
        for delay in np.arange(-2 * step, samples.half_s, step / 2).tolist()
        # half a period later the same answer has the other sign
        if _linear(few, tau, delay)[0] > 0
    ]
    return [(tau, delay) for _, tau, delay in sorted(found)[:_STARTS]]


def _best(samples: Samples, starts: list[tuple[float, float]]) -> tuple[float, float]:
    step = samples.step_s
    most = 20 * samples.half_s / step
    found = [
        least_squares(
            lambda x: samples.left(x[0] * step, x[1] * step),
            (tau / step, delay / step),
            jac="3-point",
            bounds=((_LEAST, -np.inf), (most, np.inf)),
            x_scale="jac",
            xtol=1e-12,
            ftol=1e-12,
        )
        for tau, delay in starts
    ]
    tau, delay = min(found, key=lambda one: float(one.cost)).x.tolist()
    return tau * step, delay * step


def _fitted(samples: Samples, tau_s: float, delay_s: float) -> Array:
    scale, bias = _linear(samples, tau_s, delay_s)
    fitted: Array = scale * samples.response(tau_s, delay_s) + bias
    return fitted


def _linear(samples: Samples, tau_s: float, delay_s: float) -> tuple[float, float]:
    columns = samples.columns(tau_s, delay_s)
    scale, bias = np.linalg.solve(columns @ columns.T, columns @ samples.white[samples.there]).tolist()
    return scale, bias


def _autoregression(left: Array) -> Array:
    """Whitening filter of residuals (N,) by the Yule-Walker equations; a hole counts in no product."""
    there = np.isfinite(left)
    values = np.where(there, left - np.nanmean(left), 0.0)
    lags = range(_TERMS + 1)
    size = left.size
    products = [float(values[k:] @ values[: size - k]) for k in lags]
    numbers = [np.count_nonzero(there[k:] & there[: size - k]) for k in lags]
    covariance = np.array(products) / np.maximum(numbers, 1)
    if covariance[0] <= 0:
        return np.array([1.0])
    covariance[0] *= 1 + 1e-9
    return np.concatenate(([1.0], -solve_toeplitz(covariance[:-1], covariance[1:])))


def _judged(samples: Samples, tau_s: float, delay_s: float) -> OnePole:
    """Errors and bound, of noise whose variance is that of what is left."""
    scale, bias = _linear(samples, tau_s, delay_s)
    least = samples.squares(tau_s, delay_s)
    variance = least / (np.count_nonzero(samples.there) - 4 - samples.whitening.size + 1)
    step = samples.step_s
    by_tau, by_delay = 1e-3 * tau_s, 1e-4 * step
    slopes = [
        samples.columns(tau_s + by_tau, delay_s)[0] - samples.columns(tau_s - by_tau, delay_s)[0],
        samples.columns(tau_s, delay_s + by_delay)[0] - samples.columns(tau_s, delay_s - by_delay)[0],
    ]
    sizes = (2 * by_tau, 2 * by_delay)
    rows = np.vstack(
        (
            [scale * one / size for one, size in zip(slopes, sizes, strict=True)],
            samples.columns(tau_s, delay_s),
        )
    )
    lengths = np.linalg.norm(rows, axis=1)
    std = np.inf
    if (lengths > 0).all():
        rows /= lengths[:, None]
        inverse = np.linalg.pinv(rows @ rows.T, rcond=1e-14, hermitian=True)
        std = float(np.sqrt(variance * inverse[0, 0])) / float(lengths[0])
    gained = _least_squares(samples, _LEAST * step, tau_s + delay_s) - least
    seen = bool(tau_s > 2 * std and gained > _SEEN * variance)
    # From none on: a delay just short of a sample, at a tiny tau, fits the noise of one sample beside edges.
    allowed = least + max(gained, 0.0) + _ONE_SIDED * variance
    bound = None if seen else _bound(samples, tau_s, tau_s + delay_s, allowed)
    return OnePole(tau_s, std, delay_s, scale, bias, seen, bound)


def _least_squares(samples: Samples, tau_s: float, late_s: float) -> float:
    """Least sum of squares at a time constant, over delays around so late an answer."""
    step = samples.step_s
    delays = late_s - tau_s + step * np.linspace(-1.5, 1.5, 25)
    squares = [samples.squares(tau_s, delay) for delay in delays.tolist()]
    k = int(np.argmin(squares))
    around = (float(delays[max(k - 1, 0)]), float(delays[min(k + 1, delays.size - 1)]))
    closer = minimize_scalar(
        lambda delay: samples.squares(tau_s, delay),
        bounds=around,
        method="bounded",
        options={"xatol": 1e-6 * step},
    )
    return min(float(closer.fun), squares[k])


def _bound(samples: Samples, tau_s: float, late_s: float, allowed: float) -> float | None:
    """The largest time constant whose squares are allowed; None where half a period is."""
    low = high = max(tau_s, _LEAST * samples.step_s)
    while _least_squares(samples, high, late_s) <= allowed:
        low, high = high, 1.5 * high
        if low > samples.half_s:
            return None
    for _ in range(14):
        middle = (low * high) ** 0.5
        if _least_squares(samples, middle, late_s) <= allowed:
            low = middle
        else:
            high = middle
    return high
