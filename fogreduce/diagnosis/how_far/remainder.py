"""What is left beside the causes, tested: every statistic against what noise makes of it, look-elsewhere
counted.

An effect of the catalogue is an idealisation. What a departure from its shape could leave, a share of its own
size at any strength, stands out from noise all the same and is shown; it is nothing further.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.how_far.closure import Closure
from fogreduce.diagnosis.how_far.shapes import departed
from fogreduce.diagnosis.how_far.simulated import Simulated, Source
from fogreduce.diagnosis.inference.candidates import Candidates
from fogreduce.diagnosis.inference.evidence import WhitenedResidual
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.inference.outcome import Verdict
from fogreduce.diagnosis.inference.problem import State
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.inference.significance import deviate
from fogreduce.diagnosis.where.places import Place, farthest, places
from fogreduce.diagnosis.which.unknown.resembles import Resemblance, resembling
from fogreduce.physics.special import log_normal_tail

#: The least significance of what is listed: that of the test itself.
_LEAST = deviate(float(np.log(priors.REMAINDER)))


@dataclass(frozen=True)
class Remainder:
    """What is left.

    Attributes
    ----------
    p_value : float
        Probability that noise and stated uncertainties alone leave a statistic as far out as the farthest.
    shown : tuple of Place
        Where something stands out, or where one cause does what a departure of another does.
    further : tuple of Place
        Where it stands out by more than departures of the causes from their shapes could.
    kin : tuple of Resemblance
        Effects whose shapes come nearest to that.
    """

    p_value: float
    shown: tuple[Place, ...]
    further: tuple[Place, ...]
    kin: tuple[Resemblance, ...] = ()

    @property
    def significant(self) -> bool:
        """Whether noise and stated uncertainties do not account for what is left."""
        return self.p_value < priors.REMAINDER


def remaining(search: Search, state: State, source: Source | None = None) -> Remainder:
    """Test what a set of causes leaves.

    Parameters
    ----------
    search : Search
    state : State
        The causes, fitted on the simulator; none of them: the whole gap is what is left.
    source : Source or None
        What captures are simulated from, where something stands out beside causes.
    """
    problem = state.problem
    # causes at the sizes that fit best, of exactly the catalogue's shapes
    exact = WhitenedResidual.of(problem.metric.with_free(state.model.slopes), problem.y - state.model.change)
    findings = problem.full_rate.findings(state.causes)
    sigma = farthest(exact, problem.families, findings, _unnamed(search, state))
    p = _chance(sigma)
    named = departed(search, state)
    if p >= priors.REMAINDER:
        return Remainder(p, tuple(named), ())
    shown = [*named, *_places(search, state, exact, findings, exact=True)]
    further = _places(search, state, state.residual, findings, exact=False)
    if further and state.causes and source is not None:
        simulated = Simulated(search, state, source)
        shown, further = ([simulated.left_of(p) for p in part] for part in (shown, further))
        shown, further = ([p for p in part if p.sigma >= _LEAST] for part in (shown, further))
        p = _chance(max((p.sigma for p in shown), default=0.0))
    kin = resembling(state.residual, problem.candidates, findings, further)
    shown.sort(key=lambda place: -place.sigma)
    return Remainder(p, tuple(shown), tuple(further), tuple(kin))


def _chance(sigma: float) -> float:
    """Probability of a normal deviate beyond this; 1 where look-elsewhere takes all."""
    return float(np.exp(log_normal_tail(-sigma))) if sigma > 0.0 else 1.0


def _unnamed(search: Search, state: State) -> Callable[[WhitenedResidual], list[Finding]]:
    """Random processes that no effect makes, found in a residual."""

    def processes(residual: WhitenedResidual) -> list[Finding]:
        return [f for f in state.problem.processes.findings(residual, search.allowed) if not f.catalogued]

    return processes


def _places(
    search: Search, state: State, residual: WhitenedResidual, findings: Iterable[Finding], exact: bool
) -> list[Place]:
    """Where it stands out; unless `exact`, less what departures from the causes' shapes could make."""

    def doubt(channels: Sequence[str]) -> float:
        if exact:
            return 0.0
        return float(np.hypot(search.doubt_at(state, channels), _implied(state, channels)))

    left = [f if exact else _less(f, _implied(state, f.channels)) for f in findings]
    processes, run_ids = _unnamed(search, state), search.data.run_ids
    found = places(residual, state.problem.families, left, processes, run_ids, doubt, _LEAST)
    seats = {c.channels for c in state.causes}
    if not exact or {p.channels for p in found} & seats:
        return found
    # what a gyro's cause leaves looks like a motion of all where few of them are at work
    of_seats = Candidates([f for f in state.problem.families if f.channels in seats])
    return [*places(residual, of_seats, [], lambda _: [], run_ids, doubt, _LEAST), *found]


def _implied(state: State, channels: Sequence[str]) -> float:
    """Signal-to-noise ratio that full-rate causes not quite of their shape may have in any statistic of these
    channels: samples held in bursts leave a band, a line that drifts leaves its neighbours.
    """
    mine = [c.finding.snr2 for c in state.causes if c.finding is not None and {*c.channels} & {*channels}]
    return priors.DEPARTURE * float(np.sqrt(max(mine, default=0.0)))


def _less(finding: Finding, size: float) -> Finding:
    """A finding less a signal-to-noise ratio."""
    return replace(finding, snr2=float(max(np.sqrt(max(finding.snr2, 0.0)) - size, 0.0) ** 2))


def borne_out(verdict: Verdict, closure: Closure, remainder: Remainder) -> Verdict:
    """The verdict that the test of what is left bears out.

    `explained` is what closes, within the closure's error, and leaves nothing further. Where what is left is
    no noise, it can only be the causes' departures from their shapes: then the closure must reach what these
    would leave, at most what `explained` allows at all.
    """
    if verdict.word == "no_gap" or not verdict.state.causes:
        return verdict
    reach = priors.CLOSED
    if remainder.significant:
        reach = max(reach, 1.0 - max(priors.DEPARTURE**2, closure.departed))
    short = (reach - closure.fraction) / max(closure.std, 1e-9)
    if short <= 1.96 and not remainder.further:
        # what passed for unknown in the search is the causes' own, unless they fall short all the same
        unknown = min(verdict.unknown_probability, 0.5, _chance(-short))
        return replace(verdict, word="explained", unknown_probability=unknown)
    unknown = max(verdict.unknown_probability, 1.0 - _chance(short))
    if remainder.further:
        sigma = max(p.sigma for p in remainder.further)
        unknown = max(unknown, 1.0 - _chance(sigma))
    return replace(verdict, word="partly_explained", unknown_probability=unknown)
