"""All entries of a campaign beside all causes that a diagnosis names, where many things are wrong."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from withheld.clairvoyant.closures import subset_closure
from withheld.score.diagnosis_file import Cause, Diagnosis
from withheld.score.matching import matches, parameter_errors, separation_of
from withheld.study.protocol import Thresholds

# Where errors may be small beside the true size in place of within 2 standard deviations.
RELATIVE_ERROR = 0.02


@dataclass(frozen=True)
class EntryScores:
    """What was right, entry by entry and cause by cause.

    Parameters
    ----------
    must : of every entry that must be named (`named_snr`, `named_distance`), whether a cause is it
    exchangeable : of every other entry of that SNR, whether it stands in a group, or a cause of its true
        group is named in its place
    culprits : the same of every entry of that role, whatever its SNR
    strays : of every cause named, whether it is neither there nor in the true group of what is
    once : there is one cause for every entry, it or of its true group, and no other
    exact : no entry departs from the catalogue's shape
    within : of every parameter of a right cause, within 2 standard deviations
    within_or_near : the same, or within 2 % of its size
    closures : of every stated closure of a right cause (alone, removed, cumulative), near the oracle's
    """

    must: tuple[bool, ...] = ()
    exchangeable: tuple[bool, ...] = ()
    culprits: tuple[bool, ...] = ()
    strays: tuple[bool, ...] = ()
    once: bool = False
    exact: bool = True
    within: tuple[bool, ...] = ()
    within_or_near: tuple[bool, ...] = ()
    closures: tuple[bool, ...] = ()

    @property
    def all_found(self) -> bool:
        """Every entry of SNR 8 is named, or accounted for where another could replace it."""
        return all(self.must) and all(self.exchangeable)


def _accounted(diagnosis: Diagnosis, effect: Mapping[str, Any], below: float) -> bool:
    """The effect is a cause or stands in a group, or a cause is of its true group."""
    return any(
        any(matches(member, effect) for member in cause.group) or _belongs(cause, effect, below)
        for cause in diagnosis.causes
    )


def _belongs(cause: Cause, effect: Mapping[str, Any], below: float) -> bool:
    """The cause is the effect, or cannot be told from it."""
    return separation_of(cause.key, effect, np.inf) < below


def _effect_closures(label: Mapping[str, Any], diagnosis: Diagnosis, within: float) -> tuple[bool, ...]:
    """Stated closures of right causes beside the oracle's: the same subsets of the true effects.

    A running total counts only where all causes up to that rank are right: the oracle has no others.
    """
    if label.get("closure_gram") is None:
        return ()
    gram = np.array(label["closure_gram"])
    effects = list(label["effects"])
    everyone = list(range(len(effects)))
    index = {
        c: next((k for k in everyone if matches(cause.key, effects[k])), None)
        for c, cause in enumerate(diagnosis.causes)
    }
    ranked = sorted(index, key=lambda c: diagnosis.causes[c].closure.get("rank", np.inf))
    good: list[bool] = []
    running: list[int | None] = []
    for c in ranked:
        k, stated = index[c], diagnosis.causes[c].closure
        running.append(k)
        if k is None or not gram[1 + k, 1 + k]:
            continue
        oracle = {
            "alone": subset_closure(gram, [k]),
            "removed": subset_closure(gram, everyone) - subset_closure(gram, [e for e in everyone if e != k]),
        }
        if None not in running:
            oracle["cumulative"] = subset_closure(gram, [e for e in running if e is not None])
        good += [abs(stated[name] - value) < within for name, value in oracle.items() if name in stated]
    return tuple(good)


def score_entries(
    label: Mapping[str, Any], diagnosis: Diagnosis | None, thresholds: Thresholds
) -> EntryScores:
    """Scores of one campaign; without a diagnosis nothing is named."""
    effects, below = list(label["effects"]), thresholds.group_below
    clear = [e for e in effects if e["snr"] >= thresholds.named_snr]
    must = [e for e in clear if e["best_rival"] >= thresholds.named_distance]
    exchangeable = [e for e in clear if e["best_rival"] < thresholds.named_distance]
    culprits = [e for e in effects if e.get("role") == "culprit"]
    exact = not any(e.get("departure") for e in effects)
    if diagnosis is None:
        return EntryScores(
            (False,) * len(must), (False,) * len(exchangeable), (False,) * len(culprits), exact=exact
        )
    causes = diagnosis.causes
    errors = [
        pair
        for cause in causes
        for e in effects
        if matches(cause.key, e)
        for pair in parameter_errors(cause, e)
    ]
    once = len(causes) == len(effects) and all(
        any(matches(cause.key, e) or _belongs(cause, e, below) for cause in causes) for e in effects
    )
    return EntryScores(
        must=tuple(any(matches(cause.key, e) for cause in causes) for e in must),
        exchangeable=tuple(_accounted(diagnosis, e, below) for e in exchangeable),
        culprits=tuple(_accounted(diagnosis, e, below) for e in culprits),
        strays=tuple(not any(_belongs(cause, e, below) for e in effects) for cause in causes),
        once=once, exact=exact,
        within=tuple(abs(pull) < 2.0 for pull, _ in errors),
        within_or_near=tuple(abs(pull) < 2.0 or part < RELATIVE_ERROR for pull, part in errors),
        closures=_effect_closures(label, diagnosis, thresholds.effect_closure_within),
    )  # fmt: skip
