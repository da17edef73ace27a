"""Causes that together do what one cause of another shape does.

A cause that does nothing but what a departure from another's shape does (a slope of temperature, what a coil
late behind its sensor adds to a bias) shows that departure. Several causes at one place of which none has a
size of its own stand for a shape that the catalogue has not: they are not judged present.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.causes import SHAPES, Cause
from fogreduce.diagnosis.inference.departures import lateness
from fogreduce.diagnosis.inference.ground import State
from fogreduce.diagnosis.inference.outcome import Verdict
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
    """The verdict less causes at one place, three or more, of which none has a size of its own."""
    by_place: dict[tuple[str, ...], list[Cause]] = {}
    for cause in verdict.state.causes:
        if cause.slow and cause.theta and cause.std:
            by_place.setdefault(cause.channels, []).append(cause)
    gone = {
        c.key
        for causes in by_place.values()
        if len(causes) >= _SEVERAL and all(_sizes(c) < _SIZED for c in causes)
        for c in causes
    }
    if not gone:
        return verdict
    state = verdict.state
    kept = [k for k, c in enumerate(state.causes) if c.key not in gone]
    numbers = {k: number for number, k in enumerate(kept)}
    state = search.state([state.causes[k] for k in kept], state.ground)
    named = tuple(replace(one, index=numbers[one.index]) for one in verdict.named if one.index in numbers)
    word = "partly_explained" if named else "unexplained"
    unknown = max(verdict.unknown_probability, 0.5)
    return replace(
        verdict, word=word, unknown_probability=unknown, state=state, left=search.options(state), named=named
    )


def _sizes(cause: Cause) -> float:
    """The largest of a cause's sizes in standard deviations."""
    own = [abs(v) / max(cause.std[k], 1e-300) for k, v in cause.theta.items() if k not in SHAPES]
    return max(own, default=np.inf)


def departed(search: Search, state: State) -> list[Place]:
    """Places at which a cause does what another does that is driven by a temperature and comes late."""
    data, rows = search.data, state.ground.whiten.rows
    slow = [c for c in state.causes if c.slow and c.theta and c.std]
    warm = [c for c in slow if EFFECTS[c.effect].needs_temperature]
    out = []
    for other in warm:
        actions = [other.action(data.run_ids, data.n)]
        driven = _change(search, actions)
        late = state.ground.whiten(lateness(data.inputs, actions, rows)[:, None])[:, 0]
        for one in (c for c in slow if c.channels == other.channels and c is not other):
            change = _change(search, [one.action(data.run_ids, data.n)])
            size = float(np.linalg.norm(change)) * float(np.linalg.norm(late))
            alike = float(change @ late) / max(size, 1e-300)
            if alike > _MOSTLY and change @ change < driven @ driven:
                out.append(_place(one, data.run_ids))
    return out


def _change(search: Search, actions: Sequence[Action]) -> Array:
    """What effects change, whitened (rows,)."""
    whiten = search.ground.whiten
    parts = [one.scene.block_means(actions) - one.scene.block_means() for one in search.data.inputs]
    return whiten(whiten.rows.stacked(parts)[:, None])[:, 0]


def _place(one: Cause, run_ids: Sequence[str]) -> Place:
    q = _sizes(one) ** 2
    runs = tuple(run_ids) if one.runs == ("*",) else one.runs
    return Place("gyro", one.channels, runs, "temperature", significance(q, 1, 1.0), q, 1)
