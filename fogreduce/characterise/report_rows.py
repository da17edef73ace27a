"""The report's document as rows of text, for page and PDF alike."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from fogreduce.characterise.definitions import DEFINITIONS
from fogreduce.characterise.isolation import CLEAR
from fogreduce.pages.numbers import duration, number, plus_minus

Document = Mapping[str, Any]

_EVEN = 0.01  # odds that differ by less are alike
_SURE = 1e-3  # a probability nearer to 0 or 1 is written as beyond it


def footnotes(document: Document) -> dict[str, int]:
    """Number of the footnote of each quantity, in the order of the report."""
    names = dict.fromkeys(one["quantity"] for one in document["quantities"])
    return {name: k + 1 for k, name in enumerate(names)}


def determined(document: Document) -> list[dict[str, Any]]:
    """What the runs determine: `title` and `footnote` of each quantity, and its `rows`, gyro below gyro."""
    groups: dict[str, list[dict[str, str]]] = {}
    for one in document["quantities"]:
        if not one["determined"]:
            continue
        row = {
            "of": one["of"],
            "value": _value(one),
            "interval": _interval(one["low_95"], one["high_95"], one["std"]),
            "note": one["note"],
            "verdict": one["verdict"] or "",
            "probability": _per_cent(one["conformance_probability"]),
        }
        groups.setdefault(one["quantity"], []).append(row)
    return [
        {"title": DEFINITIONS[name].title, "footnote": str(note), "rows": groups[name]}
        for name, note in footnotes(document).items()
        if name in groups
    ]


def not_determined(document: Document) -> list[dict[str, str]]:
    """Rows of what they leave open: the quantity, of what, and the runs that would determine it."""
    rows: dict[tuple[str, str], list[str]] = {}
    for one in document["quantities"]:
        if not one["determined"]:
            rows.setdefault((one["quantity"], one["needs"]), []).append(one["of"])
    notes = footnotes(document)
    return [
        {
            "title": DEFINITIONS[name].title,
            "footnote": str(notes[name]),
            "of": "; ".join(of),
            "needs": needs,
        }
        for (name, needs), of in rows.items()
    ]


def left_out(document: Document) -> list[list[str]]:
    """Without which gyro, variance trace, noise and drift of x, y, z."""
    return [
        [
            one["without"],
            number(one["variance_trace"]) or "in a plane",
            *(number(value) for value in one["noise_deg_sqrt_h"]),
            *map(plus_minus, one["drift_deg_h"], one["drift_err_deg_h"]),
        ]
        for one in document["left_out"]
    ]


def alarms(document: Document) -> list[list[str]]:
    """Alarms of the parity checks; those of a run that say the same, in several segments, in one row."""
    rows: dict[tuple[str, ...], list[Mapping[str, Any]]] = {}
    for one in document["parity"]["alarms"]:
        gyro = f"{one['gyro']}, by {one['isolated_by']}" if one["gyro"] else "not isolated"
        evidence = "; ".join(map(_evidence, one["evidence"]))
        rows.setdefault((one["run"], one["check"], one["what"], gyro, evidence), []).append(one)
    return [
        [
            run,
            check,
            what if len(same) == 1 else f"{what} ({len(same)} times)",
            number(same[0]["since_s"]),
            number(same[0]["alarm_s"]),
            number(max((one["size"] for one in same), key=abs), 3),
            gyro,
            evidence,
        ]
        for (run, check, what, gyro, evidence), same in rows.items()
    ]


def _evidence(one: Mapping[str, Any]) -> str:
    """What a piece of evidence says, and its odds where they differ."""
    odds, says = one["odds"], one["says"]
    if max(odds) >= CLEAR:
        says = f"gyro{odds.index(max(odds)) + 1}" + (f", {says}" if says else "")
    elif max(odds) - min(odds) > _EVEN:
        says += (", " if says else "") + "odds " + " : ".join(f"{part:.2g}" for part in odds)
    return f"{one['by']}: {says or 'nothing'}"


def definition_rows(document: Document) -> list[tuple[int, str, str, str]]:
    """Footnotes: number, title, formula, source."""
    return [
        (k, DEFINITIONS[name].title, DEFINITIONS[name].formula, DEFINITIONS[name].source)
        for name, k in footnotes(document).items()
    ]


def verdict_line(document: Document) -> str:
    """The verdicts in a line."""
    verdicts = [one["verdict"] for one in document["quantities"] if one["verdict"]]
    if document["limits"] is None:
        return "No limits were given."
    if not verdicts:
        return "None of the limits is on a quantity that these runs determine."
    counts = {word: verdicts.count(word) for word in ("pass", "fail", "not proven")}
    return ", ".join(f"{count} {word}" for word, count in counts.items()) + (
        f"; guard band {document['limits']['guard']:g} times the expanded uncertainty."
    )


def _per_cent(probability: float | None) -> str:
    """A probability of conformance."""
    if probability is None:
        return ""
    if probability < _SURE or probability > 1 - _SURE:
        return f"< {100 * _SURE:g} %" if probability < 0.5 else f"> {100 * (1 - _SURE):g} %"
    return f"{100 * probability:.3g} %"


def _value(one: Document) -> str:
    """The value and its error with their unit; of what is not seen, 0 or beyond what shows, the bound."""
    if one["high_95"] is None:
        return f"≥ {number(one['value'], 3)} {one['unit']}"
    if one["value"] == 0 and one["high_95"] > 0:
        return f"≤ {number(one['high_95'], 2)} {one['unit']}".rstrip()
    return plus_minus(one["value"], one["std"], one["unit"])


def _interval(low: float, high: float | None, std: float | None) -> str:
    """Both ends to the second digit of the uncertainty."""
    if high is None or std is None:
        return f"{number(low, 3)} and more"
    if not std > 0:
        return f"{number(low)} to {number(high)}"
    digits = 1 - math.floor(math.log10(std))
    if not 0 <= digits <= 12:
        return f"{number(low, 6)} to {number(high, 6)}"
    return f"{low:.{digits}f} to {high:.{digits}f}".replace("-", "−")


def responses(document: Document) -> list[list[str]]:
    """Run, gyro, frequency, gain, phase of the response to a swing."""
    return [
        [
            one["run"],
            one["gyro"],
            number(one["frequency_hz"], 4),
            plus_minus(one["gain"], one["gain_std"]),
            "not told" if one["phase_deg"] is None else plus_minus(one["phase_deg"], one["phase_std_deg"]),
        ]
        for one in document["response"]
    ]


def turns(document: Document) -> list[dict[str, Any]]:
    """Groups of runs of the same turn, as rows of text."""
    return [
        {
            "profile": turn["profile"],
            "rows": [
                [run["run"], run["about"], *map(plus_minus, run["drift_deg_h"], run["drift_err_deg_h"])]
                for run in turn["runs"]
            ],
            "effects": [
                [part["part"], plus_minus(part["deg_h"], part["std_deg_h"])] for part in turn["effects"]
            ],
            "chi2": f"{turn['chi2']:.1f}",
            "freedom": turn["degrees_of_freedom"],
        }
        for turn in document["same_turn"]
    ]


def runs(document: Document) -> list[list[str]]:
    """Runs as rows of text."""
    return [
        [
            run["run"],
            run["started_at"],
            duration(run["duration_s"]),
            ", ".join(map(number, run["rates_deg_s"])),
            run["capture_sha256"][:16] + "…",
        ]
        for run in document["runs"]
    ]


def steadiest(windows: Document) -> str:
    """The longest steady window of each gyro, in words."""
    words = []
    for one in windows["gyros"]:
        best = one["steadiest"]
        if best is None:
            words.append(f"{one['gyro']}: none")
        else:
            words.append(f"{one['gyro']}: {best['length_s']:.0f} s from {best['start_s']:.0f} s")
    return "Longest steady window of each gyro: " + "; ".join(words) + "."
