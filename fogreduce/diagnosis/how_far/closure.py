"""How far the gap closes on blocks that were not fitted, with the causes simulated again.

Each run's blocks are dealt in turn to two folds; causes are fitted on one and held against the other, both
ways.
What is summed are the squared deviates of the features in which the gap shows and of those that the causes
change, as the catalogue has them and as they may depart from it, noise and stated uncertainties in their
metric: its expectation, when nothing is left, is their number.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.departures import departures
from fogreduce.diagnosis.inference.fitted import refined
from fogreduce.diagnosis.inference.model import modelled
from fogreduce.diagnosis.inference.noise_model import Metric, Rows, Whitener, nuisances, whitener
from fogreduce.diagnosis.inference.search import Search, _processes
from fogreduce.diagnosis.observe.data import Data
from fogreduce.diagnosis.where.places import Place
from fogreduce.diagnosis.which.catalogue.converter import converter_means
from fogreduce.diagnosis.which.full_rate.fast import Fast

Array = NDArray[np.float64]
Key = tuple[str, tuple[str, ...], tuple[str, ...], str]

_MEASURE = (
    "squared normal deviates, noise and stated uncertainties in their metric, of the features in "
    "which the gap shows and of those that the causes change"
)
_DEALS = 300  # stretches of a run, dealt in turn: short ones, so that either fold knows when a bias stepped
_MOST_FEATURES = 30


@dataclass(frozen=True)
class HeldOut:
    """One fold held against causes that were fitted on the other.

    Attributes
    ----------
    causes : tuple of Cause
        Those in block means, with the other fold's parameters.
    whiten : Whitener
    metric, features : Metric, (rows, m) array
        With the random processes among the causes in the noise.
    bare, bare_features : Metric, (rows, m) array
        Without them.
    y, bare_y : (rows,) arrays
        Residual, whitened in either noise.
    """

    causes: tuple[Cause, ...]
    whiten: Whitener
    metric: Metric
    features: Array
    y: Array
    bare: Metric
    bare_features: Array
    bare_y: Array
    bare_whiten: Whitener


@dataclass(frozen=True)
class Closure:
    """Sums over both folds.

    Attributes
    ----------
    measure, held_out : str
    before, after, expected : float
    placebo : float or None
        The fraction that a wrong effect, fitted as hard, would close.
    held : tuple of HeldOut
        Each fold as it was held against the causes.
    at_full_rate : mapping
        Key of a cause of the full rate -> its own before and after.
    departure : float
        What causes that are not quite of the catalogue's shapes may leave, or hide by parameters that take
        some of it up: a standard deviation of the fraction.
    """

    measure: str
    held_out: str
    before: float
    after: float
    expected: float
    placebo: float | None = None
    held: tuple[HeldOut, ...] = ()
    at_full_rate: Mapping[Key, tuple[float, float]] = field(default_factory=dict)
    departure: float = 0.0

    @property
    def fraction(self) -> float:
        """1 - (after - expected) / (before - expected); 0 where nothing was there."""
        gap = self.before - self.expected
        return 1.0 - (self.after - self.expected) / gap if gap > 0.0 else 0.0

    @property
    def std(self) -> float:
        """Its standard deviation: those of the two sums, as sums of squared normal deviates, and departures'.

        The folds share stated uncertainties, and each has the noise of the other's fit: they count as one.
        """
        gap = max(self.before - self.expected, 1e-9)
        left = 4.0 * self.expected + 8.0 * max(self.after - self.expected, 0.0)
        whole = 4.0 * self.expected + 8.0 * gap
        noise = np.sqrt(left + (1.0 - self.fraction) ** 2 * whole) / gap
        return float(np.hypot(noise, self.departure))


@dataclass(frozen=True)
class _Fold:
    """One fold's metric and residual."""

    whiten: Whitener
    metric: Metric
    y: Array


