"""How far the gap closes on blocks that were not fitted, with the causes simulated again.

Each run's blocks are dealt in turn to two folds; causes are fitted on one and held against the other, both
ways. What is summed are the squared deviates of what the causes change and, where something shows there
beside them, of the places of the gap and of departures from the causes' shapes: what shows nothing would add
noise alone. Noise and stated uncertainties are in their metric, weighed so that both folds together count as
all blocks do (`measure`). Beside them stand statistics of the full rate, each with twice the ln likelihood
that its cause gains.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.how_far.measure import Deviates, Part, deviates, scattered, shows
from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.departures import departures
from fogreduce.diagnosis.inference.evidence import WhitenedResidual
from fogreduce.diagnosis.inference.fitted import refined
from fogreduce.diagnosis.inference.model import changes_of, modelled, modelled_change
from fogreduce.diagnosis.inference.noise_model import Metric, Rows, Whitener, nuisances, whitener
from fogreduce.diagnosis.inference.problem import processes_of
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.observe.data import Data
from fogreduce.diagnosis.where.places import Place
from fogreduce.diagnosis.which.catalogue.converter import converter_means
from fogreduce.diagnosis.which.full_rate.statistics import FullRateStatistics

Array = NDArray[np.float64]
Key = tuple[str, tuple[str, ...], tuple[str, ...], str]

_MEASURE = (
    "squared normal deviates, noise and stated uncertainties in their metric, of the features in "
    "which the gap shows and of those that the causes change"
)
_DEALS = 300  # stretches of a run, dealt in turn: short ones, so that either fold knows when a bias stepped
_MOST_FEATURES = 30  # columns of one place


@dataclass(frozen=True)
class HeldOut:
    """One fold held against causes that were fitted on the other.

    Attributes
    ----------
    causes : tuple of Cause
        Those in block means, with the other fold's parameters.
    noisy, noisy_deviates : Part, Deviates
        The fold with the random processes among the causes in its noise.
    bare, bare_deviates : Part, Deviates
        Without them.
    """

    causes: tuple[Cause, ...]
    noisy: Part
    noisy_deviates: Deviates
    bare: Part
    bare_deviates: Deviates


@dataclass(frozen=True)
class Closure:
    """Sums over both folds.

    Attributes
    ----------
    measure, held_out : str
    before, after, expected : float
    noise : float
        Standard deviation of the fraction from noise.
    placebo : float or None
        The fraction that a wrong effect, fitted as hard, would close.
    folds : tuple of HeldOut
        Each fold as it was held against the causes.
    at_full_rate : mapping
        Key of a cause of the full rate -> its own before and after.
    departure : float
        What causes that are not quite of the catalogue's shapes may leave, or hide by parameters that take
        some of it up: a standard deviation of the fraction.
    departed : float
        The fraction that the causes' departures from their shapes would leave, each of one standard
        deviation.
    summed : Sum
        What `before` is the sum of.
    """

    measure: str
    held_out: str
    before: float
    after: float
    expected: float
    noise: float = 0.0
    placebo: float | None = None
    folds: tuple[HeldOut, ...] = ()
    at_full_rate: Mapping[Key, tuple[float, float]] = field(default_factory=dict)
    departure: float = 0.0
    departed: float = 0.0
    summed: Sum = field(default_factory=lambda: Sum())

    @property
    def fraction(self) -> float:
        """1 - (after - expected) / (before - expected); 0 where nothing was there."""
        gap = self.before - self.expected
        return 1.0 - (self.after - self.expected) / gap if gap > 0.0 else 0.0

    @property
    def std(self) -> float:
        """Its standard deviation: noise's, and departures'."""
        return float(np.hypot(self.noise, self.departure))


@dataclass
class Sum:
    """Squared deviates of both folds, and statistics of the full rate.

    The folds share stated uncertainties, and each has the noise of the other's fit: their errors add up as if
    they were one. Statistics of the full rate are on their own.
    """

    folds: list[tuple[Array, Array]] = field(default_factory=list)
    others: list[float] = field(default_factory=list)

    @property
    def value(self) -> float:
        """The sum."""
        return float(sum(z @ z for z, _ in self.folds) + sum(self.others))

    def add_fold(self, deviates: Deviates, y: Array) -> None:
        """A fold's whitened residual (rows,)."""
        self.folds.append((deviates.of(y), deviates.spread))

    def add(self, value: float) -> None:
        """A squared deviate of one degree of freedom."""
        self.others.append(value)


