"""Causes that the full rate shows: lines, levels, link and codes, each statistic a factor of its own.

What one of them finds is explained there and ends no other's search.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.findings import Finding, joined
from fogreduce.diagnosis.inference.options import log_prior_of
from fogreduce.diagnosis.inference.problem import State
from fogreduce.diagnosis.inference.search import Search

_MOST = 60  # a bound on a loop that ends by itself: findings beside those taken


@dataclass(frozen=True)
class FullRateCauses:
    """What the full rate names.

    Attributes
    ----------
    causes : tuple of Cause
    scores : tuple of float
        Ln posterior odds of each when it was taken.
    unknown : tuple of Finding
        What is there, and no effect of the catalogue does as well.
    """

    causes: tuple[Cause, ...]
    scores: tuple[float, ...]
    unknown: tuple[Finding, ...]


def full_rate_causes(search: Search, state: State, given: Sequence[Cause] = ()) -> FullRateCauses:
    """Take what the full rate shows, the most probable first, each beside those before it and those given.

    Parameters
    ----------
    search : Search
    state : State
        Its problem has the full rate; its residual is what gross causes leave.
    given : causes
        Faulty wiring and the like, named already.
    """
    full_rate = state.problem.full_rate
    causes: list[Cause] = []
    scores: list[float] = []
    unknown: dict[tuple[str, tuple[str, ...]], Finding] = {}
    slow = state.problem.processes.findings(state.residual, search.allowed)
    for _ in range(_MOST):
        found = [f for f in full_rate.findings([*given, *causes]) if (f.domain, f.channels) not in unknown]
        shown = {f.key for f in found if f.process is not None and f.log_b > 0.0}
        found = joined(found, [f for f in slow if f.key in shown])
        taken = {c.key for c in causes}
        found = [f for f in found if f.key not in taken]
        best = max(found, key=_odds, default=None)
        if best is None or _odds(best) <= 0.0:
            break
        if best.catalogued:
            causes.append(Cause.of_finding(best))
            scores.append(_odds(best))
        else:
            unknown[best.domain, best.channels] = best
    return FullRateCauses(tuple(causes), tuple(scores), tuple(unknown.values()))


def _odds(finding: Finding) -> float:
    """Ln posterior odds of a finding, beside any other causes."""
    return finding.log_b + log_prior_of(finding.catalogued, finding.share) + priors.LOG_FURTHER