def measured(search: Search, causes: Sequence[Cause], found: Sequence[Place]) -> Closure:
    """Closure of the causes, over the places at which the gap was found."""
    data = search.data
    families = [p.family for p in found if p.family is not None]
    slow = [_at_its_instant(c) for c in causes if c.slow]
    sums = _Sums()
    if families or slow:
        sums = _of_block_means(search, causes, slow, families)
    before, after, expected = sums.before, sums.after, sums.expected
    alone: dict[Key, tuple[float, float]] = {}
    held_out = _held_out(data, causes) if families or slow else ""
    fast = [c for c in causes if c.finding is not None]
    for cause in fast:
        pair = _fast_closure(data, cause, search.allowed)
        if pair is not None:
            before, after, expected = before + pair[0], after + pair[1], expected + 1.0
            alone[cause.key] = pair
            held_out = held_out or "every other run, both ways"
    if not causes:
        before = after = sum(p.q + p.degrees for p in found)
        expected = float(sum(p.degrees for p in found))
    if not before and fast:
        before = sum(c.finding.snr2 + 1.0 for c in fast if c.finding is not None)
        after = expected = float(len(fast))
        held_out = "nothing: a single run's full-rate statistics cannot be divided"
    return Closure(
        _MEASURE,
        held_out or "nothing was fitted",
        before,
        after,
        expected,
        float(np.clip(np.mean(sums.placebo), -1.0, 1.0)) if sums.placebo else None,
        tuple(sums.held),
        alone,
        priors.DEPARTURE**2 if slow else 0.0,
    )


@dataclass
class _Sums:
    """Of block means, over both folds."""

    before: float = 0.0
    after: float = 0.0
    expected: float = 0.0
    placebo: list[float] = field(default_factory=list)
    held: list[HeldOut] = field(default_factory=list)


def _of_block_means(
    search: Search, causes: Sequence[Cause], slow: Sequence[Cause], families: Sequence[Candidate]
) -> _Sums:
    """Each fold held against causes that were fitted on the other."""
    data, nominal, sums = search.data, search.ground.nominal, _Sums()
    instant = any(_within_a_block(data, c) for c in slow)
    columns = nuisances(data.inputs, [c.action(data.run_ids, data.n) for c in slow])
    # what a converter does to block means is its own doing, of a phase that nobody knows
    codes = converter_means(data.inputs, causes, data.noise_raw(), search.ground.whiten.rows)
    wide = np.column_stack([columns, codes])
    folds = [_fold(search, parity, causes, wide) for parity in (0, 1)]
    plain = folds
    if _processes(causes) or codes.shape[1]:
        plain = [_fold(search, parity, slow, columns) for parity in (0, 1)]
    for fitted, held, bare in ((folds[0], folds[1], plain[1]), (folds[1], folds[0], plain[0])):
        mine: Sequence[Cause] = slow
        if not instant:
            args = (data.inputs, slow, fitted.whiten, nominal, fitted.metric, fitted.y)
            mine = refined(*args, rounds=3).causes
        there = modelled(data.inputs, mine, held.whiten, nominal)
        shapes = _shapes(data, mine, held.whiten.rows)
        features = _features(search, families, there.slopes, shapes, held.whiten)
        bare_features = _features(search, families, there.slopes, shapes, bare.whiten)
        whole = (held.whiten, held.metric, features, held.y)
        sums.held.append(
            HeldOut(tuple(mine), *whole, bare.metric, bare_features, bare.y, bare_whiten=bare.whiten)
        )
        # a random process does not change what is predicted but how far from it one may be
        one, number = squared_deviates(bare.metric, bare_features, bare.y)
        two, _ = squared_deviates(held.metric, features, held.y - there.change)
        sums.before, sums.after, sums.expected = sums.before + one, sums.after + two, sums.expected + number
        wrong = _placebo(search, slow, fitted, bare)
        if wrong is not None:
            three, _ = squared_deviates(bare.metric, bare_features, bare.y - wrong)
            sums.placebo.append((one - three) / max(one - number, 1e-9))
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


def _masks(data: Data, parity: int) -> list[NDArray[np.bool_]]:
    masks = []
    for one in data.inputs:
        count = one.scene.blocks.count
        stretch = np.arange(count) * _DEALS // max(count, 1)
        masks.append(stretch % 2 == parity)
    return masks


def _fold(search: Search, parity: int, causes: Sequence[Cause], columns: Array) -> _Fold:
    data = search.data.with_parts(_masks(search.data, parity))
    whiten = whitener(data.inputs, data.sizes, search.fast.level, _processes(causes))
    y = whiten(whiten.rows.stacked(data.residual)[:, None])[:, 0]
    return _Fold(whiten, Metric.of(whiten(columns)), y)


