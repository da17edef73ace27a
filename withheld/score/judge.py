"""One diagnosis beside one label: what was right and what was wrong."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from withheld.score.diagnosis_file import Diagnosis
from withheld.score.entries import EntryScores, score_entries
from withheld.score.kin import kin_named
from withheld.score.matching import in_pure_group, matches, parameter_errors, separation_of
from withheld.study.protocol import Thresholds

OUTSIDE = ("without", "stranger", "near")


@dataclass(frozen=True)
class Outcome:
    """A case, scored.  Fields that do not apply are None.

    Parameters
    ----------
    kind, design, gyros, effects : the case
    snr : of the faintest effect; None where nothing is wrong
    valid : a diagnosis of the contract's form was there
    flagged : a gap was seen
    exact, by_group : share-free judgements: every cause right by name; by pure group
    named : how many of the effects are among the causes by name
    verdict_right : as the protocol's metrics say
    fate : for what is not in the catalogue: flagged_in_place, flagged_elsewhere, misattributed,
        indistinguishable, missed
    place_right : the first place of `where` is where it is
    separated : least separation of a rival from the truth (of the faintest effect)
    answer : effect named first, or the verdict where none is
    stated : (probability, right) of every cause; of groups likewise
    gap, unknown : (probability, right)
    pulls : (value - truth) / std, and attainable : std / attainable std
    closure : (fraction, std, oracle)
    entries : scores of all entries together, of cases with catalogued effects
    kin : of a shape near the catalogue, whether its kin is named, with what it departs by
    target : SNR that the plan asked for; 0 where it was drawn
    oracle : the oracle's closure, of cases with catalogued effects
    overstated : of `explained`, whether the closure's interval ends below what that needs; else None
    group_size, group_pure : of the first cause's group: members, and members that belong in it
    seconds : time the diagnoser took [s]
    """

    case: str
    kind: str
    design: str
    gyros: int
    effects: tuple[str, ...]
    snr: float | None
    valid: bool
    flagged: bool
    exact: bool | None
    by_group: bool | None
    named: int | None
    verdict_right: bool
    fate: str | None
    place_right: bool | None
    separated: float | None
    answer: str
    stated: tuple[tuple[float, bool], ...] = ()
    stated_group: tuple[tuple[float, bool], ...] = ()
    gap: tuple[float, bool] | None = None
    unknown: tuple[float, bool] | None = None
    pulls: tuple[float, ...] = ()
    attainable: tuple[float, ...] = ()
    closure: tuple[float, float, float] | None = None
    group_size: int | None = None
    group_pure: int | None = None
    impure_far: bool | None = None
    seconds: float | None = None
    entries: EntryScores | None = None
    target: float = 0.0
    oracle: float | None = None
    overstated: bool | None = None
    kin: bool | None = None


def _matched(diagnosis: Diagnosis, effects: list[Mapping[str, Any]], never: float) -> tuple[int, int]:
    """How many effects stand among the leading causes by name, and by pure group."""
    leading = diagnosis.causes[: len(effects)]
    by_name = sum(any(matches(cause.key, effect) for cause in leading) for effect in effects)
    by_group = sum(
        any(matches(cause.key, effect) or in_pure_group(cause, effect, never) for cause in leading)
        for effect in effects
    )
    return by_name, by_group


def place_right(diagnosis: Diagnosis, effects: list[Mapping[str, Any]]) -> bool:
    """Whether the first place named is where an effect is.

    For what a true rotation would do (table, site, mounting): the stage `table`.  Otherwise one of the gyros
    named is one in which it sits.  A swap sits in both gyros.
    """
    if not diagnosis.where:
        return False
    stage, channels, _ = diagnosis.where[0]
    for effect in effects:
        seats = set(effect["channels"]) | {effect["parameters"].get("with", "")}
        if effect["block"] == "table" and (stage == "table" or "table" in channels):
            return True
        here = bool(seats & set(channels)) or (effect["effect"] == "clock_error" and stage == "link")
        # naming every gyro points at none
        if here and len(channels) <= max(len(effect["channels"]), 2):
            return True
    return False


def _fate(diagnosis: Diagnosis, effect: Mapping[str, Any], thresholds: Thresholds) -> str:
    if diagnosis.verdict == "no_gap":
        return "missed"
    if diagnosis.verdict in ("unexplained", "partly_explained"):
        return "flagged_in_place" if place_right(diagnosis, [effect]) else "flagged_elsewhere"
    return "misattributed" if effect["best_rival"] >= thresholds.stranger_keeps else "indistinguishable"


def _pulls(
    diagnosis: Diagnosis, effects: list[Mapping[str, Any]]
) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Pulls of parameters of causes right by name, and stated over attainable standard deviations."""
    pulls, ratios = [], []
    for effect in effects:
        for cause in diagnosis.causes:
            if not matches(cause.key, effect):
                continue
            pulls += [pull for pull, _ in parameter_errors(cause, effect)]
            numbers = list(cause.parameters.values())
            if effect["attainable_std"] and len(numbers) == 1 and numbers[0][0] != 0.0:
                ratios.append(numbers[0][1] / abs(numbers[0][0]) / effect["attainable_std"])
    return tuple(pulls), tuple(ratios)


