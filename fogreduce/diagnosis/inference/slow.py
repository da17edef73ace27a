"""The posterior over sets of causes in block means, linear about the set that was found on the simulator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.causes import SHAPES, Cause
from fogreduce.diagnosis.inference.evidence import Fit, WhitenedResidual
from fogreduce.diagnosis.inference.gross import gross
from fogreduce.diagnosis.inference.library import Library, at_point
from fogreduce.diagnosis.inference.model import modelled_change
from fogreduce.diagnosis.inference.noise_model import Metric, Rows
from fogreduce.diagnosis.inference.problem import Problem, State
from fogreduce.diagnosis.inference.regression import Member
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.inference.sets import CauseSet, SetSearch
from fogreduce.diagnosis.inference.sizes import width_believed
from fogreduce.effects.gyro_names import gyro_name

Array = NDArray[np.float64]

#: Of linearising; of taking in points of long grids. Each ends by itself, mostly in its second round.
_ROUNDS = 4
#: Of a parameter's unit: as good as nothing.
_NONE = 1e-9
#: Half a cell of the grids of time constants and widths, relative.
_CELL = 0.25


@dataclass(frozen=True)
class SlowPosterior:
    """Sets of causes of one problem.

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
    unclosed : tuple of int
        Gyros with a gross gap that no set of causes closes; what is found there is held against a noise that
        has the rest of it.
    """

    sets: SetSearch
    best: CauseSet
    state: State
    given: tuple[Cause, ...]
    metric: Metric
    y: Array
    columns: Array
    unclosed: tuple[int, ...] = ()

    @property
    def log_evidence(self) -> float:
        """Ln density of the residual, over sets' prior: comparable between problems of other noise."""
        whiten = self.state.problem.whiten
        noise = sum(float(np.sum(np.log(np.diag(matrix)))) for matrix in whiten.filters.values())
        _, size = np.linalg.slogdet(np.eye(len(self.metric.inner)) + self.metric.inner)
        return noise - 0.5 * (WhitenedResidual.of(self.metric, self.y).chi2 + float(size)) + self.best.score

    def with_free(self, here: CauseSet) -> tuple[Metric, Array]:
        """The metric in which a set's amplitudes are free, and the residual less what has no amplitude."""
        return _free(self.columns, self.metric, self.y, self.sets, here)

    def fit(self, entry: int) -> Fit:
        """A cause of the best set as the fit of its candidate."""
        member = next(m for m in self.best.members if self.sets.entry(m) == entry)
        return fit_of(self.sets, self.best, member)


@dataclass(frozen=True)
class _About:
    """What sets are searched in: candidates of a problem, a residual and its metric, a set to start from."""

    problem: Problem
    library: Library
    metric: Metric
    y: Array
    members: tuple[Member, ...]


@dataclass(frozen=True)
class Begun:
    """A first search, linear about what is given: nothing of its set is simulated yet.

    Attributes
    ----------
    state : State
        What is given and what is gross, fitted.
    given : tuple of Cause
    unclosed : tuple of int
    sets, best : SetSearch, CauseSet
    about : what sets were searched in
    """

    state: State
    given: tuple[Cause, ...]
    unclosed: tuple[int, ...]
    sets: SetSearch
    best: CauseSet
    about: _About

    @property
    def closes(self) -> float:
        """Ln likelihood that the best set gains."""
        about = self.about
        left = WhitenedResidual.of(*_free(about.library.columns, about.metric, about.y, self.sets, self.best))
        return 0.5 * (WhitenedResidual.of(about.metric, about.y).chi2 - left.chi2)


def slow_posterior(search: Search, problem: Problem, given: Sequence[Cause] = ()) -> SlowPosterior:
    """Search sets of causes beside some that are given.

    Parameters
    ----------
    search : Search
    problem : Problem
        Noise, stated uncertainties and candidates.
    given : causes
        In every set: what the full rate has named, and processes.
    """
    return completed(search, begun(search, problem, given))


def begun(search: Search, problem: Problem, given: Sequence[Cause] = ()) -> Begun:
    """The first search, of `slow_posterior`."""
    first = gross(search, search.state(given, problem, refine=False))
    given, state = [*given, *first.settled], first.state
    about = _about(search, state, first.others)
    unclosed = _unclosed(search, given, about)
    if unclosed:
        # what is gross and has a name stays; no more is named of those gyros
        given, whole = (
            state.causes,
            _squares(state.residual.metric, state.residual.y, state.problem.whiten.rows),
        )
        times = {i: max(float(np.sqrt(whole[i])), 1.0) for i in unclosed}
        problem = search.problem_with(_base(state), times)
        about = _about(search, search.state(given, problem, refine=False), (), unclosed)
    sets, best = _searched(about)
    return Begun(state, tuple(given), unclosed, sets, best, about)