def scatter(before: Sum, after: Sum, expected: float) -> float:
    """Standard deviation of the fraction that closes, from noise, which both sums have alike.

    To first order the fraction f changes by that of (1 - f) before - after, over the gap: what a cause leaves
    alone drops out but for f of its noise.
    """
    gap = max(before.value - expected, 1e-9)
    left = (after.value - expected) / gap
    folds = sum(
        np.sqrt(scattered(left, zb, za, sb, sa))
        for (zb, sb), (za, sa) in zip(before.folds, after.folds, strict=True)
    )
    one = np.eye(1)
    others = sum(
        scattered(left, np.sqrt([max(b, 0.0)]), np.sqrt([max(a, 0.0)]), one, one)
        for b, a in zip(before.others, after.others, strict=True)
    )
    return float(np.sqrt(folds**2 + others) / gap)


def measured(search: Search, causes: Sequence[Cause], found: Sequence[Place]) -> Closure:
    """Closure of the causes, over the places at which the gap was found."""
    data = search.data
    families = few_columned(found)
    slow = [_at_its_instant(c) for c in causes if c.slow]
    sums = _Sums()
    if families or slow:
        sums = _of_block_means(search, causes, slow, families)
    alone: dict[Key, tuple[float, float]] = {}
    held_out = _held_out(data, causes) if families or slow else ""
    # a random process that block means were held against is in their noise
    seats = {one.channels for one in families} | {one.channels for one in slow}
    full_rate = [c for c in causes if c.finding is not None and not (c.process and c.channels in seats)]
    halves: list[bool] = []
    for cause in full_rate:
        pair = _fast_closure(data, cause, search.allowed)
        halves.append(pair is not None)
        alone[cause.key] = pair or _as_fitted(cause)
        sums.before.add(alone[cause.key][0])
        sums.after.add(alone[cause.key][1])
        sums.expected += 1.0
    if not causes:
        sums = _Sums(expected=float(sum(p.degrees for p in found)))
        for p in found:
            sums.before.add(p.q + p.degrees)
            sums.after.add(p.q + p.degrees)
    words = [held_out] if held_out else []
    if any(halves):
        words.append("of the full rate every other run, both ways")
    if not all(halves):
        words.append("of the full rate, where runs cannot be divided, nothing")
    return Closure(
        _MEASURE,
        "; ".join(words) or "nothing was fitted",
        sums.before.value,
        sums.after.value,
        sums.expected,
        scatter(sums.before, sums.after, sums.expected),
        float(np.clip(np.mean(sums.placebo), -1.0, 1.0)) if sums.placebo else None,
        tuple(sums.folds),
        alone,
        priors.DEPARTURE**2 if slow else 0.0,
        sums.departed / max(sums.before.value - sums.expected, 1e-9),
        sums.before,
    )


@dataclass
class _Sums:
    """Over both folds."""

    before: Sum = field(default_factory=Sum)
    after: Sum = field(default_factory=Sum)
    expected: float = 0.0
    departed: float = 0.0
    placebo: list[float] = field(default_factory=list)
    folds: list[HeldOut] = field(default_factory=list)


