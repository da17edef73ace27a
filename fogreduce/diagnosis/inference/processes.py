"""Random processes of the catalogue among the causes: each is a hypothesis of the noise, with sets of its
own.

A process imitates any drift, and a few drifts together imitate a process. So the two are compared as wholes:
the residual's evidence under a noise with the process in it, and the best set of causes beside that, against
the evidence without it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.candidate import EVERY
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.inference.problem import Problem
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.inference.slow import Begun, SlowPosterior, begun, completed, slow_posterior
from fogreduce.effects.table import EFFECTS

_MOST = 8  # processes: a bound on a loop that ends by itself
#: What a size found among many costs, in ln evidence.
_SIZE = 1.5
#: Causes of one gyro from which on they may be a process in disguise.
_SEVERAL = 2


def with_processes(search: Search, given: Sequence[Cause]) -> SlowPosterior:
    """The best sets of causes, with as many random processes in the noise as pay."""
    first = begun(search, _problem(search, given), given)
    outright = _outright(search, first)
    if outright is None:
        here = completed(search, first)
    else:
        causes = [*first.given, Cause.of_finding(outright)]
        here = slow_posterior(search, _problem(search, causes), causes)
    tried: set[tuple[object, ...]] = set()
    for _ in range(_MOST):
        best = _most_likely(search, here, tried)
        if best is None:
            break
        tried.add(best.key)
        causes = [*here.given, Cause.of_finding(best)]
        there = slow_posterior(search, _problem(search, causes), causes)
        if there.log_evidence + process_price(best) > here.log_evidence:
            here = there
        elif there.unclosed:
            break  # what is gross there is no process either
    return here


def _outright(search: Search, first: Begun) -> Finding | None:
    """A process so much more likely than the best set of causes that no finer fit of that can make up for it:
    by more than all that the set gains; None if there is none.
    """
    if first.unclosed or not first.best.members:
        return None
    taken = {c.key for c in first.given}
    found = first.about.problem.processes.findings(first.state.residual, search.allowed)
    found = [f for f in found if f.catalogued and f.key not in taken and _believed(f)]
    best = max(found, key=lambda f: f.log_b + process_price(f), default=None)
    if best is None or best.log_b + process_price(best) < first.best.score + first.closes:
        return None
    return best


def process_price(finding: Finding) -> float:
    """Ln prior of a process at its place, and what its size costs."""
    return float(np.log(priors.KIND * finding.share)) - _SIZE


def _problem(search: Search, given: Sequence[Cause]) -> Problem:
    """The problem with processes in its noise and gross causes in its chain."""
    return search.problem_with([c for c in given if c.process or c.finding is None])


def _most_likely(search: Search, here: SlowPosterior, tried: set[tuple[object, ...]]) -> Finding | None:
    """The process that gains most beside the causes, or in place of a gyro's drifts; None if none does."""
    problem, state = here.state.problem, here.state
    if here.unclosed:
        # what no set closes may be a process: not in a noise that has it already
        problem = _problem(search, here.given)
        state = search.state(here.state.causes, problem, refine=False)
    found = [(f, f.log_b) for f in problem.processes.findings(state.residual, search.allowed)]
    for channel, gone in _drifting(here).items():
        less = here.sets.without(here.best, gone)
        keys = {here.sets.regression.entries[entry].key for entry in gone}
        state = search.state([c for c in here.state.causes if c.key not in keys], problem, refine=False)
        lost = here.best.score - less.score
        found += [
            (f, f.log_b - lost)
            for f in problem.processes.findings(state.residual, search.allowed)
            if f.channels == (channel,)
        ]
    taken = {c.key for c in here.given}
    worth = [
        (gain, f)
        for f, gain in found
        if f.catalogued and f.key not in tried | taken and gain + np.log(priors.KIND * f.share) > 0.0
        if _believed(f)
    ]
    return max(worth, key=lambda pair: pair[0])[1] if worth else None


def _drifting(here: SlowPosterior) -> dict[str, list[int]]:
    """Gyros with several causes that drift, and those causes' entries."""
    out: dict[str, list[int]] = {}
    for entry in sorted(here.sets.entries(here.best.members)):
        effect, channels, runs, _ = here.sets.regression.entries[entry].key
        if len(channels) == 1 and (EFFECTS[effect].drifts or runs != EVERY):
            out.setdefault(channels[0], []).append(entry)
    return {channel: entries for channel, entries in out.items() if len(entries) >= _SEVERAL}


def _believed(finding: Finding) -> bool:
    """Whether a process is no larger than is believed."""
    assert finding.process is not None
    size = next(p for p in EFFECTS[finding.effect].parameters if p.realistic is not None)
    assert size.realistic is not None
    return finding.process[1] <= priors.LARGEST * priors.ABOVE[-1][0] * size.realistic[1]