def completed(search: Search, first: Begun) -> SlowPosterior:
    """The search, linear about the set that was found on the simulator, until that is the same."""
    state, given, sets, best, about = first.state, first.given, first.sets, first.best, first.about
    for _ in range(_ROUNDS):
        entries = sets.entries(best.members)
        if not entries:
            break
        state = _simulated(search, sets, best, given, about)
        about = _linear(search, sets, best, state, about)
        sets, best = _searched(about)
        if sets.entries(best.members) == entries:
            break
    if sets.entries(best.members) != {*_entries_of(sets, state.causes)}:
        state = _simulated(search, sets, best, given, about)
    columns = about.library.columns
    return SlowPosterior(sets, best, state, given, about.metric, about.y, columns, first.unclosed)


def _simulated(
    search: Search, sets: SetSearch, best: CauseSet, given: Sequence[Cause], about: _About
) -> State:
    """The causes of a set, fitted on the simulator beside those given."""
    return search.state([*given, *(cause_of(sets, best, m) for m in best.members)], about.problem)


def _base(state: State) -> list[Cause]:
    """Causes that a problem has in its noise or its chain."""
    return [c for c in state.causes if c.process or c.key in state.problem.base]


def _unclosed(search: Search, given: Sequence[Cause], about: _About) -> tuple[int, ...]:
    """Gyros with a gross gap, where causes of the catalogue, however many, do not close it at sizes that are
    believed.
    """
    rows = about.problem.whiten.rows
    whole = _squares(about.metric, about.y, rows)
    if np.sum(whole) < priors.GROSS_GAP**2:
        return ()
    for _ in range(_ROUNDS):
        about.library.widened(WhitenedResidual.of(about.metric, about.y))
        sets = SetSearch(about.library.regression(about.metric, about.y))
        best = sets.grown(sets.of(about.members))
        metric, y = _free(about.library.columns, about.metric, about.y, sets, best)
        left = _squares(metric, y, rows)
        sized = _believed(sets, best)
        if np.max(left) < priors.GROSS**2 and sized:
            return ()
        if not sized or np.any(left > priors.DEPARTURE**2 * whole):
            break  # no small step from the chain that it is linear about
        about = _linear(search, sets, best, _simulated(search, sets, best, given, about), about)
    return tuple(i for i in range(rows.n) if whole[i] >= priors.GROSS**2)


def _believed(sets: SetSearch, best: CauseSet) -> bool:
    """Whether no cause of a set is larger than is believed."""
    start = 0
    for option in (sets.regression.options[m.option] for m in best.members):
        if option.fixed:
            if not width_believed(option.candidate, option.point):
                return False
            continue
        mean = best.fit.mean[start : start + len(option.columns)]
        start += len(option.columns)
        if np.sum(mean**2 / option.variances[-1]) > priors.LARGEST**2:
            return False
    return True


def _free(columns: Array, metric: Metric, y: Array, sets: SetSearch, here: CauseSet) -> tuple[Metric, Array]:
    """The metric in which a set's amplitudes are free, and the residual less what has no amplitude."""
    exact = [o.columns[0] for o in (sets.regression.options[m.option] for m in here.members) if o.fixed]
    left = y - columns[:, exact].sum(axis=1)
    return metric.with_free(columns[:, here.fit.columns]), left


def _squares(metric: Metric, y: Array, rows: Rows) -> Array:
    """Squared deviates of each gyro (n,) beyond their expectation, nuisances taken out."""
    left = metric.without(y)
    parts = [left[rows.of(i)] for i in range(rows.n)]
    return np.array([max(float(part @ part) - len(part), 0.0) for part in parts])


def _about(search: Search, state: State, first: Sequence[Fit], unclosed: Sequence[int] = ()) -> _About:
    """The candidates of a problem less those of unclosed gyros; gross causes in its chain stand among them as
    they were fitted.
    """
    problem = state.problem
    base = {fit.candidate.key for fit in first}
    taken = {c.key for c in state.causes} - base
    shut = {gyro_name(i) for i in unclosed}
    whole = len(shut) == problem.whiten.rows.n
    candidates = [
        c
        for c in problem.candidates
        if c.key not in taken | base and not shut.issuperset(c.channels) and not (whole and c.fixed)
    ]
    library = Library([*candidates, *(fit.candidate for fit in first)], problem.whiten.rows.total)
    if not first:
        return _About(problem, library, state.residual.metric, state.residual.y, ())
    y, members = problem.y - state.model.change, []
    for fit in first:
        cause = next(c for c in state.causes if c.key == fit.candidate.key)
        block, steps = _block(search, state, cause, fit.candidate.scales)
        sizes = _sizes(cause, fit.candidate.scales) / steps
        y = y + block @ sizes
        shape = _shape(cause, fit.candidate.scales)
        settled, share = at_point(fit.candidate, fit.best), float(fit.candidate.log_weights[fit.best])
        number = library.settled(settled, share, block, steps, shape)
        members.append(library.member(number, sizes))
    return _About(problem, library, problem.metric.wider(state.shapes), y, tuple(members))


