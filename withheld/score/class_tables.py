"""Rows of the classes of campaigns, each beside what it is to reach."""

from collections.abc import Callable, Iterable
from typing import Any

from withheld.effects.near import KIN
from withheld.score.judge import Outcome
from withheld.score.rows import row, table
from withheld.score.wilson import share
from withheld.study.classes import CLASSES
from withheld.study.protocol import Thresholds

Row = dict[str, Any]


def _all(outcomes: list[Outcome], name: str) -> list[bool]:
    """A score's judgements over all campaigns' entries."""
    return [flag for o in outcomes if o.entries for flag in getattr(o.entries, name)]


def closure_near(outcomes: Iterable[Outcome], within: float) -> list[bool]:
    """Of every campaign with an oracle's closure: whether one is stated, and near it."""
    return [
        o.closure is not None and abs(o.closure[0] - o.closure[2]) < within
        for o in outcomes
        if o.oracle is not None
    ]


def _explained(outcomes: list[Outcome], aim: str) -> Row:
    return row("verdict explained", share([o.verdict_right for o in outcomes]), aim)


def _stale(outcomes: list[Outcome], thresholds: Thresholds) -> list[Row]:
    return [
        _explained(outcomes, "90 %"),
        row("entries that must be named, named", share(_all(outcomes, "must")), "95 %"),
        row("other entries of SNR 8: in a group, or one of their true group named",
            share(_all(outcomes, "exchangeable"))),
        row("causes named that are in no true group", share(_all(outcomes, "strays")), "at most 3 %"),
        row("closure within 0.03 of the oracle's",
            share(closure_near(outcomes, thresholds.closure_within)), "95 %"),
        row("parameters within 2 standard deviations", share(_all(outcomes, "within")), "95 %"),
    ]  # fmt: skip


def _stale_culprit(outcomes: list[Outcome], thresholds: Thresholds) -> list[Row]:
    culprits = row("culprit named, or in its true group", share(_all(outcomes, "culprits")), "95 %")
    return [culprits, *({**other, "aim": ""} for other in _stale(outcomes, thresholds))]


def _strong(outcomes: list[Outcome], thresholds: Thresholds) -> list[Row]:
    exact = [o for o in outcomes if o.entries and o.entries.exact]
    departing = [o for o in outcomes if o.entries and not o.entries.exact]
    rows = [
        row("named once (or one of its true group), and explained",
            share([bool(o.entries and o.entries.once and o.verdict_right) for o in outcomes]), "97 %"),
    ]  # fmt: skip
    for snr in sorted({o.target for o in outcomes}):
        chosen = [o for o in outcomes if o.target == snr]
        once = [bool(o.entries and o.entries.once and o.verdict_right) for o in chosen]
        rows.append(row(f"the same, at SNR {snr:g}", share(once), "97 %"))
    return [
        *rows,
        row("parameters within 2 standard deviations or 2 %, the catalogue's shape",
            share(_all(exact, "within_or_near")), "95 %"),
        row("the same, of departing shape", share(_all(departing, "within_or_near"))),
        row("closure within 0.03 of the oracle's", share(closure_near(outcomes, thresholds.closure_within))),
    ]  # fmt: skip


def _together(outcomes: list[Outcome], thresholds: Thresholds) -> list[Row]:
    entries = _all(outcomes, "must") + _all(outcomes, "exchangeable")
    return [
        row("all entries of SNR 8 named, or one of their true group",
            share([bool(o.entries and o.entries.all_found) for o in outcomes]), "95 %"),
        row("the same, entry by entry", share(entries)),
        row("causes named that are in no true group", share(_all(outcomes, "strays"))),
        _explained(outcomes, ""),
    ]  # fmt: skip


def _quiet(outcomes: list[Outcome], thresholds: Thresholds) -> list[Row]:
    return [row("called a gap", share([o.flagged for o in outcomes]), "at most 1 %")]


def _long_run(outcomes: list[Outcome], thresholds: Thresholds) -> list[Row]:
    found = [bool(o.entries and all(o.entries.culprits)) for o in outcomes]
    clean = [f and not any(_all([o], "strays")) for f, o in zip(found, outcomes, strict=True)]
    cells = [(o.effects[0], o.target) for o in outcomes]
    each = {cell: [f for f, own in zip(found, cells, strict=True) if own == cell] for cell in sorted(cells)}
    return [
        row("effect named, or in its true group", share(found), "95 %"),
        row("the same, and no cause in no true group", share(clean)),
        _explained(outcomes, ""),
        *(row(f"{effect.replace('_', ' ')} at SNR {snr:g}", share(flags))
          for (effect, snr), flags in each.items()),
    ]  # fmt: skip


def _near(outcomes: list[Outcome], thresholds: Thresholds) -> list[Row]:
    return [
        row("unknown in its place with its kin, or its kin named and the departure shown",
            share([bool(o.kin) for o in outcomes]), "90 %"),
        row("flagged in its place", share([o.fate == "flagged_in_place" for o in outcomes])),
        row("explained", share([o.fate in ("misattributed", "indistinguishable") for o in outcomes])),
        row("missed", share([o.fate == "missed" for o in outcomes])),
        *(row(f"kin found: {effect.replace('_', ' ')}",
              share([bool(o.kin) for o in outcomes if o.effects[0] == effect])) for effect in KIN),
    ]  # fmt: skip


_ROWS: dict[str, Callable[[list[Outcome], Thresholds], list[Row]]] = {
    "stale": _stale,
    "stale_culprit": _stale_culprit,
    "strong": _strong,
    "link_slow": _together,
    "mixed_quiet": _quiet,
    "mixed": _together,
    "slow_log": _together,
    "long_run": _long_run,
    "near": _near,
}


def class_tables(outcomes: list[Outcome], thresholds: Thresholds) -> list[dict[str, Any]]:
    """A table for each class that the study has, and one of what holds for every campaign."""
    tables = []
    for kind, rows in _ROWS.items():
        chosen = [o for o in outcomes if o.kind == kind]
        if chosen:
            tables.append(table(f"{CLASSES[kind].title}, {len(chosen)} campaigns", rows(chosen, thresholds)))
    reaches = f"{thresholds.explained_reaches:g}"
    tables.append(
        table("Closures, all classes", [
            row(f"explained, with a closure interval below {reaches}",
                share([o.overstated for o in outcomes if o.overstated is not None]), "never"),
            row("closures of single effects within 0.05 of the oracle's",
                share(_all(outcomes, "closures")), "95 %"),
        ])
    )  # fmt: skip
    return tables
