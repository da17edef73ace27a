"""The mean curve ``m(t) = a + b sin(c t + d) + e t`` (the paper's eq. 7, 8) by linear least squares.

With c held, the curve is linear in ``theta = (a, p, q, e)``, ``p = b sin d`` and ``q = b cos d``:
``m = a + p cos(c t) + q sin(c t) + e t``, t from the run's start. The sums are formed in one pass over
the stream, in a basis that is orthonormal over the segment beforehand, so that normal equations lose no
digits.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.propagation import propagated, standard_uncertainties

Array = NDArray[np.float64]

_GRID = 512  # points on which the basis is made orthonormal

#: Condition beyond which sine and straight line cannot be told apart in double precision.
HARDEST = 1e9


def curve(time_s: Array, theta: Array) -> Array:
    """The mean curve at times [s]; `theta` = (a, p, q, e, c), see the module's docstring."""
    a, p, q, e, c = theta
    phase = c * time_s
    return a + p * np.cos(phase) + q * np.sin(phase) + e * time_s


def curve_integral(time_s: Array, theta: Array) -> Array:
    """Integral of `curve` from 0 to each time [s]."""
    return integral_terms(time_s, float(theta[4])).T @ theta[:4]


def integral_terms(time_s: Array, rate_rad_s: float) -> Array:
    """Integrals from 0 to t of 1, cos(c t), sin(c t), t: (4, N); `curve_integral` weights them by theta."""
    time_s = np.atleast_1d(time_s)
    if rate_rad_s == 0:
        return np.array([time_s, time_s, np.zeros_like(time_s), time_s**2 / 2])
    phase = rate_rad_s * time_s
    # 1 - cos(x) = 2 sin^2(x/2) keeps its digits for a slow turn.
    return np.array(
        [time_s, np.sin(phase) / rate_rad_s, 2 * np.sin(phase / 2) ** 2 / rate_rad_s, time_s**2 / 2]
    )


@dataclass(frozen=True)
class CurveBasis:
    """Basis of the mean curve over one segment of constant rate.

    Attributes
    ----------
    start_s, stop_s : float
        The segment [s] from the run's start.
    rate_rad_s : float
        c, the table's rate [rad/s], signed.
    whiten : (k, k) array
        Takes the raw columns (1, u, cos, sin of time from the middle) to the orthonormal ones.
    to_theta : (4, k) array
        Takes coefficients in the orthonormal basis to theta = (a, p, q, e).
    """

    start_s: float
    stop_s: float
    rate_rad_s: float
    whiten: Array
    to_theta: Array

    @classmethod
    def of(cls, start_s: float, stop_s: float, rate_deg_s: float) -> CurveBasis:
        """For the segment from `start_s` to `stop_s` [s] at a table rate [deg/s]."""
        rate = math.radians(rate_deg_s)
        middle, half = (start_s + stop_s) / 2, (stop_s - start_s) / 2
        grid = middle + half * np.linspace(-1, 1, _GRID)
        has_sine = rate != 0
        triangle = np.linalg.qr(_raw(grid, middle, half, rate, has_sine).T, mode="r")
        if has_sine and np.linalg.cond(triangle) > HARDEST:
            has_sine = False
            triangle = np.linalg.qr(_raw(grid, middle, half, rate, has_sine).T, mode="r")
        whiten = np.linalg.inv(triangle).T * np.sqrt(_GRID)
        cosine, sine = math.cos(rate * middle), math.sin(rate * middle)
        # raw -> theta: u = (t - middle) / half; cosine and sine of c (t - middle) by the addition theorem
        raw_to_theta = np.array(
            [
                [1.0, -middle / half, 0.0, 0.0],
                [0.0, 0.0, cosine, -sine],
                [0.0, 0.0, sine, cosine],
                [0.0, 1.0 / half, 0.0, 0.0],
            ]
        )[:, : 4 if has_sine else 2]
        return cls(start_s, stop_s, rate, whiten, raw_to_theta @ whiten.T)

    @property
    def has_sine(self) -> bool:
        """Whether the model has a sine: not at a standstill, nor in a turn too short to show one."""
        return len(self.whiten) == 4

    def first(self, terms: int) -> CurveBasis:
        """The basis of the first terms alone: 4 with the sine, 2 a straight line, 1 a constant."""
        return replace(self, whiten=self.whiten[:terms, :terms], to_theta=self.to_theta[:, :terms])

    def columns(self, time_s: Array) -> Array:
        """Orthonormal columns at times [s] (N,): (k, N)."""
        middle, half = (self.start_s + self.stop_s) / 2, (self.stop_s - self.start_s) / 2
        raw = _raw(time_s, middle, half, self.rate_rad_s, self.has_sine)
        return self.whiten @ raw[: len(self.whiten)]


def _raw(time_s: Array, middle: float, half: float, rate: float, has_sine: bool) -> Array:
    """Columns 1, u and, with a sine, cos and sin of c (t - middle): (k, N)."""
    columns = np.empty((4 if has_sine else 2, len(time_s)))
    columns[0] = 1.0
    np.subtract(time_s, middle, out=columns[1])
    if has_sine:
        phase = columns[1] * rate
        np.cos(phase, out=columns[2])
        np.sin(phase, out=columns[3])
    columns[1] /= half
    return columns


