"""The page of a campaign: runs side by side, as figures and as a table to sort and filter; what failed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from markupsafe import Markup

from fogreduce.pages import svg, zoom
from fogreduce.pages.attention import names_of, runs_to_see
from fogreduce.pages.control import FEWEST_RUNS
from fogreduce.pages.flags import flags_text
from fogreduce.pages.gather import Entry, Gathered
from fogreduce.pages.numbers import count, duration, minus_signs, number, plus_minus
from fogreduce.pages.render import Crumb, page
from fogreduce.pages.run_page import started, table_text
from fogreduce.pages.verdict import FAILED, FLAGGED, GOOD, Verdict, verdicts

#: Pages of a campaign beside its runs', where they were made, and what they are.
_MORE_PAGES = (
    ("_report/index.html", "the unit's test report"),
    ("_diagnosis/index.html", "the diagnosis: where its runs and the simulator disagree, and why"),
    (
        "_calibration/index.html",
        "the calibration derived from it: a candidate record, which no result uses until a person names it",
    ),
)
#: A unit leads to its part of the index, which a bag has too, and from there to its calibration records.
_UNIT_LINK = '<a href="../index.html#unit-{0}">{0}</a>'
#: So many failed runs stand at the top; all stand in the table of runs.
_MOST_FAILED = 10
#: So many rows of the table are laid out at first, where the page's script can show the rest.
_MOST_FIRST = 200
#: A choice among more ways of turning the table than these is no help.
_MOST_CHOICES = 60

Cell = dict[str, Any]


def campaign_page(gathered: Gathered, folder: Path) -> str:
    """The page of a campaign.

    Parameters
    ----------
    gathered : Gathered
        Its runs.
    folder : Path
        Its results: whether there is a diagnosis or a derived calibration to be linked.
    """
    runs = gathered.runs
    found = _verdicts(runs)
    columns = _columns(runs)
    rows = [_row(entry, said, columns) for entry, said in zip(runs, found, strict=True)]
    tables = sorted({row["table"] for row in rows if row["table"]})
    context = {
        "about": gathered.about,
        "name": gathered.name,
        "verdict": _whole(gathered, found),
        "facts": _facts(gathered),
        "attention": runs_to_see(
            [
                (entry.run_id, f"{entry.run_id}/index.html" if entry.page else None, said.reasons)
                for entry, said in zip(runs, found, strict=True)
                if said is not None
            ]
        ),
        "failed": gathered.failed,
        "most_failed": _MOST_FAILED,
        "left_out": gathered.left_out,
        "more_pages": [(href, words) for href, words in _MORE_PAGES if (folder / href).is_file()],
        "charts": _charts(runs, found),
        "columns": columns,
        "heads": ["run", "", *(column["title"] for column in columns)],
        "rows": rows,
        "tables": tables if 1 < len(tables) <= _MOST_CHOICES else [],
        "fewest": FEWEST_RUNS,
        "most_first": _MOST_FIRST,
        "versions": _versions(gathered.reduced),
        "assumed": _assumed(gathered.reduced),
    }
    label = gathered.about.label or _one_label(gathered.reduced)
    crumbs = [Crumb("All campaigns", "../index.html")]
    scripts = ["table.js", *(["zoom.js"] if context["charts"] else [])]
    return page("campaign.html", gathered.name, context, crumbs, label, scripts)


def _verdicts(runs: Sequence[Entry]) -> list[Verdict | None]:
    """On each run, control limits among the campaign's runs in it; None where it is not reduced."""
    found = iter(verdicts([entry.overview for entry in runs if entry.overview is not None]))
    return [None if entry.overview is None else next(found) for entry in runs]


def _whole(gathered: Gathered, verdicts: Sequence[Verdict | None]) -> Verdict:
    """On the campaign: how many runs are flagged, how many failed."""
    flagged = sum(said is not None and said.state == FLAGGED for said in verdicts)
    text = f"of {count(len(verdicts))} runs {count(flagged)} flagged, {count(len(gathered.failed))} failed"
    if gathered.left_out:
        text += f", {count(len(gathered.left_out))} left out"
    if gathered.failed or gathered.left_out:
        return Verdict(FAILED, text, [])
    return Verdict(FLAGGED if flagged else GOOD, text, [])


