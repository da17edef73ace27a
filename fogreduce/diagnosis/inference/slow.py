"""The posterior over sets of causes in block means, linear about the set that was found on the simulator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.causes import SHAPES, Cause
from fogreduce.diagnosis.inference.evidence import Field, Fit
from fogreduce.diagnosis.inference.library import Library, at_point
from fogreduce.diagnosis.inference.model import modelled_change
from fogreduce.diagnosis.inference.noise_model import Metric
from fogreduce.diagnosis.inference.regression import Member
from fogreduce.diagnosis.inference.search import Ground, Search, State
from fogreduce.diagnosis.inference.sets import CauseSet, SetSearch

Array = NDArray[np.float64]

#: Of linearising; of taking in points of long grids. Each ends by itself, mostly in its second round.
_ROUNDS = 4
#: Half a cell of the grids of time constants and widths, relative.
_CELL = 0.25


@dataclass(frozen=True)
class SlowPosterior:
    """Sets of causes of one ground.

    Attributes
    ----------
    sets : SetSearch
        With every set that was met.
    best : CauseSet
    state : State
        The causes, those given beforehand first, then the best set's, fitted on the simulator.
    given : tuple of Cause
        Those given beforehand.
    metric, y : Metric, (rows,) array
        What the sets were held against: linear about the best one.
    columns : (rows, P) array
        Of the regression, whitened.
    """

    sets: SetSearch
    best: CauseSet
    state: State
    given: tuple[Cause, ...]
    metric: Metric
    y: Array
    columns: Array

    @property
    def log_evidence(self) -> float:
        """Ln density of the residual, over sets' prior: comparable between grounds of other noise."""
        whiten = self.state.ground.whiten
        noise = sum(float(np.sum(np.log(np.diag(matrix)))) for matrix in whiten.filters.values())
        _, size = np.linalg.slogdet(np.eye(len(self.metric.inner)) + self.metric.inner)
        return noise - 0.5 * (Field.of(self.metric, self.y).chi2 + float(size)) + self.best.score

    def fit(self, entry: int) -> Fit:
        """A cause of the best set as the fit of its candidate."""
        member = next(m for m in self.best.members if self.sets.entry(m) == entry)
        return fit_of(self.sets, self.best, member)


@dataclass(frozen=True)
class _About:
    """What sets are searched in: candidates of a ground, a residual and its metric, a set to start from."""

    ground: Ground
    library: Library
    metric: Metric
    y: Array
    members: tuple[Member, ...]


def slow_posterior(search: Search, ground: Ground, given: Sequence[Cause] = ()) -> SlowPosterior:
    """Search sets of causes beside some that are given.

    Parameters
    ----------
    search : Search
    ground : Ground
        Noise, stated uncertainties and candidates.
    given : causes
        In every set: what the full rate has named.
    """
    state = search.state(given, ground, refine=False)
    taken = {c.key for c in given}
    candidates = [c for c in ground.candidates if c.key not in taken]
    about = _About(
        ground, Library(candidates, ground.whiten.rows.total), state.field.metric, state.field.y, ()
    )
    sets, best = _searched(about)
    for _ in range(_ROUNDS):
        entries = sets.entries(best.members)
        if not entries:
            break
        causes = [cause_of(sets, best, m) for m in best.members]
        state = search.state([*given, *causes], about.ground)
        about = _linear(search, sets, best, state, about)
        sets, best = _searched(about)
        if sets.entries(best.members) == entries:
            break
    if sets.entries(best.members) != {*_entries_of(sets, state.causes)}:
        state = search.state([*given, *(cause_of(sets, best, m) for m in best.members)], about.ground)
    return SlowPosterior(sets, best, state, tuple(given), about.metric, about.y, about.library.columns)


def _entries_of(sets: SetSearch, causes: Sequence[Cause]) -> list[int]:
    """The entries that causes have in a regression."""
    known = {one.key: entry for entry, one in enumerate(sets.regression.entries)}
    return [known[c.key] for c in causes if c.key in known]


