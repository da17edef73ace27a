"""The report as a page."""

from __future__ import annotations

from markupsafe import Markup

from fogreduce.characterise import report_rows as rows
from fogreduce.pages.numbers import number
from fogreduce.pages.render import Crumb, page
from fogreduce.pages.svg import whole

TEMPLATE = "report.html"
#: Where a campaign's results have it.
FOLDER = "_report"

_CELL = 9.0
_COLOURS = ("#f3f5f8", "#c9d8e8", "#86a3c3", "#1d4f80")  # up to 2, 4, 8 errors, beyond


def report_page(document: rows.Document, in_results: bool = False) -> str:
    """The page of a report's document; in a campaign's results, `FOLDER`, it leads back to the campaign's."""
    parity, windows = document["parity"], document["windows"]
    context = {
        "data": document,
        "verdict": rows.verdict_line(document),
        "determined": rows.determined(document),
        "open": rows.not_determined(document),
        "responses": rows.responses(document),
        "left_out": rows.left_out(document),
        "alarms": rows.alarms(document),
        "hours": number(parity["hours"], 3),
        "expected": number(parity["false_alarms_expected"], 2),
        "turns": rows.turns(document),
        "windows": None if windows is None else _windows(windows),
        "steadiest": "" if windows is None else rows.steadiest(windows),
        "definitions": rows.definition_rows(document),
        "runs": rows.runs(document),
    }
    crumbs = [Crumb(document["campaign"], "../index.html")] if in_results else []
    return page(TEMPLATE, f"Test report: {document['unit']}", context, crumbs)


def _windows(windows: rows.Document) -> Markup:
    """Start across, length up, a cell for each window, gyros side by side."""
    body, left = [], 60.0
    height = 60.0
    for one in windows["gyros"]:
        table, error = one["drift_deg_h_per_h"], one["error"]
        size = len(table)
        top = 24.0
        height = top + size * _CELL + 34
        body.append(f'<text x="{left:.0f}" y="14" font-weight="bold">{one["gyro"]}</text>')
        for b, row in enumerate(table):
            y = top + (size - 1 - b) * _CELL
            for a, value in enumerate(row):
                if value is None:
                    continue
                sigma = abs(value) / error[b] if error[b] > 0 else 0.0
                colour = _COLOURS[sum(sigma > step for step in (2, 4, 8))]
                body.append(
                    f'<rect x="{left + a * _CELL:.0f}" y="{y:.0f}" width="{_CELL - 1:.0f}" '
                    f'height="{_CELL - 1:.0f}" fill="{colour}"/>'
                )
        end = one["length_s"][-1]
        below = top + size * _CELL + 14
        body.append(f'<text x="{left:.0f}" y="{below:.0f}" fill="#5f5f5f">start 0 to {end:.0f} s</text>')
        left += size * _CELL + 12
    if left > 960:
        body = [f'<g transform="scale({940 / left:.3f})">', *body, "</g>"]
    return whole(height, body, "Drift against start and length of the window, by gyro")