def _overstated(diagnosis: Diagnosis, thresholds: Thresholds) -> bool | None:
    reaches = diagnosis.closure_reaches
    if diagnosis.verdict != "explained" or reaches is None:
        return None
    return reaches < thresholds.explained_reaches


def judge(
    label: Mapping[str, Any],
    diagnosis: Diagnosis | None,
    thresholds: Thresholds,
    seconds: float | None = None,
) -> Outcome:
    """The outcome of one case; without a diagnosis of the contract's form it is wrong in every respect."""
    kind, effects = label["kind"], list(label["effects"])
    wrong, outside = bool(effects), kind in OUTSIDE
    catalogued = wrong and not outside
    faintest = min(effects, key=lambda e: e["snr"]) if effects else None
    base = {
        "case": label["case"], "kind": kind, "design": label["design"], "gyros": label["gyros"],
        "effects": tuple(e["effect"] for e in effects), "snr": faintest["snr"] if faintest else None,
        "separated": faintest["best_rival"] if faintest else None, "seconds": seconds,
        "entries": score_entries(label, diagnosis, thresholds) if catalogued else None,
        "target": label.get("target_snr", 0.0), "oracle": label["oracle_closure"] if catalogued else None,
    }  # fmt: skip
    if diagnosis is None:
        return Outcome(
            **base, valid=False, flagged=not wrong, exact=False if catalogued else None,
            by_group=False if catalogued else None, named=0 if catalogued else None,
            verdict_right=False, kin=False if kind == "near" else None,
            fate="missed" if outside else None, place_right=False if wrong else None,
            answer="invalid",
        )  # fmt: skip

    flagged = diagnosis.verdict != "no_gap"
    exact = by_group = named = fate = None
    verdict_right = not flagged
    if catalogued:
        named, grouped = _matched(diagnosis, effects, thresholds.group_never)
        extra = len(diagnosis.causes) > len(effects)
        exact, by_group = named == len(effects) and not extra, grouped == len(effects) and not extra
        verdict_right = diagnosis.verdict == "explained"
    elif outside:
        fate = _fate(diagnosis, effects[0], thresholds)
        verdict_right = diagnosis.verdict in ("unexplained", "partly_explained")

    stated = tuple((c.probability, any(matches(c.key, e) for e in effects)) for c in diagnosis.causes)
    stated_group = tuple(
        (c.group_probability, any(matches(m, e) for e in effects for m in c.group)) for c in diagnosis.causes
    )
    pulls, ratios = _pulls(diagnosis, effects)
    oracle = base["oracle"]
    closure = (*diagnosis.closure, oracle) if diagnosis.closure and oracle is not None else None
    first = diagnosis.causes[0] if diagnosis.causes else None
    size = pure = far = None
    if first is not None and kind == "single":
        apart = [separation_of(m, effects[0], thresholds.group_never) for m in first.group]
        size, pure = len(apart), sum(d < thresholds.group_below for d in apart)
        far = any(d >= thresholds.group_never for d in apart)
    return Outcome(
        **base, valid=True, flagged=flagged, exact=exact, by_group=by_group, named=named,
        verdict_right=verdict_right, fate=fate,
        place_right=place_right(diagnosis, effects) if wrong else None,
        answer=first.key[0] if first else diagnosis.verdict, stated=stated, stated_group=stated_group,
        gap=(diagnosis.gap_probability, wrong), unknown=(diagnosis.unknown_probability, outside),
        kin=kin_named(effects[0], diagnosis, place_right(diagnosis, effects)) if kind == "near" else None,
        overstated=_overstated(diagnosis, thresholds), pulls=pulls, attainable=ratios, closure=closure,
        group_size=size, group_pure=pure, impure_far=far,
    )  # fmt: skip