def _entries_of(sets: SetSearch, causes: Sequence[Cause]) -> list[int]:
    """The entries that causes have in a regression."""
    entries = {one.key: entry for entry, one in enumerate(sets.regression.entries)}
    return [entries[c.key] for c in causes if c.key in entries]


def _searched(about: _About) -> tuple[SetSearch, CauseSet]:
    """The best set, points of long grids taken in where they gain anything beside it."""
    about.library.widened(WhitenedResidual.of(about.metric, about.y))
    members = about.members
    for _ in range(_ROUNDS):
        sets = SetSearch(about.library.regression(about.metric, about.y))
        best = sets.best(members)
        members = best.members
        if not about.library.widened(
            WhitenedResidual.of(*_free(about.library.columns, about.metric, about.y, sets, best))
        ):
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


def _linear(search: Search, sets: SetSearch, best: CauseSet, state: State, about: _About) -> _About:
    """The same search, linear about a set as it was fitted.

    Errors of its time constants and instants are marginalised, and so is how its sizes may wander.
    """
    problem, library = about.problem, about.library
    y = state.problem.y - state.model.change
    free: list[Array] = []
    members: list[Member] = []
    for cause in (c for c in state.causes if c.slow):
        member = next((m for m in best.members if _key(sets, m) == cause.key), None)
        if member is None:
            continue
        option = sets.regression.options[member.option]
        scales = option.candidate.scales
        bent = [n for n in cause.theta if option.fixed or (n in SHAPES and n not in scales)]
        if bent:
            size = np.array([_cell(cause, name, search) for name in bent])
            if option.fixed:
                # all that it does goes with that number: by more than its error it would be free altogether
                size = np.minimum(size, [cause.std.get(name, np.inf) for name in bent])
            free.append(_slopes(state, cause, bent) * size)
        if bent or option.fixed or SHAPES.keys() & set(scales) or cause.key in problem.base:
            block, steps = _block(search, state, cause, scales)
            settled = at_point(option.candidate, option.point)
            shape = _shape(cause, scales)
            number = library.settled(settled, option.log_weight, block, steps, shape)
            member = replace(member, option=number)
        else:
            block, steps = library.columns[:, option.columns], option.candidate.steps[option.point]
        y = y + block @ (_sizes(cause, scales) / steps)
        members.append(member)
    metric = problem.metric
    if free:
        metric = metric.wider(np.column_stack(free))
    return _About(problem, library, metric.wider(state.shapes), y, tuple(members))


def _slopes(state: State, cause: Cause, names: Sequence[str]) -> Array:
    """Derivatives (rows, k) of block means, whitened, by some of a cause's numbers."""
    start = 0
    for one in state.causes:
        if one is cause:
            break
        start += len(one.theta) if one.slow else 0
    return state.model.slopes[:, [start + list(cause.theta).index(name) for name in names]]


def _block(search: Search, state: State, cause: Cause, scales: Sequence[str]) -> tuple[Array, Array]:
    """Columns (rows, k) of a cause as it was fitted, whitened, and what a coefficient of one means (k,).

    Of what is not linear in its number, or has none: all that the cause changes, simulated; else the
    derivatives.
    """
    linear = not SHAPES.keys() & set(scales) or abs(cause.theta[scales[0]]) < _NONE
    if scales and linear:
        return _slopes(state, cause, scales), np.ones(len(scales))
    problem = state.problem
    others = [c for c in state.causes if c.slow and c is not cause]
    without = modelled_change(search.data.inputs, others, problem.whiten, problem.nominal)
    return (state.model.change - without)[:, None], _sizes(cause, scales)


def _sizes(cause: Cause, scales: Sequence[str]) -> Array:
    """Numbers of a cause that columns scale (k,); one for what has none."""
    return np.array([cause.theta[name] for name in scales]) if scales else np.ones(1)


def _cell(cause: Cause, name: str, search: Search) -> float:
    """How far a parameter of shape may be from where it was found: a cell of its grid."""
    if name == "time_s":
        # by more than its error it would be free to have begun with the run
        return min(search.data.inputs[0].scene.blocks.length_s, cause.std.get(name, np.inf))
    return _CELL * abs(cause.theta[name])


def _key(sets: SetSearch, member: Member) -> tuple[object, ...]:
    return sets.regression.entries[sets.entry(member)].key


def _shape(cause: Cause, scales: Sequence[str]) -> dict[str, object]:
    """Parameters of a cause that no column scales."""
    return {**cause.settled, **{name: value for name, value in cause.theta.items() if name not in scales}}
