"""Causes that together do what one cause of another shape does.

A cause that does nothing but what a departure from another's shape does (a slope of temperature, what a coil
late behind its sensor adds to a bias) shows that departure. One without a size of its own, beside one that a
temperature drives and which may depart from its shape by more, is such a departure; several causes of a place
of which none has a size stand for a shape that the catalogue has not. They are not judged present.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.causes import SHAPES, Cause
from fogreduce.diagnosis.inference.departures import lateness
from fogreduce.diagnosis.inference.outcome import Verdict, less_causes
from fogreduce.diagnosis.inference.problem import State
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.inference.significance import significance
from fogreduce.diagnosis.where.places import Place
from fogreduce.effects.selection import Action
from fogreduce.effects.table import EFFECTS

Array = NDArray[np.float64]

_SIZED = 2.0  # standard deviations of a size that is known to be any
_SEVERAL = 3  # causes that stand for one shape
_MOSTLY = 0.8  # cosine between what a cause does and what lateness of another does


def without_imitations(search: Search, verdict: Verdict) -> Verdict:
    """The verdict less causes without a size of their own: three and more of a place that are all there is,
    or smaller ones than what a temperature drives there may depart by.
    """
    by_place: dict[tuple[str, ...], list[Cause]] = {}
    for cause in verdict.state.causes:
        if cause.slow and cause.theta and cause.std:
            by_place.setdefault(cause.channels, []).append(cause)
    gone, all_unsized = set(), False
    for causes in by_place.values():
        unsized = [c for c in causes if _sizes(c) < _SIZED]
        if len(unsized) == len(causes) >= _SEVERAL:
            gone |= {c.key for c in unsized}
            all_unsized = True
        warm = [c for c in causes if EFFECTS[c.effect].needs_temperature and c not in unsized]
        if warm and unsized:
            most = priors.WARM_DEPARTURE * max(_strength(search, c) for c in warm)
            gone |= {c.key for c in unsized if _strength(search, c) < most}
    if not gone:
        return verdict
    state, named = less_causes(search, verdict.state, verdict.named, gone)
    word, unknown = verdict.word, verdict.unknown_probability
    if all_unsized:
        word, unknown = "partly_explained" if named else "unexplained", max(unknown, 0.5)
    return replace(
        verdict,
        word=word,
        unknown_probability=unknown,
        state=state,
        left=search.options(state),
        named=tuple(named),
    )


def _sizes(cause: Cause) -> float:
    """The largest of a cause's sizes in standard deviations."""
    sizes = [abs(v) / max(cause.std[k], 1e-300) for k, v in cause.theta.items() if k not in SHAPES]
    return max(sizes, default=np.inf)


def departed(search: Search, state: State) -> list[Place]:
    """Places at which a cause does what another does that is driven by a temperature and comes late."""
    data, rows = search.data, state.problem.whiten.rows
    slow = [c for c in state.causes if c.slow and c.theta and c.std]
    warm = [c for c in slow if EFFECTS[c.effect].needs_temperature]
    out = []
    for other in warm:
        actions = [other.action(data.run_ids, data.n)]
        driven = _change(search, actions)
        late, start = lateness(data.inputs, actions, rows)
        start = state.problem.whiten(start)
        late = _without(start, state.problem.whiten(late[:, None])[:, 0])
        for one in (c for c in slow if c.channels == other.channels and c is not other):
            change = _without(start, _change(search, [one.action(data.run_ids, data.n)]))
            size = float(np.linalg.norm(change)) * float(np.linalg.norm(late))
            alike = float(change @ late) / max(size, 1e-300)
            if alike > _MOSTLY and change @ change < driven @ driven:
                out.append(_place(one, data.run_ids))
    return out


def _strength(search: Search, cause: Cause) -> float:
    """Signal-to-noise ratio of all that a cause changes."""
    return float(np.linalg.norm(_change(search, [cause.action(search.data.run_ids, search.data.n)])))


def _without(columns: Array, change: Array) -> Array:
    """A change (rows,) less what columns (rows, R) can make of it."""
    return np.asarray(change - columns @ np.linalg.lstsq(columns, change, rcond=None)[0])


def _change(search: Search, actions: Sequence[Action]) -> Array:
    """What effects change, whitened (rows,)."""
    whiten = search.problem.whiten
    parts = [one.scene.block_means(actions) - one.scene.block_means() for one in search.data.inputs]
    return whiten(whiten.rows.stacked(parts)[:, None])[:, 0]


def _place(one: Cause, run_ids: Sequence[str]) -> Place:
    q = _sizes(one) ** 2
    runs = tuple(run_ids) if one.runs == ("*",) else one.runs
    return Place("gyro", one.channels, runs, "temperature", significance(q, 1, 1.0), q, 1)
