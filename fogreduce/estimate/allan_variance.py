"""Allan variance of a series with or without gaps: overlapping, modified and total.

Without gaps these are the definitions of NIST SP 1065 (eqs. 11, 17 and 25; Riley 2008), a rate's samples
taken as means over neighbouring intervals. A sample that is missing must neither end the series nor bias it:

* a mean over m intervals is that of the samples there, if at least half of them are and no hole in it is
  longer than m / 8;
* n samples of m, lost by chance, scatter about the mean of all m by ``(1/n - 1/m) S^2`` (sampling without
  replacement; S^2 is the variance within the m, which the n samples give without bias). That is taken away
  again, whatever the noise.

With gaps, windows of long averaging times are taken at every m / 32nd start: those between add nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Counts = NDArray[np.int64]
Mask = NDArray[np.bool_]

_BLOCK = (
    16384  # differences at a time, which stay in the processor's cache (and in one thread of its algebra)
)
_LEAST_PART = 0.5  # of a mean's samples that must be there
_LONGEST_HOLE = 8  # a hole may be as long as this part of a mean
_STARTS = 32  # windows begin at every m / 32nd sample where there are gaps


class Estimate(NamedTuple):
    """An Allan variance.

    Attributes
    ----------
    variance : float
        In the square of the data's unit; NaN where no window is whole enough. Of a series with gaps it may
        come out negative where it is not determined.
    windows : float
        Number of second differences that it is the mean of (of those at every start).
    part : float
        Those as a part of what a series without gaps has.
    inflation : float
        Expected square before the loss of samples within windows was taken away, over the
        variance: 1 or more.
    """

    variance: float
    windows: float
    part: float
    inflation: float


NOTHING = Estimate(np.nan, 0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Series:
    """Values at equal intervals, NaN where there is none, with the running sums that all means come from."""

    values: Array

    @cached_property
    def there(self) -> Mask | None:
        """Which values there are; None = all."""
        there = np.isfinite(self.values)
        return None if there.all() else there

    @cached_property
    def _centred(self) -> Array:
        """Values less their mean, 0 where there is none: their sums then stay small."""
        if self.there is None:
            return self.values - self.values.mean()
        found: Array = np.where(self.there, self.values, 0.0)
        if self.there.any():
            found -= found.sum() / np.count_nonzero(self.there)
            found[~self.there] = 0.0
        return found

    @cached_property
    def phase(self) -> Array:
        """Sum of the values before each place, (N + 1,)."""
        return _running(self._centred)

    @cached_property
    def squares(self) -> Array:
        """Sum of their squares."""
        return _running(self._centred**2)

    @cached_property
    def counts(self) -> Counts:
        """Number of values before each place."""
        there = np.ones(self.values.size, bool) if self.there is None else self.there
        return np.concatenate(([0], np.cumsum(there)))

    @cached_property
    def _holes(self) -> tuple[Counts, Counts]:
        """First places and lengths of the holes."""
        assert self.there is not None
        edges = np.flatnonzero(np.diff(np.concatenate(([True], self.there, [True])).astype(np.int8)))
        return edges[::2], np.diff(edges)[::2]

    @cached_property
    def _barred(self) -> dict[int, Counts]:
        return {}

    def barred(self, longest: int) -> Counts | None:
        """Number of places before each one that lie in holes longer than `longest`; None = there are none."""
        begin, length = self._holes
        long = length > longest
        number = int(np.count_nonzero(long))
        if number == 0:
            return None
        if number not in self._barred:
            steps = np.zeros(self.values.size + 1, np.int64)
            steps[begin[long]] = 1
            steps[begin[long] + length[long]] -= 1
            inside = np.cumsum(steps[:-1])
            self._barred.clear()
            self._barred[number] = np.concatenate(([0], np.cumsum(inside)))
        return self._barred[number]

    def mirrored(self, reach: int) -> Series:
        """The series with `reach` values mirrored before its start and after its end."""
        return Series(np.concatenate((self.values[:reach][::-1], self.values, self.values[::-1][:reach])))


def _running(values: Array | Mask) -> Array:
    return np.concatenate(([0.0], np.cumsum(values)))


def overlapping(series: Series, factor: int) -> Estimate:
    """Overlapping Allan variance at `factor` intervals (SP 1065, eq. 11)."""
    return _second_differences(series, factor, 0, series.values.size - 2 * factor + 1)


def total(series: Series, factor: int, extended: Series | None = None) -> Estimate:
    """Total variance at `factor` intervals, not corrected for its bias (SP 1065, eq. 25).

    `extended` is ``series.mirrored(reach)`` with a reach of `factor` or more, for whoever has it.
    """
    size = series.values.size
    if factor >= size:
        return NOTHING
    extended = series.mirrored(factor) if extended is None else extended
    reach = (extended.values.size - size) // 2
    # Windows whose middles are the phases between the series' first and its last.
    return _second_differences(extended, factor, reach + 1 - factor, size - 1)


def _second_differences(series: Series, m: int, start: int, windows: int) -> Estimate:
    """Half the mean square of differences of neighbouring means over m values, at `windows` starts."""
    if windows < 1:
        return NOTHING
    if series.there is None:
        whole = _sum_of_squares(series.phase[start : start + windows + 2 * m], m)
        return Estimate(whole / (2.0 * m * m * windows), float(windows), 1.0, 1.0)
    barred = series.barred(m // _LONGEST_HOLE)
    stride = max(1, m // _STARTS)
    at = np.arange(start + (windows - 1) % stride // 2, start + windows, stride)
    kept, squared, lost = 0.0, 0.0, 0.0
    if stride == 1:
        # Most windows have no hole: all of them at once, then those with one once more.
        squared = _sum_of_squares(series.phase[start : start + windows + 2 * m], m) / (2.0 * m * m)
        at = at[series.counts[at + 2 * m] - series.counts[at] < 2 * m]
        kept = float(windows - at.size)
        naive = series.phase[at + 2 * m] - 2.0 * series.phase[at + m] + series.phase[at]
        squared -= float(naive @ naive) / (2.0 * m * m)
    for i in range(0, at.size, _BLOCK):
        differences, loss, usable = _differences(series, barred, m, at[i : i + _BLOCK])
        kept += np.count_nonzero(usable)
        squared += float(differences @ differences) / 2.0
        lost += float(loss.sum())
    if kept == 0:
        return NOTHING
    part = kept / (windows if stride == 1 else at.size)
    return _without_loss(squared / kept, lost / kept, part, windows)


def _without_loss(square: float, lost: float, part: float, windows: int) -> Estimate:
    variance = square - lost
    inflation = square / variance if variance > 0 else np.inf
    return Estimate(variance, part * windows, part, max(1.0, inflation))


def _differences(series: Series, barred: Counts | None, m: int, at: Counts) -> tuple[Array, Array, Mask]:
    """Differences of neighbouring means, half the mean square that lost samples add, and which are usable."""
    counts = [series.counts[at + k * m] for k in range(3)]
    first, second = counts[1] - counts[0], counts[2] - counts[1]
    usable = np.minimum(first, second) >= max(1.0, _LEAST_PART * m)
    if barred is not None:
        usable &= barred[at + 2 * m] == barred[at]
    at, first, second = at[usable], first[usable], second[usable]
    phase = [series.phase[at + k * m] for k in range(3)]
    means = (phase[1] - phase[0]) / first, (phase[2] - phase[1]) / second
    loss = np.zeros(at.size)
    for k, (n, mean) in enumerate(zip((first, second), means, strict=True)):
        some = (n < m) & (n > 1)
        if some.any():
            n, begin = n[some], at[some] + k * m
            squares = series.squares[begin + m] - series.squares[begin]
            within = (squares - n * mean[some] ** 2) / (n - 1)
            loss[some] += 0.5 * (1.0 / n - 1.0 / m) * within
    return means[1] - means[0], loss, usable


def _sum_of_squares(phase: Array, m: int) -> float:
    """Sum of squares of second differences of a phase at m, block by block."""
    count = phase.size - 2 * m
    work, doubled = np.empty(min(count, _BLOCK)), np.empty(min(count, _BLOCK))
    found = 0.0
    for i in range(0, count, _BLOCK):
        size = min(_BLOCK, count - i)
        difference, middle = work[:size], doubled[:size]
        np.add(phase[i : i + size], phase[i + 2 * m : i + 2 * m + size], out=difference)
        np.multiply(phase[i + m : i + m + size], 2.0, out=middle)
        difference -= middle
        found += float(difference @ difference)
    return found


def modified(series: Series, factor: int) -> Estimate:
    """Modified Allan variance at `factor` intervals (SP 1065, eq. 17)."""
    m, size = factor, series.values.size
    windows = size - 3 * m + 2
    if windows < 1:
        return NOTHING
    if series.there is None:
        sums = _running(series.phase - series.phase.mean())
        squares = _sum_of_third_squares(sums, m)
        return Estimate(squares / (2.0 * float(m) ** 4 * windows), float(windows), 1.0, 1.0)
    # The same as a mean of m neighbouring differences of means, or of some of them evenly spaced.
    stride = max(1, m // _STARTS)
    at = np.arange((size - 2 * m) % stride // 2, size - 2 * m + 1, stride)
    steps = (series.phase[at + 2 * m] - 2.0 * series.phase[at + m] + series.phase[at]) / m
    touched = np.flatnonzero(series.counts[at + 2 * m] - series.counts[at] < 2 * m)
    lost, there = 0.0, np.ones(at.size, bool)
    barred = series.barred(m // _LONGEST_HOLE)
    for i in range(0, touched.size, _BLOCK):
        some = touched[i : i + _BLOCK]
        differences, loss, usable = _differences(series, barred, m, at[some])
        steps[some], there[some] = 0.0, usable
        steps[some[usable]] = differences
        lost += float(loss.sum())
    many = m // stride
    whole = _sums_of(many, _running(there))
    averaged = _sums_of(many, _running(steps))[whole == many] / many
    if averaged.size == 0:
        return NOTHING
    # Lost samples act as white noise does, whose modified variance is (1 + 1/m^2) / 2 of the other.
    lost *= 0.5 * (1.0 + 1.0 / many**2) / np.count_nonzero(there)
    square = float(averaged @ averaged) / (2.0 * averaged.size)
    return _without_loss(square, lost, averaged.size / whole.size, windows)


def _sums_of(many: int, running: Array) -> Array:
    """Sums of `many` neighbours, out of running sums."""
    return running[many:] - running[:-many]


def _sum_of_third_squares(sums: Array, m: int) -> float:
    count = sums.size - 3 * m
    found = 0.0
    for i in range(0, count, _BLOCK):
        size = min(_BLOCK, count - i)
        parts = [sums[i + k * m : i + k * m + size] for k in range(4)]
        difference = parts[1] - parts[2]
        difference *= 3.0
        difference += parts[3]
        difference -= parts[0]
        found += float(difference @ difference)
    return found


def spaced_factors(longest: int, per_decade: float) -> list[int]:
    """Whole numbers from 1 to `longest`, `per_decade` to a decade where there are so many."""
    if longest < 1:
        return []
    steps = int(np.floor(np.log10(longest) * per_decade + 1e-9))
    rounded = np.rint(10.0 ** (np.arange(steps + 1) / per_decade)).astype(int)
    return sorted(set(rounded.tolist()))