def _one_label(reduced: Sequence[Entry]) -> str:
    labels = {str(entry.overview["label"]) for entry in reduced if entry.overview}
    return labels.pop() if len(labels) == 1 else ""


def _facts(gathered: Gathered) -> list[tuple[str, str]]:
    seen = [entry.overview for entry in gathered.reduced if entry.overview]
    dates = sorted(overview["started_at"] for overview in seen)
    pairs = [
        (
            "Runs",
            f"{count(len(gathered.runs))}: {count(len(seen))} reduced, {count(len(gathered.failed))} failed",
        ),
        ("Unit", _several((overview["unit"] for overview in seen), _UNIT_LINK)),
        ("From, to", " to ".join(dict.fromkeys(date[:10] for date in (dates[:1] + dates[-1:])))),
        ("Calibration", _several(overview["calibration"] for overview in seen)),
        ("Operator", gathered.about.operator or ""),
    ]
    return [(name, value) for name, value in pairs if value]


def _assumed(reduced: Sequence[Entry]) -> list[tuple[str, str, str, str]]:
    """Values that nobody stated: where, key, what is assumed, and in how many runs."""
    counted = Counter(
        (item["file"], item["key"], item["said"])
        for entry in reduced
        if entry.overview
        for item in entry.overview.get("assumed", ())
    )
    return [(*item, count(times)) for item, times in counted.items()]


def _several(names: Iterable[str], form: str = "{0}") -> Markup:
    """Names as `form` has them, with the number of runs where there are several."""
    counted = sorted(Counter(names).items())
    return Markup(", ").join(
        Markup(form).format(name) + (f" ({count(times)})" if len(counted) > 1 else "")
        for name, times in counted
    )


def _versions(reduced: Sequence[Entry]) -> list[tuple[str, str, str]]:
    """Version of the package, digest of its code, and how many runs were reduced with them."""
    counted = Counter((e.overview["software"], e.overview["code"]) for e in reduced if e.overview)
    return [(software, code, count(times)) for (software, code), times in sorted(counted.items())]


def _columns(runs: Sequence[Entry]) -> list[dict[str, str]]:
    """Columns of numbers: those that some run has."""
    seen = [entry.overview for entry in runs if entry.overview]
    columns = []
    for kind, title in (("offset", "offset {} [deg/h]"), ("drift", "drift {} [deg/h]")):
        names = names_of(kind, seen)
        columns += [{"kind": kind, "of": name, "title": title.format(name)} for name in names]
    if any(overview["noise"] for overview in seen):
        columns.append({"kind": "noise", "of": "", "title": "noise [deg/√h]"})
    if any(overview["temperature"] for overview in seen):
        columns.append({"kind": "temperature", "of": "", "title": "sensors [°C]"})
    return columns


def _row(entry: Entry, said: Verdict | None, columns: Sequence[dict[str, str]]) -> dict[str, Any]:
    overview = entry.overview
    if overview is None or said is None:
        state, table = FAILED, ""
        why = f"{entry.stage}: {entry.reason}" if entry.stage else entry.reason
        cells: list[Cell] = [{"value": "", "text": ""} for _ in columns]
    else:
        length = duration(overview["duration_s"]).replace(" ", "\N{NO-BREAK SPACE}")
        state, table = said.state, f"{table_text(overview)}, {length}"
        noted = flags_text(overview["flagged"])
        why = said.text if said.state == FLAGGED else noted
        cells = [_cell(overview, column) for column in columns]
    return {
        "run_id": entry.run_id,
        "href": f"{entry.run_id}/index.html" if entry.page else None,
        "started": started(entry.started_at)[:16],
        "table": table,
        "state": state,
        "cells": cells,
        "why": why,
    }