@dataclass(frozen=True)
class CurveFit:
    """A fitted mean curve of one channel over one segment.

    Attributes
    ----------
    theta : (4,) array
        a, p = b sin d, q = b cos d, e; p and q zero where the model has no sine.
    covariance : (4, 4) array
        Of theta under white noise of standard deviation `sigma` a sample.
    sigma : float
        Standard deviation of one sample about the curve (residual sum of squares over records - parameters).
    records : int
        Records used.
    has_sine, has_slope : bool
        Whether the model has a sine, and a slope.
    rate_rad_s : float
        c.
    scatter : float
        Standard deviation of the values themselves, about their mean.
    """

    theta: Array
    covariance: Array
    sigma: float
    records: int
    has_sine: bool
    has_slope: bool
    rate_rad_s: float
    scatter: float

    @property
    def with_rate(self) -> Array:
        """Theta with c as fifth element, as `curve` takes it."""
        return np.append(self.theta, self.rate_rad_s)


def phase_jacobian(theta: Array) -> tuple[float, float, Array]:
    """From p = b sin d, q = b cos d: b >= 0, d in (-pi, pi], and their derivatives by theta (2, 4).

    Where b is 0, d is nothing and its derivatives are NaN.
    """
    p, q = float(theta[1]), float(theta[2])
    b, d = math.hypot(p, q), math.atan2(p, q)
    if d == -math.pi:
        d = math.pi
    jacobian = np.full((2, 4), math.nan)
    if b > 0:
        jacobian = np.array([[0.0, p / b, q / b, 0.0], [0.0, q / b**2, -p / b**2, 0.0]])
    return b, d, jacobian


def amplitude_and_phase(theta: Array, covariance: Array) -> tuple[float, float, float, float]:
    """From p = b sin d, q = b cos d: b >= 0, its standard error, d in (-pi, pi] and its standard error."""
    b, d, jacobian = phase_jacobian(theta)
    if b == 0:
        return b, math.nan, d, math.nan
    b_err, d_err = standard_uncertainties(propagated(jacobian[:, 1:3], covariance[1:3, 1:3])).tolist()
    return b, b_err, d, d_err


class CurveSums:
    """Sums for fits of several channels to one basis, added block by block.

    Parameters
    ----------
    basis : CurveBasis
    channels : int
    """

    def __init__(self, basis: CurveBasis, channels: int) -> None:
        k = len(basis.whiten)
        self.basis = basis
        self._zz = np.zeros((channels, k, k))
        self._zy = np.zeros((channels, k))
        self._yy = np.zeros(channels)
        self._records = np.zeros(channels, np.int64)
        self._reference = np.full(channels, np.nan)

    def add(self, columns: Array, values: Array, usable: NDArray[np.bool_] | Array | None) -> None:
        """Add records.

        Parameters
        ----------
        columns : (k, N) array
            The basis at the records' times.
        values : (channels, N) array
            Not changed. May be NaN where not usable.
        usable : (channels, N) array of bool or of float, or None
            Which values count, or with what weight (0 to 1, 1 that of a value of full accuracy); None = all.
        """
        if values.shape[1] == 0:
            return
        self._note_reference(values, usable)
        shifted = values - np.nan_to_num(self._reference)[:, None]
        records = values.shape[1]
        if usable is not None:
            # Few records are out of the ordinary: leave them out here, then add what counts of each channel.
            odd = np.flatnonzero(~(usable == 1).all(axis=0))
            records -= odd.size
            odd_columns, odd_shifted = columns[:, odd], shifted[:, odd]
            columns = columns.copy()
            columns[:, odd] = shifted[:, odd] = 0.0
            for channel in range(len(values)):
                has_records = usable[channel, odd] > 0
                if has_records.any():
                    root = np.sqrt(usable[channel, odd[has_records]])
                    part = root * odd_shifted[channel : channel + 1, has_records]
                    one = slice(channel, channel + 1)
                    self._add(root * odd_columns[:, has_records], part, one, int(has_records.sum()))
        self._add(columns, shifted, slice(None), records)

    def _add(self, columns: Array, values: Array, channels: slice, records: int) -> None:
        self._zz[channels] += columns @ columns.T
        self._zy[channels] += values @ columns.T
        self._yy[channels] += np.einsum("cn,cn->c", values, values)
        self._records[channels] += records

    def _note_reference(self, values: Array, usable: NDArray[np.bool_] | Array | None) -> None:
        """A value near each channel's mean, taken away before squares are summed."""
        for channel in np.flatnonzero(np.isnan(self._reference)):
            if usable is None:
                self._reference[channel] = values[channel, 0]
            elif usable[channel].any():
                self._reference[channel] = values[channel, int(np.argmax(usable[channel]))]

    def fit(self, channel: int, terms: int = 4) -> CurveFit | None:
        """The least-squares curve of a channel; None where its records do not determine one.

        `terms` as `CurveBasis.first` takes them: the columns of the basis build on each other.
        """
        basis = self.basis.first(terms)
        zz, zy = self._zz[channel][:terms, :terms], self._zy[channel][:terms]
        records = int(self._records[channel])
        k = len(zz)
        if records <= k or np.linalg.cond(zz) > HARDEST:
            return None
        inverse = np.linalg.inv(zz)
        beta = np.linalg.solve(zz, zy)
        left = float(self._yy[channel] - 2 * beta @ zy + beta @ zz @ beta)
        sigma = math.sqrt(max(left, 0.0) / (records - k))
        to_theta = basis.to_theta
        theta = to_theta @ beta
        theta[0] += self._reference[channel]
        covariance = sigma**2 * (to_theta @ inverse @ to_theta.T)
        about_mean = max(0.0, float(self._yy[channel] - zy[0] ** 2 / zz[0, 0])) / (records - 1)
        rate, scatter = self.basis.rate_rad_s, math.sqrt(about_mean)
        return CurveFit(theta, covariance, sigma, records, k == 4, k > 1, rate, scatter)
