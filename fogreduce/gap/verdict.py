"""The verdict: which set of causes, with or without something unknown beside it, has the most evidence."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fogreduce.gap.search import LOG_FURTHER, LOG_GAP, Option, Search, State

#: Rivals whose evidence times prior falls short of the best by less than this cannot be excluded.
_RIVAL = 5.0
_MOST_MANY, _MOST_ONE = 4, 8


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
    first = path[0][1]
    anything = _log_sum([o.score for o in first]) + LOG_GAP
    best_path = max((score for _, _, score in path[1:]), default=-np.inf)
    gap = 1.0 / (1.0 + np.exp(-np.clip(max(anything, best_path), -500.0, 500.0)))
    if gap < 0.5:
        unknown = _log_sum([o.score for o in first if not o.known]) + LOG_GAP
        share = float(np.exp(unknown - np.logaddexp(0.0, anything)))
        return Verdict("no_gap", float(gap), min(share, 1.0), path[0][0], first, ())
    plain, with_unknown = [], []
    for depth, (_, options, score) in enumerate(path):
        beside = _log_sum([o.score for o in options if not o.known])
        further = LOG_GAP if depth == 0 else LOG_FURTHER
        plain.append(score if depth else -1e9)
        with_unknown.append(score + beside + further)
    total = _log_sum([*plain, *with_unknown])
    unknown_probability = float(np.exp(_log_sum(with_unknown) - total))
    if unknown_probability >= 0.5:
        depth = int(np.argmax(with_unknown))
        word = "partly_explained" if depth else "unexplained"
    else:
        depth, word = int(np.argmax(plain)), "explained"
    state, left, _ = path[depth]
    named = tuple(
        _named(search, state, k, first if len(state.causes) == 1 else None) for k in range(len(state.causes))
    )
    named = tuple(sorted(named, key=lambda one: -one.probability))
    return Verdict(word, float(gap), unknown_probability, state, left, named)


def _named(search: Search, state: State, k: int, options: list[Option] | None) -> Named:
    """One cause against all that could stand in its place."""
    if options is None:
        others = [c for j, c in enumerate(state.causes) if j != k]
        options = search.options(search.state(others, refine=False))
    further = LOG_GAP if len(state.causes) == 1 else LOG_FURTHER
    total = _log_sum([*(o.score for o in options), -further])
    chances = sorted(((o, float(np.exp(o.score - total))) for o in options if o.known), key=lambda x: -x[1])
    key = state.causes[k].key
    own = next(((o, p) for o, p in chances if _same(o, key)), None)
    if own is None:
        return Named(k, 0.5, 0.5, ())
    most = _MOST_ONE if len(search.data.inputs) == 1 else _MOST_MANY
    rivals = [(o, p) for o, p in chances if o.score > chances[0][0].score - _RIVAL][:most]
    if all(o is not own[0] for o, _ in rivals):
        rivals = [own, *rivals][:most]
    return Named(k, own[1], min(sum(p for _, p in rivals), 1.0), tuple(rivals))


def _same(option: Option, key: tuple[object, ...]) -> bool:
    return option.key == key