def _cell(overview: dict[str, Any], column: dict[str, str]) -> Cell:
    kind = column["kind"]
    if kind == "noise":
        value = max(overview["noise"].values(), default=None)
        text = number(value, 3, noughts=True)
    elif kind == "temperature":
        value = (overview["temperature"] or {}).get("mean")
        text = "" if value is None else minus_signs(f"{value:.2f}")
    else:
        entry = overview[kind].get(column["of"], {})
        value = entry.get("value")
        text = plus_minus(value, entry.get("error"))
    # What begins with its number sorts by that; a power of ten does not.
    return {"value": f"{value:.6g}" if "·" in text else "", "text": text}


def _charts(runs: Sequence[Entry], verdicts: Sequence[Verdict | None]) -> list[dict[str, Any]]:
    """Figures over all runs in order of date; runs that failed are crosses at the bottom."""
    seen = [entry.overview for entry in runs]
    some = [overview for overview in seen if overview]
    if not some:
        return []
    absent = [place for place, overview in enumerate(seen) if overview is None]
    ticks = svg.some_ticks([entry.started_at[:10] for entry in runs])
    charts = []
    for kind, title, text in (
        (
            "offset",
            "Mean rates less commanded",
            "Mean of the fitted curve over the run, Earth's rate taken away, less the commanded rate. "
            "Bars: one standard error by the noise that the residuals show.",
        ),
        (
            "drift",
            "Drift",
            "Bars: one standard error by the noise that the residuals show. Drift leaves out how far the "
            "mean rate is off: that is the figure before.",
        ),
    ):
        panels = []
        for of in names_of(kind, some):
            entries = [overview[kind].get(of, {}) if overview else {} for overview in seen]
            values, errors = ([entry.get(name) for entry in entries] for name in ("value", "error"))
            panels.append(svg.Panel(of, "deg/h", values, errors, zero=True))
        charts.append((title, text, panels))
    gyros = sorted({gyro for overview in some for gyro in overview["noise"]})
    noise = [
        svg.Panel(gyro, "deg/√h", [overview["noise"].get(gyro) if overview else None for overview in seen])
        for gyro in gyros
    ]
    charts.append(
        ("Noise", "Angle random walk of each gyro, from the Allan variance of what its curve leaves.", noise)
    )
    if any(overview["temperature"] for overview in some):
        logs = [overview["temperature"] if overview else None for overview in seen]
        panel = svg.Panel(
            "sensors",
            "°C",
            [log["mean"] if log else None for log in logs],
            lows=[log["low"] if log else None for log in logs],
            highs=[log["high"] if log else None for log in logs],
        )
        charts.append(("Temperature", "Mean of the sensors' log; bars: its lowest and highest.", [panel]))
    names = [entry.run_id for entry in runs]
    out = frozenset(place for place, said in enumerate(verdicts) if said and said.state == FLAGGED)
    dates = [entry.started_at[:10] for entry in runs]
    shown = [
        (title, text, panels)
        for title, text, drawn in charts
        if (panels := [replace(panel, out=out) for panel in drawn if any(panel.values)])
    ]
    return [
        {
            "title": title,
            "text": text,
            "svg": svg.points(panels, ticks, _said(title, panels), absent, linked=True),
            "zoom": zoom.runs(None if k else names, None if k else dates, panels),
        }
        for k, (title, text, panels) in enumerate(shown)
    ]


def _said(title: str, panels: Sequence[svg.Panel]) -> str:
    """A figure in words: for each panel how many, the median, the lowest and the highest."""
    parts = []
    for panel in panels:
        values = sorted(value for value in panel.values if value is not None)
        if values:
            low, middle, high = (number(values[k], 3) for k in (0, len(values) // 2, -1))
            parts.append(
                f"{panel.name}: {len(values)} runs, median {middle}, from {low} to {high} {panel.unit}"
            )
    return f"{title} by run, in order of date. " + "; ".join(parts) + ". The table below has every number."
