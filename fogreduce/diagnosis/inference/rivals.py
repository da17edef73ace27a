"""Inclusion probabilities and groups: what replaces a cause in the sets within Occam's window."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.sets import CauseSet, SetSearch


@dataclass(frozen=True)
class Inclusion:
    """A cause's place in the posterior.

    Attributes
    ----------
    entry : int
    probability : float
        Of the sets that have it.
    rivals : tuple of (int, float)
        Entries that stand in its place where it is not, and the probability of the sets that have them.
    none : float
        Probability of sets that have neither it nor a rival.
    """

    entry: int
    probability: float
    rivals: tuple[tuple[int, float], ...]
    none: float


def inclusions(sets: SetSearch, best: CauseSet) -> list[Inclusion]:
    """Every cause of the best set, from all sets met that lie within the window."""
    mine = sets.entries(best.members)
    top = max(sets.seen.values())
    window = {s: v - top for s, v in sets.seen.items() if v > top - priors.WINDOW}
    total = float(np.sum(np.exp(list(window.values()))))
    out = []
    for entry in sorted(mine):
        there, none = 0.0, 0.0
        rivals: dict[int, float] = {}
        for one, log_weight in window.items():
            weight = float(np.exp(log_weight)) / total
            if entry in one:
                there += weight
                continue
            instead = _instead(sets, one - mine, entry)
            if not instead:
                none += weight
            for other in instead:
                rivals[other] = rivals.get(other, 0.0) + weight
        ranked = sorted(rivals.items(), key=lambda pair: -pair[1])
        out.append(Inclusion(entry, there, tuple(ranked), none))
    return out


def _instead(sets: SetSearch, further: frozenset[int], entry: int) -> list[int]:
    """Of the entries that a set has beside the best one's, those that do some of what an entry does."""
    gram, options = sets.regression.gram, sets.regression.options
    columns = np.concatenate([options[n].columns for n in sets.regression.of_entry[entry]])
    out = []
    for other in further:
        theirs = np.concatenate([options[n].columns for n in sets.regression.of_entry[other]])
        cross = gram[np.ix_(columns, theirs)] ** 2
        size = np.outer(np.diag(gram)[columns], np.diag(gram)[theirs])
        if np.max(cross / size) > _ALIKE:
            out.append(other)
    return out


#: Squared cosine of two causes' columns from which on the one can stand in the other's place.
_ALIKE = 0.02
