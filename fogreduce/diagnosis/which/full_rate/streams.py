"""One run's residual as lines are looked for in it: less what is slow, its spectrum, a line taken out of it.

The straight path from samples to a spectrum is linear, so that a line of any frequency is fitted by what that
path makes of cosine and sine, exactly, and taken out of the samples themselves: leakage goes with it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.polynomial.legendre import legvander
from numpy.typing import NDArray

Array = NDArray[np.float64]
Complex = NDArray[np.complex128]

#: Lines are looked for above this [Hz]; what is slow goes in pieces of half its period's inverse.
LEAST_HZ = 1.0
_PIECE_S = 2.0
_CURVE = 3  # degree of the polynomial that goes: Earth's rate seen from a turning table bends within 2 s
_BURST = 4.0  # times the usual power of a piece: more is an edge or a glitch
_FIRST, _GROWS, _WIDEST = 64.0, 1.3, 512.0  # stretches of the noise floor, in resolved lines
#: How a line's amplitude and phase may change in a run: polynomials up to this degree.
ENVELOPE = 4
_TURNS = 64  # stretches of a run from which a frequency is told


@dataclass(frozen=True)
class Stream:
    """A gyro's residual in one run.

    Attributes
    ----------
    rate_hz : float
    residual : (N,) array
        Measured less predicted [deg/h]; NaN where a sample does not count.
    """

    rate_hz: float
    residual: Array

    @cached_property
    def there(self) -> NDArray[np.bool_]:
        """Which samples of `cut` count, (P, S): none of a piece with an edge or a glitch in it."""
        return self._pieces[1]

    @cached_property
    def cut(self) -> Array:
        """The residual less its polynomial in each piece, (P, S); 0 where it does not count."""
        return self._pieces[0]

    @cached_property
    def _pieces(self) -> tuple[Array, NDArray[np.bool_]]:
        size = max(int(self.rate_hz * _PIECE_S), 2 * _CURVE)
        whole = len(self.residual) // size * size
        values = self.residual[:whole].reshape(-1, size)
        there = np.isfinite(values)
        if not there.all():
            number = np.maximum(there.sum(axis=1, keepdims=True), 1)
            mean = np.where(there, values, 0.0).sum(axis=1, keepdims=True) / number
            values = np.where(there, values, mean)
        cut = _bent_straight(values)
        power = np.mean(cut**2, axis=1)
        calm = power <= _BURST * np.median(power) if power.size else np.zeros(0, bool)
        there = there & calm[:, None]
        return np.where(there, cut, 0.0), there

    @property
    def samples(self) -> float:
        """How many samples count."""
        return float(self.there.sum())

    def spectrum(self, padded: int, low: int, high: int) -> Complex:
        """Lines `low` to `high` of the spectrum padded to a length, of unit variance in each quadrature for
        white noise of 1 deg/h a sample.
        """
        flat = self.cut.ravel()
        lines: Complex = np.fft.rfft(flat, padded)[low:high] * np.sqrt(2.0 / max(self.samples, 1.0))
        return lines

    def turned(self, hz: float) -> tuple[Array, Complex]:
        """Middles [s] of stretches of the run, and the sum over each of samples times exp(-i w t)."""
        flat = self.cut.ravel()
        length = max(len(flat) // _TURNS, 1)
        count = len(flat) // length
        turn = 2.0 * np.pi * hz / self.rate_hz
        sums = flat[: count * length].reshape(count, length) @ np.exp(-1j * turn * np.arange(length))
        start: Array = np.arange(count, dtype=np.float64) * length
        return (start + 0.5 * length) / self.rate_hz, sums * np.exp(-1j * turn * start)

    def fitted(self, hz: float, degree: int = ENVELOPE) -> Array:
        """Coefficients (degree + 1, 2) [deg/h] of a line's cosine and sine, times Legendre polynomials."""
        shapes = _shapes(len(self.residual), hz / self.rate_hz, degree)
        pieces = _bent_straight(shapes[: self.cut.size].T.reshape(shapes.shape[1], *self.cut.shape))
        pieces *= self.there
        columns = pieces.reshape(len(pieces), -1)
        gram = columns @ columns.T
        gram += 1e-9 * np.trace(gram) / len(gram) * np.eye(len(gram)) + 1e-300 * np.eye(len(gram))
        return np.asarray(np.linalg.solve(gram, columns @ self.cut.ravel()).reshape(degree + 1, 2))

    def without(self, hz: float) -> tuple[Stream, Array]:
        """The stream less a line, and the line's coefficients; twice where samples are missing, for which
        means stand in.
        """
        fitted = self.fitted(hz)
        left = Stream(self.rate_hz, self.residual - self._line(hz, fitted))
        if np.isfinite(self.residual).all():
            return left, fitted
        more = left.fitted(hz)
        return Stream(self.rate_hz, left.residual - self._line(hz, more)), fitted + more

    def _line(self, hz: float, fitted: Array) -> Array:
        """Samples (N,) [deg/h] of a line with fitted coefficients."""
        line: Array = _shapes(len(self.residual), hz / self.rate_hz, len(fitted) - 1) @ fitted.ravel()
        return line


def _bent_straight(values: Array) -> Array:
    """Values (..., S) less the polynomial that fits them best along the last axis."""
    t = np.linspace(-1.0, 1.0, values.shape[-1])
    basis, _ = np.linalg.qr(np.vander(t, _CURVE + 1))
    result: Array = values - (values @ basis) @ basis.T
    return result


def _shapes(samples: int, turns: float, degree: int) -> Array:
    """Columns (N, 2 (degree + 1)): cosine and sine of `turns` a sample, times Legendre polynomials."""
    k: Array = np.arange(samples, dtype=np.float64)
    wave = np.exp(2j * np.pi * turns * k)
    slow = legvander(np.linspace(-1.0, 1.0, samples), degree)
    out = np.empty((samples, degree + 1, 2))
    np.multiply(slow, wave.real[:, None], out=out[:, :, 0])
    np.multiply(slow, wave.imag[:, None], out=out[:, :, 1])
    return out.reshape(samples, -1)


def noise_floor(lines: Complex, resolved: float) -> Array:
    """Variance of a quadrature (L,) near each line of a spectrum: what lines stand above.

    Parameters
    ----------
    lines : (L,) complex array
    resolved : float
        Lines of the spectrum that make one resolved.
    """
    size = len(lines)
    power = 0.5 * np.abs(lines) ** 2
    edges, width = [0], _FIRST
    while edges[-1] < size:
        edges.append(edges[-1] + max(round(width * resolved), 1))
        width = min(width * _GROWS, _WIDEST)
    edges[-1] = size
    if len(edges) > 2 and edges[-1] - edges[-2] < _FIRST * resolved:
        del edges[-2]
    middles = [0.5 * (a + b) for a, b in pairwise(edges)]
    # the median of exponential deviates is ln 2 of their mean
    levels = [float(np.median(power[a:b])) / np.log(2.0) for a, b in pairwise(edges)]
    logs = np.log(np.maximum(levels, 1e-300))
    floor: Array = np.exp(np.interp(np.arange(size), middles, logs))
    return floor
