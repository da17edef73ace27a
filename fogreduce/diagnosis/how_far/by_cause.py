"""How far the gap closes, cause by cause: alone, with it alone left out, in the order that closes most first.

Every number is the campaign's own measure on data that were not fitted, the simulator run
with just those causes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.how_far.closure import Closure, HeldOut, Key, Sum, scatter
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.model import simulated
from fogreduce.diagnosis.observe.capture import RunInput

Array = NDArray[np.float64]
Part = TypeVar("Part", Key, str)


@dataclass(frozen=True)
class Share:
    """What one cause closes.

    Attributes
    ----------
    alone, alone_std : float
        Fraction that closes with it alone in the simulator.
    removed, removed_std : float
        Fraction lost when it alone is taken out of the full set.
    cumulative : float
        Running total in the order of `rank`.
    rank : int
        1 for the cause that closes most, then the one that closes most beside it.
    """

    alone: float
    alone_std: float
    removed: float
    removed_std: float
    cumulative: float
    rank: int


def shares(
    inputs: Sequence[RunInput], causes: Sequence[Cause], closure: Closure
) -> tuple[dict[Key, Share], dict[str, Share]]:
    """Shares of the closure: of every cause, and of every kind, an effect's causes at all places as one.

    Parameters
    ----------
    inputs : runs
    causes : sequence of Cause
    closure : Closure
        Of all of them.

    Returns
    -------
    mappings
        Of causes' keys and of effects' names; empty where nothing was held out.
    """
    if not closure.folds and not closure.at_full_rate:
        return {}, {}
    left = _Subsets(inputs, frozenset(c.key for c in causes if _in_noise(c)), closure)
    kinds: dict[str, frozenset[Key]] = {}
    for c in causes:
        kinds[c.effect] = kinds.get(c.effect, frozenset()) | {c.key}
    guess = _Guess(left)
    return _shares(left, guess, {c.key: frozenset([c.key]) for c in causes}), _shares(left, guess, kinds)


def _shares(left: _Subsets, guess: _Guess, parts: Mapping[Part, frozenset[Key]]) -> dict[Part, Share]:
    """Shares of parts of the causes, each a set of their keys."""
    whole = frozenset[Key]().union(*parts.values())
    full = left.closed(whole)
    out: dict[Part, Share] = {}
    taken = frozenset[Key]()
    for rank in range(1, len(parts) + 1):
        now = taken
        best = min((p for p in parts if p not in out), key=lambda p: guess.after(now | parts[p]))
        taken = taken | parts[best]
        one, without = left.closed(parts[best]), left.closed(whole - parts[best])
        lost, total = full.fraction - without.fraction, left.closed(taken).fraction
        out[best] = Share(one.fraction, one.std, lost, without.std, total, rank)
    return out


@dataclass
class _Subsets:
    """What subsets of the causes leave, by simulation."""

    inputs: Sequence[RunInput]
    in_noise: frozenset[Key]
    closure: Closure
    _closures: dict[frozenset[Key], Closure] = field(default_factory=dict)

    def closed(self, taken: frozenset[Key]) -> Closure:
        """The closure of a subset of the causes."""
        if taken not in self._closures:
            self._closures[taken] = self._closed(taken)
        return self._closures[taken]

    def _closed(self, taken: frozenset[Key]) -> Closure:
        whole, after = self.closure, Sum()
        for fold in whole.folds:
            self._add(after, fold, taken)
        for key, (one, two) in whole.at_full_rate.items():
            after.add(two if key in taken else one)
        noise = scatter(whole.summed, after, whole.expected)
        return Closure(whole.measure, whole.held_out, whole.before, after.value, whole.expected, noise)

    def _add(self, after: Sum, fold: HeldOut, taken: frozenset[Key]) -> None:
        mine = [c for c in fold.causes if c.key in taken]
        noisy = bool(self.in_noise & taken)
        part = fold.noisy if noisy else fold.bare
        change = np.zeros(part.whiten.rows.total)
        if mine:
            rows = part.whiten.rows
            change = simulated(self.inputs, mine, rows) - simulated(self.inputs, [], rows)
        left = part.y - part.whiten(change[:, None])[:, 0]
        after.add_fold(fold.noisy_deviates if noisy else fold.bare_deviates, left)


class _Guess:
    """What subsets would leave if causes simply added up: good enough to put them in order."""

    def __init__(self, left: _Subsets) -> None:
        self._left = left
        self._parts: list[tuple[dict[Key, Array], Array]] = []
        for fold in left.closure.folds:
            rows = fold.bare.whiten.rows
            nothing = simulated(left.inputs, [], rows)
            changes = {c.key: simulated(left.inputs, [c], rows) - nothing for c in fold.causes}
            of = {
                key: fold.bare_deviates.of(fold.bare.whiten(change[:, None])[:, 0])
                for key, change in changes.items()
            }
            self._parts.append((of, fold.bare_deviates.of(fold.bare.y)))

    def after(self, taken: frozenset[Key]) -> float:
        """About what is left beside a subset."""
        total = 0.0
        for of, whole in self._parts:
            left = whole - sum((of[key] for key in taken if key in of), np.zeros_like(whole))
            total += float(left @ left)
        full_rate = self._left.closure.at_full_rate
        return total + sum(two if key in taken else one for key, (one, two) in full_rate.items())


def _in_noise(cause: Cause) -> bool:
    """Whether a cause changes how far block means may be from their prediction, not the prediction."""
    return bool(cause.process) or (cause.finding is not None and cause.finding.domain == "converter")
