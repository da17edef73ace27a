"""Part of stage 5: the noise of a run's gyros, and the covariance that it gives the fitted curves.

The noise of each gyro is a posterior over the sizes of white noise, flicker and random walk, of all segments
together. What x, y, z have follows through H: their noises are correlated, since they share the gyros.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.estimate.bins import Bins
from fogreduce.estimate.coloured import ColouredNoise, combined, unit_forms
from fogreduce.estimate.mean_curve import CurveBasis
from fogreduce.estimate.noise_grid import Likelihood, NoiseGrid, likelihood
from fogreduce.estimate.noise_posterior import NoisePosterior, posteriors
from fogreduce.metadata.facts import RunFacts

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

LEAST_BINS = 16  # fewer do not tell coloured noise from white
_WORST_BASIS = 1e7  # condition of the basis at the bins: stamps beyond it are so wrong that no error holds
_MOST_SEGMENTS = 8  # the longest: noise is learnt from no more than these
_SURE = 4.0  # standard errors from which on a correlation of two gyros is believed


@dataclass(frozen=True)
class SegmentBins:
    """The bins of a segment of constant rate.

    Attributes
    ----------
    inside : (m,) array of bool
        Which bins of the run.
    basis : CurveBasis
    columns : (k, b) array
        The basis at those bins.
    values : (n, b) array
        Rates by the gyros' own scale factors [deg/s]; where a bin has none, between its neighbours.
    share : (n,) array
        Part of the bins in which a gyro has a value.
    projection : (3, n) array or None
        From the gyros' rates to x, y, z in most of its records; None for a unit of one or two gyros.
    """

    inside: Mask
    basis: CurveBasis
    columns: Array
    values: Array
    share: Array
    projection: Array | None

    @classmethod
    def of(
        cls, inside: Mask, basis: CurveBasis, bins: Bins, scale_factor: Array, projection: Array | None
    ) -> SegmentBins:
        """Of a run's bins, whose first channels are the gyros' raw readings; scale factors with polarity."""
        columns = basis.columns(bins.time_s[inside])
        mean = bins.mean[: scale_factor.size, inside]
        there = np.isfinite(mean)
        index = np.arange(mean.shape[1])
        values = np.zeros_like(mean)
        for i, (value, at) in enumerate(zip(mean, there, strict=True)):
            if at.any():
                values[i] = np.interp(index, index[at], value[at] / scale_factor[i])
        share = there.mean(axis=1) if index.size else np.zeros(len(mean))
        return cls(inside, basis, columns, values, share, projection)

    @property
    def holds(self) -> bool:
        """Whether there are bins enough, at times that determine the curve."""
        return self.columns.shape[1] >= LEAST_BINS and np.linalg.cond(self.columns) <= _WORST_BASIS

    @property
    def has_readings(self) -> Mask:
        """(n,): which gyros have bins enough."""
        enough: Mask = self.share * self.columns.shape[1] >= LEAST_BINS
        return enough

    def rows(self, terms: int) -> Array:
        """(4, b): the least-squares theta of a curve of so many terms is these times the bins."""
        columns = self.columns[: self.basis.first(terms).whiten.shape[0]]
        rows: Array = self.basis.first(terms).to_theta @ np.linalg.inv(columns @ columns.T) @ columns
        return rows


class CurveNoise:
    """Noise of the gyros in a run, and what it does to its curves.

    Parameters
    ----------
    facts : RunFacts
    bins : Bins
        The whole run; gyros first.
    bin_s : float
        Length of a bin [s].
    segments : sequence of (CurveBasis, (m,) array of bool, (3, n) array or None)
        Each segment's basis, which bins lie wholly in it, and its projection.

    Attributes
    ----------
    gyros : list of NoisePosterior
        Of the rates that the gyros read [deg/s].
    kinds : (3, n, n) array
        Covariance of the gyros' noises, of white noise, flicker and walk: diagonal, unless neighbouring bins
        show that gyros are correlated.
    """

    def __init__(
        self,
        facts: RunFacts,
        bins: Bins,
        bin_s: float,
        segments: Sequence[tuple[CurveBasis, Mask, Array | None]],
    ) -> None:
        self._facts, self._bin_s, self._bins = facts, bin_s, bins.time_s.size
        self.segments = [
            SegmentBins.of(inside, basis, bins, facts.polarity * facts.scale_factor, projection)
            for basis, inside, projection in segments
        ]
        learnt = sorted(
            (part for part in self.segments if part.holds), key=lambda part: -part.values.shape[1]
        )
        learnt = learnt[:_MOST_SEGMENTS]
        self.gyros = self._posteriors(learnt)
        sizes = np.array([[each.mean.white, each.mean.flicker, each.mean.walk] for each in self.gyros]).T
        correlation = _correlation(learnt, facts.n_gyros)
        self.kinds = np.sqrt(sizes[:, :, None] * sizes[:, None, :]) * correlation
        self.forms = cache(self._forms)

    def _posteriors(self, learnt: Sequence[SegmentBins]) -> list[NoisePosterior]:
        n = self._facts.n_gyros
        if not learnt:
            return [NoisePosterior.none()] * n
        span_s = max(part.values.shape[1] for part in learnt) * self._bin_s
        grid = NoiseGrid.of(span_s, self._bin_s)
        parts = [
            likelihood(grid, part.columns, part.values, self._bin_s).of_part(part.share) for part in learnt
        ]
        whole = Likelihood.summed(parts)
        flicker, walk = self._facts.bias_instability, self._facts.rate_random_walk
        return posteriors(
            grid,
            whole,
            None if flicker is None else (flicker / SECONDS_PER_HOUR) ** 2,
            # deg/h/sqrt(h): deg/h in an hour
            None if walk is None else (walk / SECONDS_PER_HOUR) ** 2 / SECONDS_PER_HOUR,
        )

    def tells(self, segment: int, channel: int) -> bool:
        """Whether a channel's noise is known in a segment (counted from 0): of an axis, that of all gyros."""
        part, n = self.segments[segment], self._facts.n_gyros
        if channel < n:
            return part.holds and bool(part.has_readings[channel])
        assert part.projection is not None
        return part.holds and bool(part.has_readings[part.projection.any(axis=0)].all())

    def of_axes(self, segment: int) -> Array:
        """(3, 3, 3): covariance of the noises of x, y, z, of each kind of noise [deg/s]."""
        projection = self.segments[segment].projection
        assert projection is not None
        axes: Array = projection @ self.kinds @ projection.T
        return axes

    def of_channel(self, channel: int, segment: int) -> NoisePosterior:
        """Of a channel, gyros first, in a segment and in the channel's unit.

        An axis' spread takes the gyros to err together, as they do where they are alike.
        """
        n = self._facts.n_gyros
        if channel < n:
            return self.gyros[channel].scaled(float(self._facts.scale_factor[channel]) ** 2)
        projection = self.segments[segment].projection
        assert projection is not None
        mean = ColouredNoise(*self.of_axes(segment)[:, channel - n, channel - n].tolist())
        weights = projection[channel - n] ** 2
        root = sum(w * _root(each.spread) for w, each in zip(weights, self.gyros, strict=True))
        return NoisePosterior(mean, root @ root.T)

    def _forms(self, segment: int, terms: int) -> Array:
        """(3, 4, 4): covariance of a curve's theta in a segment under unit noise of each kind."""
        part = self.segments[segment]
        forms = unit_forms(part.rows(terms), self._bin_s)
        # by its start the walk has gone somewhere, which is an offset
        forms[2, 0, 0] += np.flatnonzero(part.inside)[0] * self._bin_s
        return forms

    def covariance(self, segment: int, channel: int, terms: int) -> Array:
        """(4, 4): of theta of a channel, by the mean of what its noise may be."""
        return combined(self.forms(segment, terms), self.of_channel(channel, segment).mean)

    def across(self, segment: int, terms: Sequence[int]) -> Array:
        """(3, 4, 3, 4): covariance of theta of x, y, z together, each of so many terms."""
        part = self.segments[segment]
        kinds = self.of_axes(segment)
        if len(set(terms)) == 1:
            return np.einsum("kab,kij->aibj", kinds, self.forms(segment, terms[0]))
        rows = np.concatenate([part.rows(each) for each in terms])
        forms = unit_forms(rows, self._bin_s).reshape(3, len(terms), 4, len(terms), 4)
        forms[2, :, 0, :, 0] += np.flatnonzero(part.inside)[0] * self._bin_s
        return np.einsum("kab,kaibj->aibj", kinds, forms)

    def over_segments(
        self, weights: Callable[[int, int], tuple[int, Array]], are_axes: bool
    ) -> tuple[Array, Array]:
        """Noise of sums over all segments of functions of the curves.

        Parameters
        ----------
        weights : function
            From the number of the segment and of the channel, from 0, to the terms of its curve and the
            weights (4,) of that curve's theta.
        are_axes : bool
            Whether the channels are x, y, z; else they are the gyros, by their scale factors [deg/s].

        Returns
        -------
        covariance : (channels, channels) array
        spread : (channels,) array
            Variance of each channel's variance.
        """
        n = self._facts.n_gyros
        channels = 3 if are_axes else n
        rows = np.zeros((channels, n, self._bins))
        for k, part in enumerate(self.segments):
            shares = part.projection if are_axes else np.eye(n)
            assert shares is not None
            for channel in range(channels):
                terms, of_theta = weights(k, channel)
                rows[channel][:, part.inside] = np.outer(shares[channel], of_theta @ part.rows(terms))
        forms = unit_forms(rows.reshape(channels * n, -1), self._bin_s).reshape(3, channels, n, channels, n)
        covariance = np.einsum("kij,kaibj->ab", self.kinds, forms)
        unit = np.einsum("kaiai->aik", forms)
        # gyros that are alike err together
        spreads = [[gyro.variance_of(v) for gyro, v in zip(self.gyros, row, strict=True)] for row in unit]
        return covariance, np.sqrt(spreads).sum(axis=1) ** 2


def _root(covariance: Array) -> Array:
    """The symmetric square root."""
    size, turn = np.linalg.eigh(covariance)
    root: Array = (turn * np.sqrt(np.maximum(size, 0.0))) @ turn.T
    return root


def _correlation(parts: Sequence[SegmentBins], n: int) -> Array:
    """Correlation of the gyros' noises, by the differences of neighbouring bins; small ones count as none."""
    products, count = np.zeros((n, n)), 0
    for part in parts:
        basis, _ = np.linalg.qr(part.columns.T)
        steps = np.diff(part.values - (part.values @ basis) @ basis.T, axis=1)
        products += steps @ steps.T
        count += steps.shape[1]
    size = np.sqrt(np.diag(products))
    scale = np.outer(size, size)
    found = np.divide(products, scale, out=np.eye(n), where=scale > 0)
    # neighbouring differences share a bin, so that 1.5 times as many say as much
    found[np.abs(found) < _SURE * np.sqrt(1.5 / max(count, 1))] = 0.0
    np.fill_diagonal(found, 1.0)
    return found
