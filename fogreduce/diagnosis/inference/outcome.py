"""The verdict: which set of causes, with or without something unknown beside it, has the most evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.search import LOG_FURTHER, LOG_GAP, Option, Search, State, Step

#: Rivals whose evidence times prior falls short of the best by less than this cannot be excluded.
_RIVAL = 5.0
_MOST_MANY, _MOST_ONE = 4, 8
_MEAN_COSTS = 1.0
_ROUNDABOUT = 3.0
_LEAST = 0.1  # probability below which a cause beside something unknown is not named


@dataclass(frozen=True)
class Named:
    """A cause with its probability and rivals.

    Attributes
    ----------
    index : int
        Its number among the state's causes.
    probability, group_probability : float
    group : tuple of (Option, float)
        Rivals, itself first where it is the best.
    """

    index: int
    probability: float
    group_probability: float
    group: tuple[tuple[Option, float], ...]


@dataclass(frozen=True)
class Verdict:
    """What is judged.

    Attributes
    ----------
    word : str
        ``no_gap``, ``explained``, ``partly_explained`` or ``unexplained``.
    gap_probability, unknown_probability : float
    state : State
        The causes taken.
    left : list of Option
        What might be added to them.
    named : tuple of Named
    """

    word: str
    gap_probability: float
    unknown_probability: float
    state: State
    left: list[Option]
    named: tuple[Named, ...]


def _log_sum(values: Sequence[float]) -> float:
    return float(np.logaddexp.reduce(np.array([-1e9, *values])))


def judged(search: Search) -> Verdict:
    """Search, and judge."""
    path = search.run()
    first = path[0].options
    anything = _log_sum([o.score for o in first]) + LOG_GAP
    best_path = max((step.score for step in path[1:]), default=-np.inf)
    gap = 1.0 / (1.0 + np.exp(-np.clip(max(anything, best_path), -500.0, 500.0)))
    if gap < 0.5:
        unknown = _log_sum([o.score for o in first if not o.known]) + LOG_GAP
        share = float(np.exp(unknown - np.logaddexp(0.0, anything)))
        return Verdict("no_gap", float(gap), min(share, 1.0), path[0].state, first, ())
    # (step, its options less one cause, whether anything unknown beside it, ln score)
    ways = _ways(search, path)
    if any(c.process for step in path for c in step.state.causes):
        # steps and drifts beside an unknown process are a roundabout way to a walk
        ways += [
            (step, something, score - _ROUNDABOUT * something)
            for step, something, score in _ways(search, search.run(processes=False))[1:]
        ]
    total = _log_sum([score for _, _, score in ways])
    unknown_probability = float(np.exp(_log_sum([s for _, something, s in ways if something]) - total))
    chosen = max((way for way in ways if way[1] == (unknown_probability >= 0.5)), key=lambda way: way[2])
    step, something, _ = chosen
    word = "explained"
    if something:
        word = "partly_explained" if step.state.causes else "unexplained"
    named = tuple(_named(search, step.state, k, first) for k in range(len(step.state.causes)))
    state, left = step.state, step.options
    kept = [one for one in named if one.probability >= _LEAST]
    if not something:
        # what nothing of the catalogue explains as well as the unknown does is not explained
        kept = [one for one in named if one.group_probability >= _LEAST]
    if len(kept) < len(named):
        # what the unknown explains better in a cause's place is not judged present
        causes = [state.causes[one.index] for one in kept]
        unknown_probability = max(unknown_probability, 1.0 - min(one.group_probability for one in named))
        state = search.state(causes, state.ground if causes else search.ground)
        left = search.options(state)
        named = tuple(replace(one, index=k) for k, one in enumerate(kept))
        word = "partly_explained" if causes else "unexplained"
    named = tuple(sorted(named, key=lambda one: -one.probability))
    return Verdict(word, float(gap), unknown_probability, state, left, named)


def _ways(search: Search, path: Sequence[Step]) -> list[tuple[Step, bool, float]]:
    """Every set of a path, alone and with something unknown beside it: step, whether, ln score."""
    ways = []
    for depth, step in enumerate(path):
        # what is unknown takes what departures from shape would take: it counts whole, and they do not
        beside = _log_sum([o.raw + o.log_prior for o in step.options if not o.known])
        further = LOG_GAP if depth == 0 else LOG_FURTHER
        with_it = step.score + step.state.wandered + beside + further + _mean_of_process(step)
        ways.append((step, True, with_it))
        if depth:
            ways.append((step, False, step.score + search.credit(step)))
    return ways


def _mean_of_process(step: Step) -> float:
    """Ln evidence of a mean where the best of the unknown is a process: it need not have the mean zero."""
    unknown = max((o for o in step.options if not o.known), key=lambda o: o.score, default=None)
    if unknown is None or not unknown.process:
        return 0.0
    named = [
        o for o in step.options if o.known and o.process and o.source.channels == unknown.source.channels
    ]
    if any(o.score >= unknown.score for o in named):
        return 0.0  # a process of the catalogue does as well, mean and all
    same = [o for o in step.options if o.fit is not None and o.source.channels == unknown.source.channels]
    means = [o.log_b for o in same if o.key[0] == "bias_offset" or getattr(o.source, "feature", "") == "mean"]
    return max(max(means, default=0.0) - _MEAN_COSTS, 0.0)


def in_its_place(search: Search, state: State, k: int, most: int) -> Named:
    """One cause against all that could stand in its place, in a noise and on a chain without it.

    Parameters
    ----------
    search : Search
    state : State
    k : int
        Its number among the state's causes.
    most : int
        Members of a group.
    """
    key = state.causes[k].key
    others = [c for c in state.causes if c.key != key]
    base = [c for c in others if c.process or c.key in state.ground.base]
    options = search.options(search.state(others, search.ground_of(base), refine=False))
    total = _log_sum([*(o.score for o in options), -LOG_FURTHER])
    chances = sorted(((o, float(np.exp(o.score - total))) for o in options if o.known), key=lambda x: -x[1])
    own = next(((o, p) for o, p in chances if o.key == key), None)
    if own is None:
        return Named(k, 0.5, 0.5, ())
    best = max(chances[0][0].score, own[0].score)
    rivals = _once([(o, p) for o, p in chances if o.score > best - priors.RIVAL])[:most]
    if all(o.key[:3] != own[0].key[:3] for o, _ in rivals):
        rivals = [own, *rivals][:most]
    return Named(k, own[1], min(sum(p for _, p in rivals), 1.0), tuple(rivals))


def _named(search: Search, state: State, k: int, first: list[Option]) -> Named:
    """One cause against all that could stand in its place; `first`: options beside no cause at all."""
    cause = state.causes[k]
    others = [c for j, c in enumerate(state.causes) if j != k]
    if not others:
        options = first
    elif cause.process or cause.key in state.ground.base:
        # neither noise nor chain must have the cause in them already
        options = search.options(search.state(others, search.ground_of(others), refine=False))
    else:
        options = search.options(search.state(others, state.ground, refine=False))
    further = LOG_GAP if len(state.causes) == 1 else LOG_FURTHER
    total = _log_sum([*(o.score for o in options), -further])
    chances = sorted(((o, float(np.exp(o.score - total))) for o in options if o.known), key=lambda x: -x[1])
    key = state.causes[k].key
    own = next(((o, p) for o, p in chances if _same(o, key)), None)
    if own is None:
        return Named(k, 0.5, 0.5, ())
    most = _MOST_ONE if len(search.data.inputs) == 1 else _MOST_MANY
    rivals = _once([(o, p) for o, p in chances if o.score > chances[0][0].score - _RIVAL])[:most]
    if all(o.key[:3] != own[0].key[:3] for o, _ in rivals):
        rivals = [own, *rivals][:most]
    return Named(k, own[1], min(sum(p for _, p in rivals), 1.0), tuple(rivals))


def _once(rivals: list[tuple[Option, float]]) -> list[tuple[Option, float]]:
    """Each effect at each place once: another gyro that a crosstalk may come from makes no other rival."""
    out: dict[object, tuple[Option, float]] = {}
    for option, chance in rivals:
        place = option.key if option.key[0] == "channel_swap" else option.key[:3]
        first = out.get(place)
        out[place] = (first[0], first[1] + chance) if first else (option, chance)
    return sorted(out.values(), key=lambda x: -x[1])


def _same(option: Option, key: tuple[object, ...]) -> bool:
    return option.key == key