def _of_block_means(
    search: Search, causes: Sequence[Cause], slow: Sequence[Cause], families: Sequence[Candidate]
) -> _Sums:
    """Each fold held against causes that were fitted on the other."""
    data, nominal, sums = search.data, search.problem.nominal, _Sums()
    instant = any(_within_a_block(data, c) for c in slow)
    columns = nuisances(data.inputs, [c.action(data.run_ids, data.n) for c in slow])
    # what a converter does to block means is its own doing, of a phase that nobody knows
    codes = converter_means(data.inputs, causes, data.noise_raw(), search.problem.whiten.rows)
    shapes = _shapes(data, slow, search.problem.whiten.rows)
    noisy = [_part(search, keep, causes, np.column_stack([columns, codes])) for keep in _KEPT]
    bare = noisy
    if processes_of(causes) or codes.shape[1]:
        bare = [_part(search, keep, slow, columns) for keep in _KEPT]
    features = _features(search, families, slow, shapes, bare[-1])
    measures = deviates(noisy[-1], noisy[:2], features)
    plain = measures if bare is noisy else deviates(bare[-1], bare[:2], features)
    white = noisy[-1].whiten(shapes)
    sums.departed = float(np.trace(noisy[-1].metric.gram(white, white)))
    for this, other in ((1, 0), (0, 1)):
        scored, fitted = noisy[this], noisy[other]
        mine: Sequence[Cause] = slow
        if not instant:
            args = (data.inputs, slow, fitted.whiten, nominal, fitted.metric, fitted.y)
            mine = refined(*args, rounds=3).causes
        change = modelled_change(data.inputs, mine, scored.whiten, nominal)
        sums.folds.append(HeldOut(tuple(mine), scored, measures[this], bare[this], plain[this]))
        # a random process does not change what is predicted but how far from it one may be
        sums.before.add_fold(plain[this], bare[this].y)
        sums.after.add_fold(measures[this], scored.y - change)
        sums.expected += measures[this].expected
        wrong = _placebo(search, slow, bare[other], bare[this])
        if wrong is not None:
            one, two = (plain[this].of(y) for y in (bare[this].y, bare[this].y - wrong))
            gap = float(one @ one) - plain[this].expected
            sums.placebo.append(float(one @ one - two @ two) / max(gap, 1e-9))
    return sums


def _held_out(data: Data, causes: Sequence[Cause]) -> str:
    """What of block means was not fitted."""
    if any(_within_a_block(data, c) for c in causes if c.slow):
        return "nothing: what a start late by less than a block changes lies in one block alone"
    words = "every other three-hundredth of each run, both ways"
    if any("time_s" in c.theta for c in causes):
        words += "; the instant of a step, whose block one half alone has, was fitted on all"
    return words


def _at_its_instant(cause: Cause) -> Cause:
    """A cause whose instant is no free number: the block in which a bias steps lies in one fold alone."""
    if "time_s" not in cause.theta:
        return cause
    theta = {name: value for name, value in cause.theta.items() if name != "time_s"}
    settled = {**cause.settled, "time_s": cause.theta["time_s"]}
    return replace(cause, theta=theta, settled=settled, spread=None)


def _within_a_block(data: Data, cause: Cause) -> bool:
    """Whether a cause shows in a single block at each jump of the rate, which one fold alone has."""
    late = abs(cause.theta.get("s", np.inf))
    return late < data.inputs[0].scene.blocks.length_s


#: Stretches of which fold a part keeps: of one, of the other, of both.
_KEPT = ((0,), (1,), (0, 1))


def _masks(data: Data, keep: Sequence[int]) -> list[NDArray[np.bool_]]:
    masks = []
    for one in data.inputs:
        count = one.scene.blocks.count
        stretch = np.arange(count) * _DEALS // max(count, 1)
        masks.append(np.isin(stretch % 2, keep))
    return masks


def _part(search: Search, keep: Sequence[int], causes: Sequence[Cause], columns: Array) -> Part:
    data = search.data.with_parts(_masks(search.data, keep))
    whiten = whitener(data.inputs, data.sizes, search.full_rate.level, processes_of(causes))
    y = whiten(whiten.rows.stacked(data.residual)[:, None])[:, 0]
    return Part(whiten, Metric.of(whiten(columns)), y)


def _shapes(data: Data, slow: Sequence[Cause], rows: Rows) -> Array:
    """Columns (rows, m) in which the causes would show that their shapes are not quite the catalogue's."""
    actions = [replace(c.action(data.run_ids, data.n), ordinal=k) for k, c in enumerate(slow)]
    columns = [departures(data.inputs, actions, k, rows) for k in range(len(slow))]
    return np.column_stack([np.zeros((rows.total, 0)), *columns])


