"""The page over all campaigns: what there is, and the history of each unit as control charts."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from fogreduce.pages import svg, zoom
from fogreduce.pages.attention import runs_to_see
from fogreduce.pages.control import FEWEST_RUNS
from fogreduce.pages.gather import Entry, Gathered
from fogreduce.pages.history import QUANTITIES, History, histories
from fogreduce.pages.numbers import count, number, plus_minus
from fogreduce.pages.render import page
from fogreduce.pages.run_page import started
from fogreduce.pages.verdict import FLAGGED, Verdict, verdicts

#: So many runs outside the limits are listed of each chart.
_MOST_LISTED = 50


@dataclass(frozen=True)
class Dated:
    """A reduced run and its campaign."""

    campaign: str
    entry: Entry
    overview: dict[str, Any]

    @property
    def key(self) -> tuple[str, str, str]:
        """By date, then by name."""
        return self.entry.started_at, self.campaign, self.entry.run_id

    @property
    def href(self) -> str | None:
        """Its page, relative to the page over all."""
        return f"{self.campaign}/{self.entry.run_id}/index.html" if self.entry.page else None


def index_page(campaigns: Sequence[Gathered], unit_pages: Collection[str] = ()) -> str:
    """The page over campaigns, each with its runs.

    Parameters
    ----------
    campaigns : sequence of Gathered
    unit_pages : collection of str
        Units of which there is a page of their calibration records, ``_units/<unit>.html``.
    """
    runs = [
        Dated(gathered.name, entry, entry.overview)
        for gathered in campaigns
        for entry in gathered.reduced
        if entry.overview is not None
    ]
    runs.sort(key=lambda run: run.key)
    units = sorted({str(run.overview["unit"]) for run in runs})
    found = verdicts([run.overview for run in runs])
    flagged = [
        (f"{run.campaign} / {run.entry.run_id}", run.href, said.reasons)
        for run, said in zip(runs, found, strict=True)
    ]
    of_campaign = {
        gathered.name: [said for run, said in zip(runs, found, strict=True) if run.campaign == gathered.name]
        for gathered in campaigns
    }
    context = {
        "attention": runs_to_see(flagged),
        "campaigns": [_campaign(gathered, of_campaign[gathered.name]) for gathered in campaigns],
        "units": [_unit(unit, [run for run in runs if run.overview["unit"] == unit]) for unit in units],
        "unit_pages": unit_pages,
        "fewest": FEWEST_RUNS,
    }
    scripts = ["zoom.js"] if units else []
    return page("index.html", "All campaigns", context, scripts=scripts)


def _campaign(gathered: Gathered, verdicts: Sequence[Verdict]) -> dict[str, Any]:
    seen = [entry.overview for entry in gathered.reduced if entry.overview]
    dates = sorted(str(overview["started_at"])[:10] for overview in seen)
    kinds = Counter(kind for said in verdicts for kind in {reason["kind"] for reason in said.reasons})
    flagged = sum(said.state == FLAGGED for said in verdicts)
    labels = {str(overview["label"]) for overview in seen}
    return {
        "name": gathered.name,
        "href": f"{gathered.name}/index.html" if gathered.page else None,
        "title": gathered.about.title or "",
        "label": gathered.about.label or (labels.pop() if len(labels) == 1 else ""),
        "units": ", ".join(sorted({str(overview["unit"]) for overview in seen})),
        "dates": " to ".join(dict.fromkeys(dates[:1] + dates[-1:])),
        "runs": len(gathered.runs),
        "failed": len(gathered.failed),
        "good": len(verdicts) - flagged,
        "flagged": flagged,
        "because": ", ".join(f"{count(kinds[kind])} {kind}" for kind in sorted(kinds)),
    }


def _unit(unit: str, runs: Sequence[Dated]) -> dict[str, Any]:
    """A unit's charts: for each quantity a panel an axis."""
    charts = []
    found = histories([run.overview for run in runs])
    dates = [run.entry.started_at[:10] for run in runs]
    names = [f"{run.campaign} / {run.entry.run_id}" for run in runs]
    for kind, title in QUANTITIES.items():
        of_kind = [history for history in found if history.kind == kind]
        if not of_kind:
            continue
        panels = [_panel(history, len(runs)) for history in of_kind]
        rows = [_numbers(history) for history in of_kind]
        out = [_outside(history, k, runs[history.there[k]]) for history in of_kind for k in history.found.out]
        charts.append(
            {
                "title": title,
                "svg": svg.points(panels, svg.some_ticks(dates), _said(title, unit, rows)),
                "zoom": zoom.runs(names, dates, panels),
                "rows": rows,
                "out": out[:_MOST_LISTED],
                "more": max(0, len(out) - _MOST_LISTED),
            }
        )
    return {"name": unit, "runs": len(runs), "charts": charts}


def _outside(history: History, k: int, run: Dated) -> dict[str, Any]:
    return {
        "axis": history.axis,
        "run": f"{run.campaign} / {run.entry.run_id}",
        "href": run.href,
        "started": started(run.entry.started_at)[:16],
        "value": plus_minus(history.values[k], history.errors[k]),
        "limits": history.limits(k),
    }


def _panel(history: History, size: int) -> svg.Panel:
    """Runs without this quantity leave a gap; the limits go on over it as they were."""
    spread: list[float | None] = [None] * size
    bars: list[float | None] = [None] * size
    for place, value, error in zip(history.there, history.values, history.errors, strict=True):
        spread[place], bars[place] = value, error
    found, limits = history.found, None
    if found.limits is not None:
        known = dict(zip(history.there, found.limits, strict=True))
        last, limits = found.limits[0], []
        for place in range(size):
            last = known.get(place, last)
            limits.append(last)
    out = frozenset(history.there[k] for k in found.out)
    return svg.Panel(history.axis, "deg/h", spread, bars, centre=found.centre, limits=limits, out=out)


def _numbers(history: History) -> list[str]:
    """Axis, runs, centre, scatter beyond errors, runs outside the limits, most in a row on one side."""
    found = history.found
    return [
        history.axis,
        count(len(history.values)),
        number(found.centre, 4),
        "too few runs" if found.extra is None else number(found.extra, 3),
        "" if found.limits is None else count(len(found.out)),
        count(found.longest) + (", level moved" if found.moved else ""),
    ]


def _said(title: str, unit: str, rows: Sequence[Sequence[str]]) -> str:
    """The chart in words."""
    parts = [
        f"{axis}: {runs} runs, centre {centre} deg/h"
        + (f", {out} outside the limits" if out else ", no limits")
        for axis, runs, centre, _, out, _ in rows
    ]
    return f"Control chart of unit {unit}: {title} by run, in order of date. " + "; ".join(parts) + "."
