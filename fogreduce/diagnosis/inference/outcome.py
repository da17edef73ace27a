"""What a diagnosis judges: a verdict, its causes, and a cause held against all that could stand for it."""

from __future__ import annotations

from collections.abc import Container, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.options import Option
from fogreduce.diagnosis.inference.problem import State
from fogreduce.diagnosis.inference.search import Search


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


def less_causes(
    search: Search, state: State, named: Iterable[Named], gone: Container[tuple[object, ...]]
) -> tuple[State, list[Named]]:
    """A state, and what is named of it, less the causes of some keys; the others fitted again."""
    kept = [k for k, c in enumerate(state.causes) if c.key not in gone]
    numbers = {k: number for number, k in enumerate(kept)}
    left = [replace(one, index=numbers[one.index]) for one in named if one.index in numbers]
    return search.state([state.causes[k] for k in kept], state.problem), left


def _log_sum(values: Sequence[float]) -> float:
    return float(np.logaddexp.reduce(np.array([-1e9, *values])))


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
    base = [c for c in others if c.process or c.key in state.problem.base]
    before = search.state(others, search.problem_with(base), refine=False)
    options = [_as_simulated(search, before, state.causes[k], o) for o in search.options(before)]
    total = _log_sum([*(o.score for o in options), -priors.LOG_FURTHER])
    chances = sorted(
        ((o, float(np.exp(o.score - total))) for o in options if o.catalogued), key=lambda x: -x[1]
    )
    chosen = next(((o, p) for o, p in chances if o.key == key), None)
    if chosen is None:
        return Named(k, 0.5, 0.5, ())
    best = max(chances[0][0].score, chosen[0].score)
    rivals = _once([(o, p) for o, p in chances if o.score > best - priors.RIVAL])[:most]
    if all(o.key[:3] != chosen[0].key[:3] for o, _ in rivals):
        rivals = [*rivals[: most - 1], chosen]
    return Named(k, rivals[0][1], min(sum(p for _, p in rivals), 1.0), tuple(rivals))


def _as_simulated(search: Search, before: State, cause: Cause, option: Option) -> Option:
    """The option that is a cause, by what it gains as it was fitted: a grid's next point may be far off."""
    if option.key != cause.key or option.fit is None:
        return option
    after = search.state([*before.causes, cause], before.problem, refine=False)
    more = 0.5 * max(search.gained(before, after) - option.q, 0.0)
    return replace(option, log_b=option.log_b + more, raw=option.raw + more)


def _once(rivals: list[tuple[Option, float]]) -> list[tuple[Option, float]]:
    """Each effect at each place once: another gyro that a crosstalk may come from makes no other rival."""
    out: dict[object, tuple[Option, float]] = {}
    for option, chance in rivals:
        place = option.key if option.key[0] == "channel_swap" else option.key[:3]
        first = out.get(place)
        out[place] = (first[0], first[1] + chance) if first else (option, chance)
    return sorted(out.values(), key=lambda x: -x[1])
