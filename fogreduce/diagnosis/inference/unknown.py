"""What is unknown, asked about what is left and locally: an unknown at one gyro ends nothing at another.

The closed world comes first. Then, at each place, families of the unknown are weighed beside the causes
found, and in the stead of all the causes that sit there.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.evidence import WhitenedResidual
from fogreduce.diagnosis.inference.hierarchy import Kind
from fogreduce.diagnosis.inference.options import Option, log_prior_of
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.inference.sets import CauseSet
from fogreduce.diagnosis.inference.slow import SlowPosterior

_TABLE = ("table",)


@dataclass(frozen=True)
class Unknown:
    """Something unknown at a place.

    Attributes
    ----------
    channels : tuple of str
    probability : float
    instead : frozenset of keys
        The causes in whose stead it stands; empty where it stands beside them.
    """

    channels: tuple[str, ...]
    probability: float
    instead: frozenset[tuple[object, ...]]


def unknowns(search: Search, posterior: SlowPosterior) -> list[Unknown]:
    """Places with their probability of something unknown."""
    out = []
    for channels, log_odds in _odds(search.options(posterior.state)).items():
        out.append(Unknown(channels, _probability(log_odds), frozenset()))
    entries = posterior.sets.entries(posterior.best.members)
    keys = {entry: posterior.sets.regression.entries[entry].key for entry in entries}
    for channels in {key[1] for key in keys.values()}:
        gone = {entry for entry, key in keys.items() if key[1] == channels}
        less = posterior.sets.without(posterior.best, gone)
        lost = posterior.best.score - less.score
        families = _better_fits(_families(search, posterior, less, channels), posterior, less)
        odds = _odds(families).get(channels, -np.inf)
        out.append(Unknown(channels, _probability(odds - lost), frozenset(keys[entry] for entry in gone)))
    out += _rotations(posterior, keys)
    by_place: dict[tuple[str, ...], list[Cause]] = {}
    for cause in posterior.given:
        if cause.process:
            by_place.setdefault(cause.channels, []).append(cause)
    for mine in by_place.values():
        several = [mine] if len(mine) > 1 else []
        out += [_in_place_of(search, posterior, these) for these in [*([one] for one in mine), *several]]
    return out


def _rotations(posterior: SlowPosterior, keys: Mapping[int, tuple[object, ...]]) -> Iterator[Unknown]:
    """An unknown rotation in the stead of causes of one kind at several gyros, of more numbers than it has:
    that these make one rotation would be chance.
    """
    by_kind: dict[Kind, set[int]] = {}
    for entry in keys:
        by_kind.setdefault(posterior.sets.kind(entry), set()).add(entry)
    for gone in (entries for entries in by_kind.values() if len(entries) > 1):
        less = posterior.sets.without(posterior.best, gone)
        numbers = len(posterior.best.fit.columns) - len(less.fit.columns)
        fewer = [
            o
            for o in _shapes(posterior, WhitenedResidual.of(*posterior.with_free(less)), _TABLE)
            if o.fit is not None and o.fit.candidate.columns.shape[2] < numbers
        ]
        odds = _odds(fewer).get(_TABLE, -np.inf) - priors.AS_WELL
        lost = posterior.best.score - less.score
        yield Unknown(_TABLE, _probability(odds - lost), frozenset(keys[entry] for entry in gone))


def _in_place_of(search: Search, posterior: SlowPosterior, processes: Sequence[Cause]) -> Unknown:
    """Something unknown at a gyro against processes of the catalogue there, in a noise that has none of them:
    two of them together do what one of another spectrum does.
    """
    channels, gone = processes[0].channels, frozenset(c.key for c in processes)
    causes = [c for c in posterior.state.causes if c.key not in gone]
    named, odds = -priors.LOG_FURTHER, -np.inf
    for process in processes:
        state = search.state(causes, search.problem_with([c for c in causes if c.process]), refine=False)
        here = [o for o in search.options(state) if o.source.channels == channels]
        if process is processes[0]:
            odds = _odds(here).get(channels, -np.inf) - priors.LOG_FURTHER
        named += priors.LOG_FURTHER + max((o.score for o in here if o.key == process.key), default=-np.inf)
        causes.append(process)
    return Unknown(channels, _probability(odds - named), gone)


def _families(
    search: Search, posterior: SlowPosterior, less: CauseSet, channels: tuple[str, ...]
) -> list[Option]:
    """Families and processes of the unknown at a place beside a set, held against what the set itself was."""
    residual = WhitenedResidual.of(*posterior.with_free(less))
    out = _shapes(posterior, residual, channels)
    for f in posterior.state.problem.processes.findings(residual, search.allowed):
        if f.channels == channels and not f.catalogued:
            out.append(Option(None, f, f.log_b, log_prior_of(False, f.share), f.log_b))
    return out


def _shapes(posterior: SlowPosterior, residual: WhitenedResidual, channels: tuple[str, ...]) -> list[Option]:
    """Families of the unknown at a place, held against a residual."""
    fits = [
        fit for fit in posterior.state.problem.families.fits(residual) if fit.candidate.channels == channels
    ]
    return [Option(fit, None, fit.log_b, log_prior_of(False, fit.candidate.share), fit.log_b) for fit in fits]


def _better_fits(options: list[Option], posterior: SlowPosterior, less: CauseSet) -> list[Option]:
    """The unknown must fit better than what it stands in the stead of: fewer numbers are no evidence. Nor is
    it that the unknown is one thing and the causes are several, where the runs speak for these.
    """
    named = posterior.best.fit.log_b - less.fit.log_b
    several = posterior.best.score - less.score - priors.LOG_FURTHER
    gain = _chi2(posterior, less) - _chi2(posterior, posterior.best)
    numbers = len(posterior.best.fit.columns) - len(less.fit.columns)
    out = []
    for o in options:
        if o.fit is not None:
            most = np.inf
            if o.fit.candidate.columns.shape[2] <= numbers:
                most = named + 0.5 * max(o.q - gain, 0.0) - priors.AS_WELL
            if o.log_b < named - priors.SPEAKS:
                most = min(most, several - o.log_prior - priors.AS_WELL)
            o = replace(o, log_b=min(o.log_b, most))
        out.append(o)
    return out


def _chi2(posterior: SlowPosterior, here: CauseSet) -> float:
    """What a set leaves, its sizes free."""
    return WhitenedResidual.of(*posterior.with_free(here)).chi2


def _odds(options: list[Option]) -> dict[tuple[str, ...], float]:
    """Ln odds of something unknown in block means at each place."""
    out: dict[tuple[str, ...], float] = {}
    for o in options:
        slow = o.fit is not None or o.process
        if not o.catalogued and slow:
            out[o.source.channels] = float(
                np.logaddexp(out.get(o.source.channels, -np.inf), o.score + priors.LOG_FURTHER)
            )
    return out


def _probability(log_odds: float) -> float:
    return float(1.0 / (1.0 + np.exp(-np.clip(log_odds, -500.0, 500.0))))
