"""The search over sets of causes: no most number of them, and moves of single causes and of whole kinds.

Each step adds what gains most, drops what no longer pays, exchanges one cause for another, or puts a whole
kind (bias offsets of all gyros, say) in and another out. Every set met on the way is remembered with its ln
posterior; those within Occam's window of the best are the posterior that probabilities are stated from.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.hierarchy import Kind, log_places, log_prior
from fogreduce.diagnosis.inference.regression import (
    Additions,
    Fitted,
    Member,
    Regression,
    additions,
    fitted,
    worths,
)

Array = NDArray[np.float64]

_BETTER, _ROUNDING = 1e-6, 1e-8  # of ln posterior: a gain that rounding cannot make, relative to its size
_ENDED = 0.05  # of ln posterior: what a further round of moves is not worth
_PAYS = 15.0  # ln evidence of a cause beside the others from which on no prior makes it worth leaving out


@dataclass(frozen=True)
class CauseSet:
    """A set of options with its fit and ln posterior over that of nothing."""

    members: tuple[Member, ...]
    fit: Fitted
    score: float


def _above(here: CauseSet) -> float:
    """The ln posterior that a better set has at least."""
    return here.score + _BETTER + _ROUNDING * abs(here.score)


@dataclass
class SetSearch:
    """Sets of a regression's options.

    Parameters
    ----------
    regression : Regression
    banned : set of int
        Entries that are not allowed.

    Attributes
    ----------
    seen : dict
        Sets of entries -> the best ln posterior met.
    """

    regression: Regression
    banned: frozenset[int] = frozenset()
    seen: dict[frozenset[int], float] = field(default_factory=dict)
    _priors: dict[frozenset[tuple[Kind, int]], float] = field(default_factory=dict)

    # ------------------------------------------------------------------------------------- sets

    def entry(self, member: Member) -> int:
        """A member's entry."""
        return self.regression.options[member.option].entry

    def kind(self, entry: int) -> Kind:
        """An entry's kind."""
        return self.regression.entries[entry].kind

    def entries(self, members: Iterable[Member]) -> frozenset[int]:
        """The entries of members."""
        return frozenset(self.entry(m) for m in members)

    def of(self, members: Sequence[Member]) -> CauseSet:
        """A set, remembered."""
        fit = fitted(self.regression, members)
        entries = self.entries(members)
        score = fit.log_b + self.prior(Counter(self.kind(e) for e in entries))
        self._remember(entries, score)
        return CauseSet(tuple(members), fit, score)

    def prior(self, counts: Counter[Kind]) -> float:
        """Ln prior of so many places of each kind, over that of nothing."""
        key = frozenset(counts.items())
        if key not in self._priors:
            self._priors[key] = log_prior(self._kinds, counts) - log_prior(self._kinds, {})
        return self._priors[key]

    @cached_property
    def _kinds(self) -> list[Kind]:
        return list(dict.fromkeys(one.kind for one in self.regression.entries))

    def _remember(self, entries: frozenset[int], score: float) -> None:
        if score > self.seen.get(entries, -np.inf):
            self.seen[entries] = score

    def scores(self, here: CauseSet) -> tuple[Array, Additions]:
        """Ln posterior (options,) of a set with each option added, and what they add."""
        more = additions(self.regression, here.fit)
        taken = self.entries(here.members)
        counts = Counter(self.kind(e) for e in taken)
        dear = {kind: self._price(counts, kind) for kind in self._kinds}
        prior = np.array([dear[one.kind] for one in self.regression.entries])
        prior[list(taken | self.banned)] = -np.inf
        whole = here.score + more.gain + prior[[o.entry for o in self.regression.options]]
        # points of one grid say the same of their entry together
        for entry, numbers in self.regression.of_entry.items():
            best = float(np.max(whole[numbers]))
            if best > here.score - 3.0 * priors.WINDOW:
                total = float(np.logaddexp.reduce(whole[numbers]))
                self._remember(taken | {entry}, total)
                whole[numbers] += total - best
        return whole, more

    def _price(self, counts: Counter[Kind], kind: Kind, more: int = 1) -> float:
        """What so many further places of a kind add to ln prior."""
        n = counts[kind]
        if n + more > kind.places:
            return -np.inf
        if not kind.of_record:
            return log_places(kind, n + more) - log_places(kind, n)
        return self.prior(counts + Counter({kind: more})) - self.prior(counts)

    def with_option(self, here: CauseSet, option: int, more: Additions) -> CauseSet:
        """A set with an option added, its scale the best."""
        member = Member(option, int(more.scale[option]), float(more.spread[option]))
        return self.of([*here.members, member])

    def without(self, here: CauseSet, entries: Iterable[int]) -> CauseSet:
        """A set less some entries."""
        gone = set(entries)
        return self.of([m for m in here.members if self.entry(m) not in gone])

    # ------------------------------------------------------------------------------------ moves

    def grown(self, here: CauseSet) -> CauseSet:
        """A set to which nothing more pays, one cause at a time and whole kinds."""
        while True:
            whole, more = self.scores(here)
            best = int(np.argmax(whole))
            if whole[best] > _above(here):
                here = self.with_option(here, best, more)
                continue
            kind = self._with_kind(here, whole)
            if kind is None:
                return here
            here = kind

    def _with_kind(self, here: CauseSet, whole: Array) -> CauseSet | None:
        """A set, of these scores, with further places of one kind that pay together, though none alone; None
        if none do.
        """
        taken = self.entries(here.members)
        there = Counter(self.kind(e) for e in taken)
        best: dict[Kind, list[float]] = {}
        for entry, numbers in self.regression.of_entry.items():
            kind = self.kind(entry)
            if entry in taken:
                continue
            gain = float(np.max(whole[numbers])) - here.score - self._price(there, kind)
            if gain > 0.0 and np.isfinite(gain):
                best.setdefault(kind, []).append(gain)
        for kind, gains in best.items():
            sums = np.cumsum(sorted(gains, reverse=True)).tolist()
            worth = [total + self._price(there, kind, k + 1) for k, total in enumerate(sums)]
            if max(worth) <= 0.0:
                continue
            trial = here
            for _ in range(int(np.argmax(worth)) + 1):
                trial = self._added(trial, kind)
            if trial.score > _above(here):
                return trial
        return None

    def _added(self, here: CauseSet, kind: Kind) -> CauseSet:
        """A set with the best further place of a kind, whether or not it pays."""
        whole, more = self.scores(here)
        mine = [n for n, o in enumerate(self.regression.options) if self.kind(o.entry) == kind]
        best = max(mine, key=lambda n: whole[n])
        return self.with_option(here, best, more) if np.isfinite(whole[best]) else here

    def rescaled(self, here: CauseSet) -> CauseSet:
        """A set with each member at the best option and scale, whatever that is worth."""
        while True:
            before = here.score
            for entry in sorted(self.entries(here.members)):
                less = self.without(here, [entry])
                best, more = self._best_of(less, entry)
                now = self.with_option(less, best, more)
                here = now if now.score > _above(here) else here
            if here.score <= before + _ENDED + _ROUNDING * abs(before):
                return here

    def _best_of(self, here: CauseSet, entry: int) -> tuple[int, Additions]:
        """The best option of an entry beside a set."""
        more = additions(self.regression, here.fit, entry)
        return max(self.regression.of_entry[entry], key=lambda n: float(more.gain[n])), more

    def pruned(self, here: CauseSet) -> CauseSet:
        """A set from which nothing is better left out; what hardly pays is also tried at its best size."""
        changed = True
        while changed:
            changed = False
            worth = worths(self.regression, here.members, here.fit)
            for member, gain in zip(here.members, worth, strict=True):
                if gain > _PAYS:
                    continue
                entry = self.entry(member)
                less = self.without(here, [entry])
                best, more = self._best_of(less, entry)
                now = max(less, self.with_option(less, best, more), key=lambda one: one.score)
                if now.score > _above(here):
                    here, changed = now, True
                    break
        return here

    def exchanged(self, here: CauseSet) -> CauseSet:
        """A set in which no cause is better exchanged for another."""
        changed = True
        while changed:
            changed = False
            for entry in sorted(self.entries(here.members)):
                less = self.without(here, [entry])
                whole, more = self.scores(less)
                best = int(np.argmax(whole))
                if whole[best] > _above(here):
                    now = self.with_option(less, best, more)
                    if now.score > _above(here):
                        here, changed = now, True
                        break
        return here

    def kinds_moved(self, here: CauseSet) -> CauseSet:
        """A set in which no whole kind is better left out or replaced."""
        changed = True
        while changed:
            changed = False
            kinds = {self.kind(e) for e in self.entries(here.members)}
            for kind in sorted(kinds, key=lambda k: (k.effect, k.places)):
                gone = [e for e in self.entries(here.members) if self.kind(e) == kind]
                barred = [e for e, one in enumerate(self.regression.entries) if one.kind == kind]
                other = SetSearch(self.regression, self.banned | set(barred), self.seen, self._priors)
                trial = other.rescaled(self.without(here, gone))
                trial = self.pruned(self.grown(other.pruned(other.grown(trial))))
                if trial.score > _above(here):
                    here, changed = trial, True
                    break
        return here

    def best(self, start: Sequence[Member] = ()) -> CauseSet:
        """The set of the greatest posterior that the moves lead to."""
        here, moved = self.of(start), None
        while True:
            before = here.score
            here = self.exchanged(self.rescaled(self.pruned(self.grown(here))))
            if here is moved:
                return here  # no whole kind is better moved from it: that was tried
            here = moved = self.kinds_moved(here)
            if here.score <= before + _ENDED + _ROUNDING * abs(before):
                return here
