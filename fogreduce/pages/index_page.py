"""The page over all campaigns: what there is, and the history of each unit as control charts."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import Any

from fogreduce.pages import svg
from fogreduce.pages.attention import has_red_flag, names_of, runs_to_see
from fogreduce.pages.control import FEWEST_RUNS, Control, control
from fogreduce.pages.gather import Entry, Gathered
from fogreduce.pages.numbers import count, number, plus_minus
from fogreduce.pages.render import page
from fogreduce.pages.run_page import started

_QUANTITIES = (("offset", "Mean rate less commanded"), ("drift", "Drift"))
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
    context = {
        "attention": runs_to_see(
            [(f"{run.campaign} / {run.entry.run_id}", run.href, run.overview) for run in runs]
        ),
        "campaigns": [_campaign(gathered) for gathered in campaigns],
        "units": [_unit(unit, [run for run in runs if run.overview["unit"] == unit]) for unit in units],
        "unit_pages": unit_pages,
        "fewest": FEWEST_RUNS,
    }
    return page("index.html", "All campaigns", context)


def _campaign(gathered: Gathered) -> dict[str, Any]:
    seen = [entry.overview for entry in gathered.reduced if entry.overview]
    dates = sorted(str(overview["started_at"])[:10] for overview in seen)
    labels = {str(overview["label"]) for overview in seen}
    return {
        "name": gathered.name,
        "title": gathered.about.title or "",
        "label": gathered.about.label or (labels.pop() if len(labels) == 1 else ""),
        "units": ", ".join(sorted({str(overview["unit"]) for overview in seen})),
        "dates": " to ".join(dict.fromkeys(dates[:1] + dates[-1:])),
        "runs": len(gathered.runs),
        "failed": len(gathered.failed),
        "flagged": sum(bool(overview["flagged"]) for overview in seen),
        "red_flags": sum(has_red_flag(overview) for overview in seen),
    }


def _unit(unit: str, runs: Sequence[Dated]) -> dict[str, Any]:
    """A unit's charts: for each quantity a panel an axis."""
    charts = []
    for kind, title in _QUANTITIES:
        panels, rows, out = [], [], []
        for axis in names_of(kind, [run.overview for run in runs]):
            there = [
                k for k, run in enumerate(runs) if run.overview[kind].get(axis, {}).get("value") is not None
            ]
            if not there:
                continue
            entries = [runs[k].overview[kind][axis] for k in there]
            values = [float(entry["value"]) for entry in entries]
            errors = [float(entry["error"] or 0.0) for entry in entries]
            found = control(values, errors)
            panels.append(_panel(axis, len(runs), there, values, errors, found))
            rows.append(_numbers(axis, values, found))
            out += [
                {
                    "axis": axis,
                    "run": f"{runs[there[k]].campaign} / {runs[there[k]].entry.run_id}",
                    "href": runs[there[k]].href,
                    "started": started(runs[there[k]].entry.started_at)[:16],
                    "value": plus_minus(values[k], errors[k]),
                    "limits": _limits(found, k),
                }
                for k in found.out
            ]
        if panels:
            ticks = svg.some_ticks([run.entry.started_at[:10] for run in runs])
            charts.append(
                {
                    "title": title,
                    "svg": svg.points(panels, ticks, _said(title, unit, rows)),
                    "rows": rows,
                    "out": out[:_MOST_LISTED],
                    "more": max(0, len(out) - _MOST_LISTED),
                }
            )
    return {"name": unit, "runs": len(runs), "charts": charts}


def _panel(
    axis: str,
    size: int,
    there: Sequence[int],
    values: Sequence[float],
    errors: Sequence[float],
    found: Control,
) -> svg.Panel:
    """Runs without this quantity leave a gap; the limits go on over it as they were."""
    spread: list[float | None] = [None] * size
    bars: list[float | None] = [None] * size
    for place, value, error in zip(there, values, errors, strict=True):
        spread[place], bars[place] = value, error
    limits = None
    if found.limits is not None:
        known = dict(zip(there, found.limits, strict=True))
        last, limits = found.limits[0], []
        for place in range(size):
            last = known.get(place, last)
            limits.append(last)
    out = frozenset(there[k] for k in found.out)
    return svg.Panel(axis, "deg/h", spread, bars, centre=found.centre, limits=limits, out=out)


def _numbers(axis: str, values: Sequence[float], found: Control) -> dict[str, str]:
    return {
        "axis": axis,
        "runs": count(len(values)),
        "centre": number(found.centre, 4),
        "extra": "too few runs" if found.extra is None else number(found.extra, 3),
        "out": "" if found.limits is None else count(len(found.out)),
        "longest": count(found.longest) + (", level moved" if found.moved else ""),
    }


def _limits(found: Control, k: int) -> str:
    assert found.limits is not None
    low, high = found.limits[k]
    return f"{number(low, 3)} to {number(high, 3)}"


def _said(title: str, unit: str, rows: Sequence[dict[str, str]]) -> str:
    """The chart in words."""
    parts = [
        f"{row['axis']}: {row['runs']} runs, centre {row['centre']} deg/h"
        + (f", {row['out']} outside the limits" if row["out"] else ", no limits")
        for row in rows
    ]
    return f"Control chart of unit {unit}: {title} by run, in order of date. " + "; ".join(parts) + "."
