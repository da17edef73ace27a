"""Gross causes go into the chain one at a time, before sets are searched.

A swapped column or a wrong sense changes what every other effect does; so the next is looked for on a chain
that has those before it, with columns, stated uncertainties and full rate of that chain.
"""

from __future__ import annotations

from dataclasses import dataclass

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.evidence import Fit
from fogreduce.diagnosis.inference.library import OF_FULL_RATE
from fogreduce.diagnosis.inference.model import DELAYS
from fogreduce.diagnosis.inference.options import log_prior_of
from fogreduce.diagnosis.inference.problem import State
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.inference.sizes import believed

#: Of the whole gap: what a gross cause with an amplitude must explain to go first.
_ALL_BUT = 0.9
#: Such causes that are simulated in vain before that is given up: columns of what is no small step mislead.
_TRIALS = 3


@dataclass(frozen=True)
class Gross:
    """Gross causes.

    Attributes
    ----------
    state : State
        With them, those given beforehand first; they stand in its problem's chain.
    settled : tuple of Cause
        Those that do not add up with others, as faulty wiring and delays: in every set.
    others : tuple of Fit
        The rest, from which sets may start.
    """

    state: State
    settled: tuple[Cause, ...]
    others: tuple[Fit, ...]


def gross(search: Search, state: State) -> Gross:
    """Take in gross causes, the most probable first.

    Parameters
    ----------
    search : Search
    state : State
        Causes that are given.
    """
    settled: set[tuple[object, ...]] = set()
    others: dict[tuple[object, ...], Fit] = {}
    out, trials = {c.key for c in state.causes}, 0
    while True:
        fits = [f for f in search.fits(state) if f.candidate.key not in out]
        fits = [f for f in fits if f.candidate.effect not in OF_FULL_RATE]
        best = max(fits, key=lambda f: f.log_b + log_prior_of(True, f.candidate.share), default=None)
        if best is None or best.q <= priors.GROSS**2:
            break
        adds_up = not (best.candidate.fixed or DELAYS.keys() & set(best.candidate.scales))
        if not believed(best):
            break
        out.add(best.candidate.key)
        # a table off in rate comes to other angles, of which its column knows nothing
        taken = search.state([*state.causes, Cause.of_fit(best)], state.problem)
        done = search.gained(state, taken)
        if adds_up and done < _ALL_BUT * (state.residual.chi2 - len(state.residual.y)):
            trials += 1
            if trials == _TRIALS:
                break
            continue
        if done < 0.5 * best.q:
            continue  # simulated, it does not do what its column promised: it was no small step
        if adds_up:
            others[best.candidate.key] = best
        else:
            settled.add(best.candidate.key)
        state = search.state(taken.causes, search.problem_with(taken.causes))
    given = tuple(c for c in state.causes if c.key in settled)
    return Gross(state, given, tuple(others.values()))