def _searched(about: _About) -> tuple[SetSearch, CauseSet]:
    """The best set, points of long grids taken in where they gain anything beside it."""
    about.library.widened(Field.of(about.metric, about.y))
    members = about.members
    for _ in range(_ROUNDS):
        sets = SetSearch(about.library.regression(about.metric, about.y))
        best = sets.best(members)
        columns = about.library.columns[:, best.fit.columns]
        exact = [o.columns[0] for o in (sets.regression.options[m.option] for m in best.members) if o.fixed]
        left = about.y - about.library.columns[:, exact].sum(axis=1)
        members = best.members
        if not about.library.widened(Field.of(about.metric.beside(columns), left)):
            break
    return sets, best


def fit_of(sets: SetSearch, here: CauseSet, member: Member) -> Fit:
    """A member of a set as the fit of its candidate at its point."""
    option = sets.regression.options[member.option]
    whole = at_point(option.candidate, option.point)
    less = sets.without(here, [option.entry])
    log_b = here.fit.log_b - less.fit.log_b
    if option.fixed:
        return Fit(whole, log_b, 0, 2.0 * log_b, np.ones(1), np.zeros((1, 1)))
    where = [int(np.flatnonzero(here.fit.columns == c)[0]) for c in option.columns]
    mean, covariance = here.fit.mean[where], here.fit.covariance[np.ix_(where, where)]
    q = float(mean @ np.linalg.solve(covariance, mean))
    return Fit(whole, log_b, 0, q, mean, covariance)


def cause_of(sets: SetSearch, here: CauseSet, member: Member) -> Cause:
    """A member of a set as a cause, at its most probable size."""
    return Cause.of_fit(fit_of(sets, here, member))


def _linear(
    search: Search,
    sets: SetSearch,
    best: CauseSet,
    state: State,
    about: _About,
) -> _About:
    """The same search, linear about a set as it was fitted.

    Errors of its time constants and instants are marginalised, and so is how its sizes may wander.
    """
    ground, library = about.ground, about.library
    number = 0
    y = state.ground.y - state.model.change
    free: list[Array] = []
    members: list[Member] = []
    slow = [c for c in state.causes if c.slow]
    for cause in slow:
        names = list(cause.theta)
        slopes = state.model.slopes[:, number : number + len(names)]
        number += len(names)
        member = next((m for m in best.members if _key(sets, m) == cause.key), None)
        if member is None:
            continue
        option = sets.regression.options[member.option]
        scales = option.candidate.scales
        bent = [k for k, name in enumerate(names) if option.fixed or (name in SHAPES and name not in scales)]
        free += [slopes[:, k] * _cell(cause, names[k], search) for k in bent]
        sizes = np.array([cause.theta[name] for name in scales])
        if not bent and not SHAPES.keys() & set(scales):
            y = y + library.columns[:, option.columns] @ (sizes / option.candidate.steps[option.point])
            members.append(member)
            continue
        if bent and not option.fixed:
            block, steps = slopes[:, [names.index(name) for name in scales]], np.ones(len(scales))
        else:
            others = [c for c in slow if c is not cause]
            without = modelled_change(search.data.inputs, others, ground.whiten, ground.nominal)
            block, steps = (state.model.change - without)[:, None], sizes if scales else np.ones(1)
        y = y + block @ (sizes / steps if scales else np.ones(1))
        members.append(replace(member, option=library.settled(option, block, steps, _shape(cause, scales))))
    metric = ground.metric
    if free:
        metric = metric.wider(np.column_stack(free))
    return _About(ground, library, metric.wider(state.shapes), y, tuple(members))


def _cell(cause: Cause, name: str, search: Search) -> float:
    """How far a parameter of shape may be from where it was found: a cell of its grid."""
    if name == "time_s":
        return search.data.inputs[0].scene.blocks.length_s
    return _CELL * abs(cause.theta[name])


def _key(sets: SetSearch, member: Member) -> tuple[object, ...]:
    return sets.regression.entries[sets.entry(member)].key


def _shape(cause: Cause, scales: Sequence[str]) -> dict[str, object]:
    """Parameters of a cause that no column scales."""
    return {**cause.settled, **{name: value for name, value in cause.theta.items() if name not in scales}}