def _features(
    search: Search, families: Sequence[Candidate], slow: Sequence[Cause], shapes: Array, whole: Part
) -> Array:
    """Columns (rows, m) [deg/h] of what the causes change, and of what shows beside: places, departures."""
    whiten = search.problem.whiten
    model = modelled(search.data.inputs, slow, whiten, search.problem.nominal)
    wholes = [model.slopes]
    for family in families:
        columns = np.zeros((whiten.rows.total, family.columns.shape[2]))
        columns[family.rows] = family.columns[:, 0, :]
        wholes.append(columns)
    # all at once: filters are solved for once
    plain = _coloured(whiten, np.column_stack(wholes))
    slopes, *places = np.split(plain, np.cumsum([w.shape[1] for w in wholes])[:-1], axis=1)
    if not slow:
        return np.column_stack([slopes, *places])
    # what no number scales, or not in proportion, slopes do not have
    changes = changes_of(search.data.inputs, slow, whiten.rows)
    white, metric = whole.whiten(changes), whole.metric.with_free(whole.whiten(slopes))
    slopes = np.column_stack([slopes, changes[:, np.diag(metric.gram(white, white)) > 1.0]])
    change = modelled_change(search.data.inputs, slow, whole.whiten, search.problem.nominal)
    left = WhitenedResidual.of(whole.metric.with_free(whole.whiten(slopes)), whole.y - change)
    shown = [columns for columns in places if shows(left, whole.whiten(columns), 0.0)]
    shown += [shapes] if shows(left, whole.whiten(shapes), 1.0) else []
    return np.column_stack([slopes, *shown])


def few_columned(found: Sequence[Place]) -> list[Candidate]:
    """Families of places that features are taken of: of few columns, for many count noise more than a gap."""
    families = [p.family for p in found if p.family is not None]
    return [family for family in families if family.columns.shape[2] <= _MOST_FEATURES]


def _coloured(whiten: Whitener, white: Array) -> Array:
    """Whitened columns before they were whitened."""
    out = np.empty_like(white)
    for (i, r), matrix in whiten.filters.items():
        rows = whiten.rows.of(i, r)
        out[rows] = np.linalg.solve(matrix, white[rows]) if white[rows].any() else 0.0
    return out


def _placebo(search: Search, slow: Sequence[Cause], fitted: Part, scored: Part) -> Array | None:
    """What a wrong effect, fitted on one fold, changes on the other: the first linear one at another gyro."""
    seats = {name for c in slow for name in c.channels}
    for candidate in search.problem.candidates:
        if candidate.effect in ("bias_ramp", "temperature_bias") and not seats & set(candidate.channels):
            whole = np.zeros((search.problem.whiten.rows.total, candidate.columns.shape[2]))
            whole[candidate.rows] = candidate.columns[:, 0, :]
            plain = _coloured(search.problem.whiten, whole)
            here, there = fitted.whiten(plain), scored.whiten(plain)
            size = np.linalg.lstsq(
                fitted.metric.gram(here, here), fitted.metric.gram(here, fitted.y[:, None])[:, 0], rcond=None
            )[0]
            change: Array = there @ size
            return change
    return None


def _fast_closure(data: Data, cause: Cause, allowed: frozenset[str]) -> tuple[float, float] | None:
    """Before and after of a full-rate cause: its first number, fitted on every other run, on the rest.

    Before: twice the ln likelihood that it gains over all runs, whose halves share what a record leaves open;
    after: how far its number on one half is from that on the other, squared, in standard deviations of their
    difference. None where a half does not show it.
    """
    if len(data.full) < 2 or cause.finding is None:
        return None
    found = []
    for parity in (0, 1):
        part = data.some_runs(slice(parity, None, 2))
        same = [f for f in FullRateStatistics(part, allowed).findings([]) if f.key == cause.finding.key]
        if not same or not same[0].parameters:
            return None
        found.append(same[0])
    name, (value, _) = next(iter(cause.finding.parameters.items()))
    # a discrete or exactly known number has no error of its own
    least = max(1e-3 * abs(float(value)), 1e-12)
    stds = [max(float(f.parameters[name][1] or 0.0), least) for f in found]
    apart = float(found[0].parameters[name][0]) - float(found[1].parameters[name][0])
    after = 0.25 * apart**2 * (stds[0] ** -2 + stds[1] ** -2)
    return cause.finding.snr2 + 1.0, after


def _as_fitted(cause: Cause) -> tuple[float, float]:
    """Before and after of a full-rate cause where nothing can be kept from the fit."""
    assert cause.finding is not None
    return cause.finding.snr2 + 1.0, 1.0
