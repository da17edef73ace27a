"""The prior over sets of causes: first the kind of effect, then its places given the kind.

A kind is there with a small probability. Given it, either one place has it, or any number n of the m places,
by a beta-binomial law; places are alike, so that each set of n of them has an equal part:

    p(n of m) = KIND [SINGLE (n = 1) / m + (1 - SINGLE) BB(n; m, a, b) / (1 - BB(0)) / C(m, n)].

What a calibration record states (biases, scale factors, axes) goes stale together, at most gyros: with a
probability of its own the record is stale, and then its kinds are each likely.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from math import exp, lgamma, log, log1p

import numpy as np

from fogreduce.diagnosis import priors


@dataclass(frozen=True)
class Kind:
    """A kind of effect: its number of places, whether it goes with gyros in every run, its weight."""

    effect: str
    places: int
    every: bool
    weight: float = 1.0

    @property
    def of_record(self) -> bool:
        """Whether a calibration record states what it changes."""
        return self.effect in priors.OF_RECORD and self.weight == 1.0


def _log_beta(a: float, b: float) -> float:
    return lgamma(a) + lgamma(b) - lgamma(a + b)


def _log_share(n: int, m: int, law: tuple[float, float]) -> float:
    """Ln beta-binomial probability of one set of n >= 1 of m places, given that there is any."""
    a, b = law
    none = exp(_log_beta(a, m + b) - _log_beta(a, b))
    return _log_beta(n + a, m - n + b) - _log_beta(a, b) - log1p(-none)


@lru_cache(maxsize=4096)
def log_places(kind: Kind, n: int) -> float:
    """Ln probability that just these n places of a kind are wrong."""
    there, m = priors.KIND * kind.weight, kind.places
    if n == 0:
        return log1p(-there)
    law = priors.EVERY_GYRO if kind.every else priors.SOME_PLACES
    single = priors.SINGLE / m if n == 1 else 0.0
    return log(there) + log(single + (1.0 - priors.SINGLE) * exp(_log_share(n, m, law)))


@lru_cache(maxsize=4096)
def _log_stale(kind: Kind, n: int) -> float:
    """The same where the record is stale."""
    if n == 0:
        return log1p(-priors.STALE_KIND)
    return log(priors.STALE_KIND) + _log_share(n, kind.places, priors.STALE_GYROS)


def log_prior(kinds: Sequence[Kind], counts: Mapping[Kind, int]) -> float:
    """Ln prior of a set from how many places of each kind it has."""
    plain = sum(log_places(kind, counts.get(kind, 0)) for kind in kinds)
    record = [kind for kind in kinds if kind.of_record]
    fresh = sum(log_places(kind, counts.get(kind, 0)) for kind in record)
    stale = sum(_log_stale(kind, counts.get(kind, 0)) for kind in record)
    return plain + float(np.logaddexp(log1p(-priors.STALE), log(priors.STALE) + stale - fresh))
