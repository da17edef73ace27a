"""How likely the residuals of a mean curve are under white noise, flicker and a random walk of every size.

The likelihood is the restricted one: of what is left of consecutive bins when the curve's columns, which
absorb the lowest frequencies, are projected out. The lowest cosine modes of the residual enter with their
exact covariance; the higher ones, which the projection leaves alone, by their powers in bands. Flicker and
walk are counted in units of the white noise; its size follows from each residual.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.coloured import unit_forms
from fogreduce.physics.noise import flicker_density

Array = NDArray[np.float64]

_MODES = 24  # lowest modes, whose covariance is exact
_BANDS = 12  # bands of the higher modes
_WHOLE = 0.5  # a combination of modes of which the projection leaves this part or more is kept
_STEP_FLICKER, _STEP_WALK = 0.35, 0.35  # of the grids, in the logarithm of the variance
_LEAST = 0.01  # smallest flicker and walk: what they add over the whole span, in parts of the white noise
_FEWEST = 4.0  # independent residuals, from which on anything is said
_MOST = 10.0  # largest: what they add from bin to bin


@dataclass(frozen=True)
class NoiseGrid:
    """Sizes of flicker and walk that are looked at, as ratios to the white noise.

    Attributes
    ----------
    flicker : (f,) array
        B^2 over the white coefficient [1/s]; the first is 0.
    walk : (k,) array
        Walk coefficient over the white one [1/s^2]; the first is 0.
    """

    flicker: Array
    walk: Array

    @classmethod
    def of(cls, span_s: float, period_s: float) -> NoiseGrid:
        """For a record of `span_s` in bins of `period_s` [s]."""
        flicker = _geometric(_LEAST / span_s, _MOST / period_s, _STEP_FLICKER)
        walk = _geometric(_LEAST / span_s**2, _MOST / period_s**2, _STEP_WALK)
        return cls(np.concatenate(([0.0], flicker)), np.concatenate(([0.0], walk)))


def _geometric(low: float, high: float, step: float) -> Array:
    return np.geomspace(low, high, 2 + int(np.log(high / low) / step))


@dataclass(frozen=True)
class Likelihood:
    """Sums of the likelihood of several channels over a grid; those of several segments add.

    Attributes
    ----------
    squares : (channels, f, k) array
        Residual sum of squares in units of the covariance, for a white coefficient of 1.
    log_determinant : (channels, f, k) array
        Of that covariance.
    freedom : (channels,) array
        Number of independent residuals.
    """

    squares: Array
    log_determinant: Array
    freedom: Array

    @classmethod
    def summed(cls, parts: Sequence[Likelihood]) -> Likelihood:
        """Of several records of the same channels."""
        return cls(
            np.sum([part.squares for part in parts], axis=0),
            np.sum([part.log_determinant for part in parts], axis=0),
            np.sum([part.freedom for part in parts], axis=0),
        )

    def of_part(self, share: Array) -> Likelihood:
        """Where only a share (channels,) of the bins were readings, straight lines between them the rest."""
        whole = share[:, None, None]
        return Likelihood(self.squares, whole * self.log_determinant, share * self.freedom)

    @property
    def is_determined(self) -> NDArray[np.bool_]:
        """(channels,): which have residuals at all."""
        determined: NDArray[np.bool_] = (self.squares[:, 0, 0] > 0) & (self.freedom > _FEWEST)
        return determined

    def log(self, channel: int) -> tuple[Array, Array]:
        """Logarithm of a channel's likelihood, the white noise's size marginalised; and that size: (f, k)."""
        squares, freedom = self.squares[channel], self.freedom[channel]
        white = squares / (freedom - 2)
        likelihood: Array = -0.5 * (freedom * np.log(squares) + self.log_determinant[channel])
        return likelihood, white


def likelihood(grid: NoiseGrid, columns: Array, values: Array, period_s: float) -> Likelihood:
    """Of the residuals of bins.

    Parameters
    ----------
    grid : NoiseGrid
    columns : (p, m) array
        The curve's columns at consecutive bins.
    values : (channels, m) array
        Means of the bins, none missing; whether or not the curve is still in them makes no difference.
    period_s : float
        From bin to bin [s].
    """
    basis, _ = np.linalg.qr(columns.T)
    left = values - (values @ basis) @ basis.T
    m = columns.shape[1]
    modes = min(_MODES, m)
    cosines = _cosine_modes(m, modes)
    low = _outside(cosines, basis)
    white, flicker, walk = unit_forms(low, period_s)
    amplitudes = left @ low.T
    bands = _Bands.of(left, modes, period_s) if modes < m else None
    squares = np.empty((len(values), grid.flicker.size, grid.walk.size))
    determinant = np.empty(squares.shape[1:])
    for i, ratio in enumerate(grid.flicker):
        factor = np.linalg.inv(np.linalg.cholesky(white + ratio * flicker))
        walked, turn = np.linalg.eigh(factor @ walk @ factor.T)
        spread = 1.0 + np.outer(walked, grid.walk)
        squares[:, i] = (amplitudes @ factor.T @ turn) ** 2 @ (1.0 / spread)
        determinant[i] = np.log(spread).sum(axis=0) - 2.0 * np.log(np.diag(factor)).sum()
        if bands is not None:
            variance = bands.variances(ratio, grid.walk)
            squares[:, i] += bands.powers @ (1.0 / variance)
            determinant[i] += bands.counts @ np.log(variance)
    freedom = len(low) + (0 if bands is None else int(bands.counts.sum()))
    channels = len(values)
    return Likelihood(squares, np.array([determinant] * channels), np.full(channels, float(freedom)))


def _cosine_modes(m: int, modes: int) -> Array:
    """The lowest modes of the cosine transform, orthonormal: (modes, m)."""
    phase = np.outer(np.pi / m * np.arange(modes), np.arange(m) + 0.5)
    cosines: Array = np.cos(phase) * np.sqrt(2.0 / m)
    cosines[0] /= np.sqrt(2.0)
    return cosines


def _outside(cosines: Array, basis: Array) -> Array:
    """Combinations of the modes at right angles to the basis, orthonormal."""
    left = cosines - (cosines @ basis) @ basis.T
    size, turn = np.linalg.eigh(left @ left.T)
    kept = size > _WHOLE**2
    combinations: Array = (turn[:, kept] / np.sqrt(size[kept])).T @ left
    return combinations


@dataclass(frozen=True)
class _Bands:
    """Bands of the higher modes.

    Attributes
    ----------
    counts : (bands,) array
        Modes in each.
    powers : (channels, bands) array
        Sums of squares of the residuals' modes in each.
    white, flicker, walk : (bands,) arrays
        Mean variance of a mode by unit noise of each kind.
    """

    counts: Array
    powers: Array
    white: Array
    flicker: Array
    walk: Array

    @classmethod
    def of(cls, left: Array, first: int, period_s: float) -> _Bands:
        """Of residuals (channels, m), from mode `first` on."""
        m = left.shape[1]
        edges = np.unique(np.round(np.geomspace(first, m, _BANDS + 1)).astype(np.intp))
        starts = edges[:-1] - first
        mode = np.arange(first, m)
        counts = np.diff(edges).astype(np.float64)
        frequency = mode / (2.0 * m * period_s)
        # a bin's mean has flicker's spectrum times sinc^2; one-sided density over twice the period
        flicker = np.sinc(frequency * period_s) ** 2 * flicker_density(1.0, frequency) / (2.0 * period_s)
        # the cosine transform makes a walk's differences, and so the walk, diagonal
        walk = period_s / (4.0 * np.sin(np.pi * mode / (2 * m)) ** 2)
        # that transform is that of the residual and its mirror image
        mirrored = np.fft.rfft(np.concatenate((left, left[:, ::-1]), axis=1), axis=1)[:, first:m]
        squares = (mirrored * np.exp(-0.5j * np.pi / m * mode)).real ** 2 / (2 * m)
        return cls(
            counts,
            np.add.reduceat(squares, starts, axis=1),
            np.full(counts.size, 1.0 / period_s),
            np.add.reduceat(flicker, starts) / counts,
            np.add.reduceat(walk, starts) / counts,
        )

    def variances(self, flicker: float, walk: Array) -> Array:
        """Of a mode in each band, for a white coefficient of 1: (bands, k)."""
        variances: Array = (self.white + flicker * self.flicker)[:, None] + np.outer(self.walk, walk)
        return variances
