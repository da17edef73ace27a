"""All entries of a campaign beside all causes that a diagnosis names, where many things are wrong."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from withheld.clairvoyant.closures import subset_closure
from withheld.clairvoyant.exchange import left_of, places
from withheld.effects.catalogue import IN_ONE_RUN
from withheld.score.diagnosis_file import Cause, Diagnosis
from withheld.score.matching import in_pure_group, matches, parameter_errors, separation_of
from withheld.study.protocol import Thresholds

# Where errors may be small beside the true size in place of within 2 standard deviations.
RELATIVE_ERROR = 0.02


@dataclass(frozen=True)
class EntryScores:
    """What was right, entry by entry and cause by cause.

    Parameters
    ----------
    must : of every entry that must be named (`named_snr`, `named_distance`), whether a cause is it
    exchangeable : of every other entry of that SNR, whether a cause stands for it (`assigned`), or all causes
        together do what all entries do
    culprits : the same of every entry of that role, whatever its SNR
    strays : of every cause named, whether it is neither there nor in the true group of what is, nor needed in
        a set that does what all entries do
    once : there is one cause for every entry, and no other
    exact : no entry departs from the catalogue's shape
    within : of every parameter of a right cause, within 2 standard deviations; where some cause is no entry,
        of entries that must be named alone: another in an entry's place moves the rest
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


def assigned(
    causes: tuple[Cause, ...], effects: list[Mapping[str, Any]], thresholds: Thresholds
) -> dict[int, int]:
    """Which cause stands for which effect, one for one: effect -> cause.

    A cause stands for an effect that it is, that its group holds beside nobody far from it, or that it cannot
    be told from (separated by less than `group_below`).  Of all such assignments the one with most effects
    right by name, then with most of the clear ones.
    """
    from scipy.optimize import linear_sum_assignment

    worth = np.array([[_worth(cause, e, thresholds) for cause in causes] for e in effects])
    if not worth.size:
        return {}
    rows, columns = linear_sum_assignment(worth, maximize=True)
    return {int(e): int(c) for e, c in zip(rows, columns, strict=True) if worth[e, c] > 0.0}


def _worth(cause: Cause, effect: Mapping[str, Any], thresholds: Thresholds) -> float:
    """Of one effect by one cause: 1,000 by name, of two lines a little more for the nearer; else 1 to 2, more
    for a clearer effect; 0 for a stray.
    """
    if matches(cause.key, effect):
        away = 0.0
        if "frequency_hz" in cause.parameters:
            away = abs(cause.parameters["frequency_hz"][0] - float(effect["parameters"]["frequency_hz"]))
        return 1000.0 + 1.0 / (1.0 + away)
    below, never = thresholds.group_below, thresholds.group_never
    if in_pure_group(cause, effect, never) or _belongs(cause, effect, below):
        return 2.0 - 1.0 / (1.0 + float(effect["snr"]))
    return 0.0


def _belongs(cause: Cause, effect: Mapping[str, Any], below: float) -> bool:
    """The cause is the effect, or cannot be told from it."""
    return separation_of(cause.key, effect, np.inf) < below


def as_good(
    label: Mapping[str, Any], causes: tuple[Cause, ...], stands: dict[int, int], thresholds: Thresholds
) -> set[int] | None:
    """Of causes that together do what all entries do, those that it takes; None where they do not.

    They do where they are no more than the entries, and leave less than `group_below` of what these make,
    beside the entries too faint to be named.
    """
    effects, entry_of = label["effects"], {c: e for e, c in stands.items()}
    if label.get("linear") is None or len(causes) > len(effects):
        return None
    where = places(label["linear"])
    keys = []
    for c, cause in enumerate(causes):
        effect, channels, runs = cause.key
        key = (effect, channels, runs if effect in IN_ONE_RUN else ("*",))
        if key not in where and c in entry_of:
            # what is not linear goes by the entry that it stands for
            truth = effects[entry_of[c]]
            key = (truth["effect"], tuple(truth["channels"]), tuple(truth["runs"]))
        keys.append(key)
    if not all(key in where for key in keys):
        return None
    faint = [e["snr"] for k, e in enumerate(effects) if k not in stands and e["snr"] < thresholds.named_snr]
    allowed = float(np.linalg.norm([thresholds.group_below, *faint]))
    if left_of(label["linear"], keys) >= allowed:
        return None
    rest = [keys[:c] + keys[c + 1 :] for c in range(len(keys))]
    return {c for c, others in enumerate(rest) if left_of(label["linear"], others) >= allowed}


def _effect_closures(
    label: Mapping[str, Any],
    causes: tuple[Cause, ...],
    right: dict[int, int],
    comparable: set[int],
    within: float,
) -> tuple[bool, ...]:
    """Stated closures of right causes beside the oracle's: the same subsets of the true effects.

    `right`: effect -> the cause that it is; `comparable`: those of them that count.

    A running total counts only where all causes up to that rank are right: the oracle has no others.
    """
    if label.get("closure_gram") is None:
        return ()
    gram = np.array(label["closure_gram"])
    everyone = list(range(len(label["effects"])))
    index = {c: next((k for k in everyone if right.get(k) == c), None) for c in range(len(causes))}
    ranked = sorted(index, key=lambda c: causes[c].closure.get("rank", np.inf))
    good: list[bool] = []
    running: list[int | None] = []
    for c in ranked:
        k, stated = index[c], causes[c].closure
        running.append(k)
        if k is None or k not in comparable or not gram[1 + k, 1 + k]:
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
    numbers = range(len(effects))
    clear = [e for e in numbers if effects[e]["snr"] >= thresholds.named_snr]
    must = [e for e in clear if effects[e]["best_rival"] >= thresholds.named_distance]
    exchangeable = [e for e in clear if e not in must]
    culprits = [e for e in numbers if effects[e].get("role") == "culprit"]
    causes = diagnosis.causes if diagnosis else ()
    stands = assigned(causes, effects, thresholds)
    named = {e for e, c in stands.items() if matches(causes[c].key, effects[e])}
    all_named = all(any(matches(cause.key, e) for e in effects) for cause in causes)
    # a cause in the place of an entry moves the others that it stands beside
    comparable = named if all_named else named & set(must)
    errors = [pair for e in comparable for pair in parameter_errors(causes[stands[e]], effects[e])]
    within = thresholds.effect_closure_within
    needed = as_good(label, causes, stands, thresholds)
    return EntryScores(
        must=tuple(e in named for e in must),
        exchangeable=tuple(needed is not None or e in stands for e in exchangeable),
        culprits=tuple(e in stands for e in culprits),
        strays=tuple(
            not (c in (needed or ()) or any(_belongs(cause, e, below) for e in effects))
            for c, cause in enumerate(causes)
        ),
        once=len(causes) == len(effects) == len(stands),
        exact=not any(e.get("departure") for e in effects),
        within=tuple(abs(pull) < 2.0 for pull, _ in errors),
        within_or_near=tuple(abs(pull) < 2.0 or part < RELATIVE_ERROR for pull, part in errors),
        closures=_effect_closures(label, causes, {e: stands[e] for e in named}, comparable, within),
    )