def _shapes(data: Data, slow: Sequence[Cause], rows: Rows) -> Array:
    """Columns (rows, m) in which the causes would show that their shapes are not quite the catalogue's."""
    actions = [replace(c.action(data.run_ids, data.n), ordinal=k) for k, c in enumerate(slow)]
    columns = [departures(data.inputs, actions, k, rows) for k in range(len(slow))]
    return np.column_stack([np.zeros((rows.total, 0)), *columns])


def _features(
    search: Search, families: Sequence[Candidate], slopes: Array, shapes: Array, whiten: Whitener
) -> Array:
    """Whitened columns (rows, m) of features, causes and their departures under a fold's whitener."""
    ground = search.ground.whiten
    room = _MOST_FEATURES - slopes.shape[1] - shapes.shape[1]
    wholes = [np.zeros((ground.rows.total, 0))]
    for family in families:
        if family.columns.shape[2] > room:
            continue
        room -= family.columns.shape[2]
        whole = np.zeros((ground.rows.total, family.columns.shape[2]))
        whole[family.rows] = family.columns[:, 0, :]
        wholes.append(whole)
    # all at once: filters are solved for once
    return np.column_stack([slopes, whiten(shapes), whiten(_coloured(ground, np.column_stack(wholes)))])


def _coloured(ground: Whitener, white: Array) -> Array:
    """Whitened columns before they were whitened."""
    out = np.empty_like(white)
    for (i, r), matrix in ground.filters.items():
        rows = ground.rows.of(i, r)
        out[rows] = np.linalg.solve(matrix, white[rows]) if white[rows].any() else 0.0
    return out


def squared_deviates(metric: Metric, features: Array, y: Array) -> tuple[float, float]:
    """Squared deviates of y over the span of features, and how many they are."""
    if features.shape[1] == 0:
        return 0.0, 0.0
    gram = metric.gram(features, features)
    values, vectors = np.linalg.eigh(gram / np.sqrt(np.outer(np.diag(gram), np.diag(gram)) + 1e-300))
    some = values > 1e-8 * values[-1]
    b = metric.gram(features, y[:, None])[:, 0] / np.sqrt(np.diag(gram) + 1e-300)
    return float(np.sum((vectors[:, some].T @ b) ** 2 / values[some])), float(some.sum())


def _placebo(search: Search, slow: Sequence[Cause], fitted: _Fold, held: _Fold) -> Array | None:
    """What a wrong effect, fitted on one fold, changes on the other: the first linear one at another gyro."""
    seats = {name for c in slow for name in c.channels}
    for candidate in search.ground.candidates:
        if candidate.effect in ("bias_ramp", "temperature_bias") and not seats & set(candidate.channels):
            whole = np.zeros((search.ground.whiten.rows.total, candidate.columns.shape[2]))
            whole[candidate.rows] = candidate.columns[:, 0, :]
            plain = _coloured(search.ground.whiten, whole)
            here, there = fitted.whiten(plain), held.whiten(plain)
            size = np.linalg.lstsq(
                fitted.metric.gram(here, here), fitted.metric.gram(here, fitted.y[:, None])[:, 0], rcond=None
            )[0]
            change: Array = there @ size
            return change
    return None


def _fast_closure(data: Data, cause: Cause, allowed: frozenset[str]) -> tuple[float, float] | None:
    """Before and after of a full-rate cause: its first number, fitted on every other run, on the rest."""
    if len(data.full) < 2 or cause.finding is None:
        return None
    found = []
    for parity in (0, 1):
        part = data.some_runs(slice(parity, None, 2))
        same = [f for f in Fast(part, allowed).findings([]) if f.key == cause.finding.key]
        if not same or not same[0].parameters:
            return None
        found.append(same[0])
    name, (value, _) = next(iter(cause.finding.parameters.items()))
    off = data.stated_white[int(cause.channels[0][4:]) - 1] if name == "deg_sqrt_h" else 0.0
    before = after = 0.0
    for fitted, held in ((found[0], found[1]), (found[1], found[0])):
        std = float(held.parameters[name][1] or 0.0)
        # a discrete or exactly known number has no error of its own
        std = max(std, 1e-3 * abs(float(value)), 1e-12)
        # a level is known to no better than the record's, whose doubt its significance has in it
        deviate2 = 0.0 if off else (float(held.parameters[name][0]) / std) ** 2
        before += 0.5 * max(held.snr2, deviate2)
        after += 0.25 * ((float(held.parameters[name][0]) - float(fitted.parameters[name][0])) / std) ** 2
    return before + 1.0, after
