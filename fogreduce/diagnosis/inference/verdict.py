"""The verdict of a search over sets: full-rate causes, causes in block means, noise, and what is unknown."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.candidate import EVERY
from fogreduce.diagnosis.inference.evidence import Fit, WhitenedResidual
from fogreduce.diagnosis.inference.full_rate import FullRateCauses, full_rate_causes
from fogreduce.diagnosis.inference.gross import gross
from fogreduce.diagnosis.inference.options import Option
from fogreduce.diagnosis.inference.outcome import Named, Verdict, in_its_place, less_causes
from fogreduce.diagnosis.inference.problem import State
from fogreduce.diagnosis.inference.processes import process_price, with_processes
from fogreduce.diagnosis.inference.regression import additions
from fogreduce.diagnosis.inference.rivals import Inclusion, inclusions
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.inference.slow import SlowPosterior, fit_of
from fogreduce.diagnosis.inference.unknown import Unknown, unknowns
from fogreduce.effects.table import EFFECTS

_MOST_MANY, _MOST_ONE = 4, 8  # members of a group, of several runs and of one


def verdict_of_sets(search: Search) -> Verdict:
    """Search sets of causes without a most number of them, and judge."""
    first = gross(search, search.state([], search.problem))
    full_rate = full_rate_causes(search, first.state, first.settled)
    posterior = with_processes(search, [*full_rate.causes, *first.settled])
    left = unknowns(search, posterior)
    state = posterior.state
    named = _named(search, posterior, full_rate, left)
    unknown = max([one.probability for one in left], default=0.0)
    if full_rate.unknown or posterior.unclosed:
        unknown = 1.0
    gone = {key for one in left if one.probability >= 0.5 for key in one.instead}
    gone |= _unheard(posterior)
    doubted = _doubted(state, named)
    gone |= doubted.keys()
    unknown = max([unknown, *doubted.values()])
    disowned = {c.key for c in state.causes if c.process} & gone
    if gone:
        state, named = less_causes(search, state, named, gone)
    state = _led(search, state, named)
    if posterior.unclosed or disowned:
        # what is left there is held against the noise of the record and of the causes
        base = [c for c in state.causes if c.process or c.key in state.problem.base]
        state = search.state(state.causes, search.problem_with(base), refine=False)
    word = "explained" if unknown < 0.5 else "partly_explained"
    if not named:
        word = "unexplained" if unknown >= 0.5 else "no_gap"
    gap = max([unknown, *(one.group_probability for one in named)], default=0.0)
    ranked = tuple(sorted(named, key=lambda one: -one.probability))
    return Verdict(word, gap, unknown, state, search.options(state), ranked)


def _doubted(state: State, named: Sequence[Named]) -> dict[tuple[object, ...], float]:
    """Processes less probable than what no effect of the catalogue makes there, and how probable that is."""
    return {
        state.causes[one.index].key: 1.0 - one.group_probability
        for one in named
        if state.causes[one.index].process and one.group_probability < 0.5
    }


def _led(search: Search, state: State, named: Sequence[Named]) -> State:
    """The state in which each group's most probable member leads."""
    causes = list(state.causes)
    for one in named:
        if one.group and one.group[0][0].key not in {c.key for c in causes}:
            causes[one.index] = one.group[0][0].cause()
    if [c.key for c in causes] == [c.key for c in state.causes]:
        return state
    base = [c for c in causes if c.process or c.key in state.problem.base]
    return search.state(causes, search.problem_with(base))


def _unheard(posterior: SlowPosterior) -> set[tuple[object, ...]]:
    """Causes that the prior alone makes likely: the runs do not speak for them."""
    sets = posterior.sets
    entries = sets.entries(posterior.best.members)
    return {sets.regression.entries[e].key for e in entries if posterior.fit(e).log_b < priors.SPEAKS}


def _named(
    search: Search, posterior: SlowPosterior, full_rate: FullRateCauses, left: Sequence[Unknown]
) -> list[Named]:
    """Every cause with its probability and group."""
    causes = posterior.state.causes
    odds = {c.key: score for c, score in zip(full_rate.causes, full_rate.scores, strict=True)}
    by_key = {
        posterior.sets.regression.entries[i.entry].key: i for i in inclusions(posterior.sets, posterior.best)
    }
    most = _MOST_ONE if len(search.data.inputs) == 1 else _MOST_MANY
    out = []
    for index, cause in enumerate(causes):
        if cause.key in by_key:
            walks = _processes_instead(search, posterior, by_key[cause.key].entry)
            out.append(_of_sets(posterior, by_key[cause.key], walks, index, most))
            continue
        if cause.finding is None or cause.process:
            out.append(in_its_place(search, posterior.state, index, most))
            continue
        score = odds[cause.key]
        chance = float(1.0 / (1.0 + np.exp(-score)))
        option = Option(None, cause.finding, score, 0.0, score)
        out.append(Named(index, chance, chance, ((option, chance),)))
    return out


def _processes_instead(search: Search, posterior: SlowPosterior, entry: int) -> list[tuple[Option, float]]:
    """Random processes that could stand for a drift, with their odds over it."""
    key = posterior.sets.regression.entries[entry].key
    if len(key[1]) != 1 or not (EFFECTS[key[0]].drifts or key[2] != EVERY):
        return []
    less = posterior.sets.without(posterior.best, [entry])
    lost = posterior.best.score - less.score
    residual = WhitenedResidual.of(*posterior.with_free(less))
    out = []
    for found in posterior.state.problem.processes.findings(residual, search.allowed):
        if found.catalogued and found.channels == key[1]:
            score = found.log_b + process_price(found)
            # odds beyond what a number holds are certainty
            odds = float(np.exp(min(score - lost, 500.0)))
            out.append((Option(None, found, found.log_b, score - found.log_b), odds))
    return out


def _of_sets(
    posterior: SlowPosterior, one: Inclusion, walks: Sequence[tuple[Option, float]], index: int, most: int
) -> Named:
    """A cause in block means: its rivals are what replaces it in other sets, and processes in its stead."""
    whole = 1.0 + one.probability * sum(odds for _, odds in walks)
    chance_of_one = one.probability / whole
    group = [(_option(posterior.fit(one.entry)), chance_of_one)]
    group += [(option, chance_of_one * odds) for option, odds in walks]
    less = posterior.sets.without(posterior.best, [one.entry])
    more = additions(posterior.sets.regression, less.fit)
    for entry, chance in one.rivals:
        numbers = posterior.sets.regression.of_entry[entry]
        if np.any(np.isfinite(more.gain[numbers])):
            best = max(numbers, key=lambda n: float(more.gain[n]))
            there = posterior.sets.with_option(less, best, more)
            group.append((_option(fit_of(posterior.sets, there, there.members[-1])), chance / whole))
    group.sort(key=lambda pair: -pair[1])
    group = [pair for pair in group if pair[1] >= group[0][1] * np.exp(-priors.RIVAL)][:most]
    return Named(index, group[0][1], min(sum(p for _, p in group), 1.0), tuple(group))


def _option(fit: Fit) -> Option:
    return Option(fit, None, fit.log_b, 0.0, fit.log_b)
