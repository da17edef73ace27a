"""Whether a run is good or flagged, and why, in words: the first line of its page, its state in tables."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fogreduce.pages.flags import flags_text
from fogreduce.pages.history import outside
from fogreduce.pages.numbers import number

GOOD, FLAGGED, FAILED = "good", "flagged", "failed"


@dataclass(frozen=True)
class Verdict:
    """`state`: good, flagged or failed; `text`: why; `reasons`: each with its ``kind`` and ``text``."""

    state: str
    text: str
    reasons: list[Mapping[str, str]]


def verdict(overview: Mapping[str, Any], outside: Sequence[Mapping[str, str]] = ()) -> Verdict:
    """The verdict on a reduced run.

    A run is flagged by red flags of rates.csv, by warnings, where more than 1 % of a kind of record was lost
    or flagged, and outside control limits. Fewer records are noted and leave it good.

    Parameters
    ----------
    overview : mapping
        See `fogreduce.pages.overview`.
    outside : sequence of mapping
        Where it lies outside the control limits of its unit; see `fogreduce.pages.history`.
    """
    reasons = [*overview.get("attention", ()), *outside]
    if reasons:
        more = f"; and {len(reasons) - 1} more" if len(reasons) > 1 else ""
        return Verdict(FLAGGED, f"{reasons[0]['kind']}: {reasons[0]['text']}{more}", reasons)
    said = [_agreement(overview)]
    if overview["flagged"]:
        said.append(f"noted: {flags_text(overview['flagged'])}")
    return Verdict(GOOD, "; ".join(said), [])


def verdicts(overviews: Sequence[Mapping[str, Any]]) -> list[Verdict]:
    """The verdict on each of runs in order of date, with what lies outside the control limits among them."""
    return [verdict(seen, beyond) for seen, beyond in zip(overviews, outside(overviews), strict=True)]


def combined(entry: Mapping[str, float | None]) -> float | None:
    """Standard uncertainty of a value of the overview: noise and what is stated, together [deg/h]."""
    parts = [part for part in (entry.get("error"), entry.get("stated")) if part is not None]
    return math.hypot(*parts) if parts else None


def _agreement(overview: Mapping[str, Any]) -> str:
    """How far the mean rates are off, in words."""
    sigmas = []
    for entry in overview["offset"].values():
        uncertainty = combined(entry)
        if entry["value"] is not None and uncertainty:
            sigmas.append(abs(entry["value"]) / uncertainty)
    if not sigmas:
        return "no warnings; there is no mean rate to compare with the command"
    return f"mean rates agree with the command, at most {number(max(sigmas), 2)} standard uncertainties off"
