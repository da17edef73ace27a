"""Stage 5, fit: the mean curve (eq. 7 to 9) of each gyro's raw readings and of x, y, z, and the run in bins.

Each segment of constant rate is fitted on its own. Records within a guard of an edge between two rates are
left out: a stamp rounded to the microsecond, or a table that takes time to change, must not leak in.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import EARTH_RATE_DEG_S
from fogreduce.datasets.flags import UNUSABLE_AXES, UNUSABLE_RECORD, RecordFlag
from fogreduce.estimate.bins import Bins, bin_size, bins_of
from fogreduce.estimate.coloured import ColouredNoise, correlated_covariance
from fogreduce.estimate.determined import NO_PHASE, has_phase, why_undetermined
from fogreduce.estimate.every_record import Geometries, patterns
from fogreduce.estimate.mean_curve import CurveBasis, CurveFit, CurveSums, curve
from fogreduce.estimate.rounding import correlation_time, systematic_variance
from fogreduce.estimate.uncertainty import StatedErrors, stated_covariance
from fogreduce.estimate.unstable import Unstable, unstable_intervals
from fogreduce.metadata.facts import RunFacts
from fogreduce.stages.curve_noise import CurveNoise
from fogreduce.stages.ingest import usable_gyros

NAME = "fit"

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

_CURVE_POINTS = 256  # at which a curve's range is looked for
_TOO_FEW = {4: "b and d: too few records", 2: "e: too few records", 1: ""}


@dataclass(frozen=True)
class Segment:
    """A segment of constant commanded rate, the curve's basis on it and the sums of gyros and of axes.

    `complete` are the sums of x, y, z over complete records only, where `axes` holds the others too.
    """

    number: int
    start_s: float
    stop_s: float
    rate_deg_s: float
    basis: CurveBasis
    gyros: CurveSums
    axes: CurveSums
    complete: CurveSums
    answered: dict[bytes, int] = field(default_factory=dict)  # records by the gyros that answered


@dataclass(frozen=True)
class Rounding:
    """Variance of what rounding leaves in a channel's mean, and how long it stays like itself [s].

    `constant` is the variance of what is the same over the whole segment, where the value moves by
    less than a step.
    """

    variance: float
    time_s: float
    constant: float


@dataclass(frozen=True)
class ChannelFit:
    """A fitted curve and what its coefficients' covariance is by other accounts.

    Attributes
    ----------
    channel : str
    curve : CurveFit
        With the covariance of white noise.
    coloured : (4, 4) array or None
        Covariance of coloured noise and of rounding; None where there are too few bins to tell.
    rounding : (4, 4) array or None
        The part of it that is rounding's.
    noise : ColouredNoise or None
        What `coloured` rests on.
    stated : (4, 4) array or None
        Covariance that the stated uncertainties allow, noise not in it; None for a gyro's raw readings.
    has_phase : bool
        Whether there is a sine larger than its combined error.
    undetermined : str
        What the record does not determine, and why.
    """

    channel: str
    curve: CurveFit
    coloured: Array | None
    rounding: Array | None
    noise: ColouredNoise | None
    stated: Array | None
    has_phase: bool
    undetermined: str

    @property
    def terms(self) -> int:
        """Of the curve, as `CurveBasis.first` takes them."""
        return 4 if self.curve.has_sine else 2 if self.curve.has_slope else 1


@dataclass(frozen=True)
class SegmentFit:
    """The fits of one segment; None for a channel whose records do not determine a curve."""

    number: int
    start_s: float
    stop_s: float
    rate_deg_s: float
    channels: list[ChannelFit | None]
    complete: list[CurveFit | None]  # of x, y, z over complete records only


@dataclass(frozen=True)
class RunFits:
    """The fits of all segments, and the noise that their errors rest on."""

    channels: list[str]
    segments: list[SegmentFit]
    noise: CurveNoise


@dataclass
class Fit:
    """Fits a run, block by block.

    Parameters
    ----------
    facts : RunFacts
    channels : list of str
        Names of gyros, then axes (none for a unit of one or two gyros).
    n_records : int
        Records of the capture, for the size of a bin.
    block_records : int
    stated : StatedErrors
        What run.yaml and calibration record state as uncertain.
    guard_s : float
        Left out on both sides of an edge between two rates [s].
    complete_records : bool
        Whether x, y, z take only records in which every gyro answered; else see
        `fogreduce.estimate.every_record`.
    """

    facts: RunFacts
    channels: list[str]
    n_records: int
    block_records: int
    stated: StatedErrors
    guard_s: float
    complete_records: bool = True
    _gyro_bins: list[Bins] = field(default_factory=list)
    _axis_bins: list[Bins] = field(default_factory=list)

    def __post_init__(self) -> None:
        profile = self.facts.profile
        edges = profile.edges_s.tolist()
        n = self.facts.n_gyros
        self.segments = []
        for k, rate in enumerate(profile.rate_deg_s.tolist()):
            basis = CurveBasis.of(edges[k], edges[k + 1], rate)
            axes = len(self.channels) - n
            sums = CurveSums(basis, n), CurveSums(basis, axes), CurveSums(basis, axes)
            self.segments.append(Segment(k + 1, edges[k], edges[k + 1], rate, basis, *sums))
        self._geometries = Geometries(self.facts.axes, self.facts.white_noise)
        self._size = bin_size(self.n_records, self.facts.sample_rate_hz, self.block_records)

    @property
    def bin_s(self) -> float:
        """Length of a bin [s]."""
        return self._size / self.facts.sample_rate_hz

    def add(
        self,
        time_s: Array,
        flag: NDArray[np.uint8],
        gyro_flag: NDArray[np.uint8],
        raw: Array,
        rates: Array | None,
    ) -> None:
        """Add a block: times [s] (N,), flags (N,) and (n, N), readings (n, N), rates (3, N) or None."""
        usable = usable_gyros(flag, gyro_flag)
        middle_s = _mended(time_s, flag)
        self._gyro_bins.append(bins_of(middle_s, raw, usable, self._size))
        complete = weight = None
        if rates is not None:
            if usable is not None:
                complete = np.broadcast_to((flag & UNUSABLE_AXES) == 0, rates.shape)
                weight = complete if self.complete_records else self._weight(flag, gyro_flag)
            counted = None if weight is None else weight > 0
            self._axis_bins.append(bins_of(middle_s, rates, counted, self._size))
        for segment in self.segments:
            inside = slice(None) if len(self.segments) == 1 else self.inside(segment, time_s)
            columns = segment.basis.columns(time_s[inside])
            segment.gyros.add(columns, raw[:, inside], _part(usable, inside))
            if rates is not None:
                segment.axes.add(columns, rates[:, inside], _part(weight, inside))
                if not self.complete_records:
                    segment.complete.add(columns, rates[:, inside], _part(complete, inside))
                    self._count(segment, gyro_flag[:, inside], flag[inside])

    def _weight(self, flag: NDArray[np.uint8], gyro_flag: NDArray[np.uint8]) -> Array:
        """Weight of each record in the curves of x, y, z, (3, N): 1 where every gyro answered."""
        weight = np.zeros((3, flag.size))
        for there, records in patterns(gyro_flag == 0):
            geometry = self._geometries.of(there)
            if geometry is not None:
                weight[:, records] = geometry.weight[:, None]
        weight[:, (flag & UNUSABLE_RECORD) != 0] = 0.0
        return weight

    def _count(self, segment: Segment, gyro_flag: NDArray[np.uint8], flag: NDArray[np.uint8]) -> None:
        """Records of a segment by the gyros that answered."""
        for there, records in patterns(gyro_flag[:, (flag & UNUSABLE_RECORD) == 0] == 0):
            key = there.tobytes()
            segment.answered[key] = segment.answered.get(key, 0) + records.size

    def inside(self, segment: Segment, time_s: Array) -> Mask:
        """Which times lie in a segment, the guard of the edges between segments left out."""
        first, last = segment.number == 1, segment.number == len(self.segments)
        low = -np.inf if first else segment.start_s + self.guard_s
        high = np.inf if last else segment.stop_s - self.guard_s
        inside: Mask = (time_s >= low) & (time_s < high)
        return inside

    def bins(self) -> Bins:
        """The whole run in bins, all channels."""
        gyros = Bins.joined(self._gyro_bins)
        return gyros.stacked(Bins.joined(self._axis_bins)) if self._axis_bins else gyros

    def unstable(self, bins: Bins, threshold: float, min_duration_s: float) -> list[Unstable]:
        """Intervals in which a gyro is unstable, see `unstable_intervals`."""
        n = self.facts.n_gyros
        # A bin that holds an edge between two rates scatters by the step: it says nothing of the gyro.
        whole = np.logical_or.reduce([self._holds(segment, bins.time_s) for segment in self.segments])
        count = np.where(whole, bins.count[:n], 0.0)
        return unstable_intervals(bins.time_s, count, bins.scatter[:n], threshold, min_duration_s)

    def _holds(self, segment: Segment, time_s: Array) -> Mask:
        """Which bins, by their middles [s], lie wholly in a segment, guards left out."""
        half = self.bin_s / 2
        return self.inside(segment, time_s - half) & self.inside(segment, time_s + half)

    def fits(self, bins: Bins) -> RunFits:
        """The fitted curves of every segment."""
        noise = CurveNoise(
            self.facts,
            bins,
            self.bin_s,
            [
                (segment.basis, self._holds(segment, bins.time_s), self._facts_of(segment).projection)
                for segment in self.segments
            ],
        )
        segments = [
            SegmentFit(
                segment.number,
                segment.start_s,
                segment.stop_s,
                segment.rate_deg_s,
                self._channel_fits(segment, noise),
                self._complete_fits(segment),
            )
            for segment in self.segments
        ]
        return RunFits(self.channels, segments, noise)

    def _channel_fits(self, segment: Segment, noise: CurveNoise) -> list[ChannelFit | None]:
        steps = self._rounding_of_gyros(segment)
        facts = self._facts_of(segment)
        stated = cache(partial(stated_covariance, facts, self.stated, segment.number))
        return [
            self._channel_fit(segment, channel, noise, self._rounding(channel, steps), stated)
            for channel in range(len(self.channels))
        ]

    def _complete_fits(self, segment: Segment) -> list[CurveFit | None]:
        """The curves of x, y, z over complete records only, as many terms as with all records."""
        sums = segment.axes if self.complete_records else segment.complete
        return [
            sums.fit(k, len(segment.basis.whiten)) for k in range(len(self.channels) - self.facts.n_gyros)
        ]

    def _facts_of(self, segment: Segment) -> RunFacts:
        """The run's facts, with the projection of the gyros that answered in most records of a segment."""
        if not segment.answered:
            return self.facts
        most = max(segment.answered, key=lambda key: segment.answered[key])
        geometry = self._geometries.of(np.frombuffer(most, bool))
        return self.facts if geometry is None else replace(self.facts, projection=geometry.projection)

    def _rounding_of_gyros(self, segment: Segment) -> list[Rounding]:
        """What rounding to counts leaves in the mean of each gyro."""
        found, step = [], self.facts.least_count
        duration = segment.stop_s - segment.start_s
        time_s = np.linspace(segment.start_s, segment.stop_s, _CURVE_POINTS)
        for gyro in range(self.facts.n_gyros):
            fitted = segment.gyros.fit(gyro)
            variance = 0.0 if fitted is None else systematic_variance(step, fitted.sigma)
            moved = 0.0 if fitted is None else float(np.ptp(curve(time_s, fitted.with_rate)))
            constant = variance if moved < step else 0.0
            found.append(Rounding(variance, correlation_time(step, moved, duration), constant))
        return found

    def _rounding(self, channel: int, of_gyros: list[Rounding]) -> Rounding:
        """The same of any channel: an axis has that of all gyros, by H, independent of each other."""
        n = self.facts.n_gyros
        if channel < n:
            return of_gyros[channel]
        assert self.facts.projection is not None
        squares = (self.facts.projection[channel - n] / self.facts.scale_factor) ** 2
        variance = float(squares @ [each.variance for each in of_gyros])
        constant = float(squares @ [each.constant for each in of_gyros])
        return Rounding(variance, max(each.time_s for each in of_gyros), constant)

    def _channel_fit(
        self,
        segment: Segment,
        channel: int,
        noise: CurveNoise,
        rounding: Rounding,
        stated: Callable[[int], Array],
    ) -> ChannelFit | None:
        """The curve of a channel with as many terms as its records determine."""
        n = self.facts.n_gyros
        basis = segment.basis
        duration = segment.stop_s - segment.start_s
        turn = segment.rate_deg_s * duration
        largest = EARTH_RATE_DEG_S * (abs(self.facts.scale_factor[channel]) if channel < n else 1.0)
        reasons = []
        if segment.rate_deg_s and not basis.has_sine:
            reasons.append(f"b and d: {abs(turn):.4g} deg of turn do not tell a sine from a line")
        tells = noise.tells(segment.number - 1, channel)
        rounded = coloured = None
        for terms in (4, 2, 1) if basis.has_sine else (2, 1):
            sums, index = (segment.gyros, channel) if channel < n else (segment.axes, channel - n)
            fitted = sums.fit(index, terms)
            if fitted is None:
                reasons.append(_TOO_FEW[terms])
                continue
            covariance = fitted.covariance
            if tells:
                rounded = self._rounded(segment, noise, terms, rounding)
                coloured = noise.covariance(segment.number - 1, channel, terms)
                coloured = covariance = coloured if rounded is None else coloured + rounded
            reason = why_undetermined(fitted, covariance, largest, turn, duration)
            if not reason:
                break
            reasons.append(reason)
        else:
            return None
        allowed = stated(terms)[channel - n] if channel >= n else None
        phase = has_phase(fitted, covariance if allowed is None else covariance + allowed)
        if fitted.has_sine and not phase:
            reasons.append(NO_PHASE)
        return ChannelFit(
            self.channels[channel],
            fitted,
            coloured,
            rounded,
            noise.of_channel(channel, segment.number - 1).mean if tells else None,
            allowed,
            phase,
            "; ".join(filter(None, reasons)),
        )

    def _rounded(self, segment: Segment, noise: CurveNoise, terms: int, rounding: Rounding) -> Array | None:
        """Covariance of theta by rounding to counts; None where there is none."""
        if not rounding.variance > 0:
            return None
        rows = noise.segments[segment.number - 1].rows(terms)
        rounded = correlated_covariance(rows, rounding.variance, rounding.time_s, self.bin_s)
        rounded[0, 0] += rounding.constant
        return rounded


def _mended(time_s: Array, flag: NDArray[np.uint8]) -> Array:
    """Times with wrong stamps put between their neighbours', so that they move no bin."""
    wrong = (flag & RecordFlag.BAD_STAMP) != 0
    if not wrong.any() or wrong.all():
        return time_s
    index = np.arange(time_s.size)
    mended: Array = np.where(wrong, np.interp(index, index[~wrong], time_s[~wrong]), time_s)
    return mended


def _part(usable: Mask | Array | None, inside: slice | Mask) -> Mask | Array | None:
    return None if usable is None else usable[:, inside]
