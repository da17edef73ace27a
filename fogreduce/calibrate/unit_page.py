"""The page of a unit: each coefficient over its calibration records, and what aged by how much."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

import numpy as np
from markupsafe import Markup

from fogreduce.calibrate.coefficients import NAMES, Coefficients, changes
from fogreduce.calibrate.registry import Entry, superseded_by
from fogreduce.errors import BadInput
from fogreduce.pages.numbers import number, plus_minus
from fogreduce.pages.render import Crumb, page
from fogreduce.pages.svg import Panel, points, some_ticks

TEMPLATE = "unit.html"
#: Where results have the pages of units.
FOLDER = "_units"
#: Beyond so many standard deviations a change is marked: of some dozens chance makes one in a hundred pages.
_CLEAR_SIGMA = 3.5
_DAYS_PER_YEAR = 365.25
_TITLES = {
    "bias": "Bias",
    "scale factor": "Scale factor",
    "axis, first": "Input axis (first direction across it)",
    "axis, second": "Input axis (second direction across it)",
}


def unit_page(
    unit: str,
    entries: Sequence[Entry],
    used: Mapping[str, Sequence[str]] | None = None,
    in_results: bool = False,
) -> str:
    """The page of a unit.

    Parameters
    ----------
    unit : str
    entries : sequence of Entry
        Its records in order of validity.
    used : mapping or None
        Record -> results reduced with it; None where nobody looked.
    in_results : bool
        Whether it lies in the results' folder `FOLDER`: then it leads back to the page of all campaigns.
    """
    of_unit = [entry for entry in entries if entry.record.unit == unit]
    if not of_unit:
        raise BadInput.at(unit, "", found="no record", expected="a unit with calibration records")
    found = [Coefficients.of(entry.record) for entry in of_unit]
    # Records of another number of gyros (a unit rebuilt) stand in no chart with the newest.
    same = [k for k, entry in enumerate(of_unit) if entry.record.n == of_unit[-1].record.n]
    context = {
        "unit": unit,
        "records": [_row(entry, of_unit, used) for entry in of_unit],
        "looked": used is not None,
        "charts": _charts([of_unit[k] for k in same], [found[k] for k in same]),
        "left_out": len(of_unit) - len(same),
        "aged": [
            _aged(of_unit[earlier], of_unit[later], found[earlier], found[later])
            for earlier, later in pairwise(same)
        ],
        "clear_sigma": _CLEAR_SIGMA,
    }
    crumbs = [Crumb("All campaigns", "../index.html")] if in_results else []
    return page(TEMPLATE, f"Calibration of {unit}", context, crumbs)


def _row(entry: Entry, entries: Sequence[Entry], used: Mapping[str, Sequence[str]] | None) -> dict[str, Any]:
    record = entry.record
    return {
        "id": entry.record_id,
        "valid_from": str(record.valid_from)[:10],
        "valid_until": str(record.valid_until)[:10] if record.valid_until else "",
        "procedure": record.procedure,
        "supersedes": record.supersedes or "",
        "superseded_by": ", ".join(superseded_by(entries, entry.record_id)),
        "used": "" if used is None else str(len(used.get(entry.record_id, ()))),
        "sha256": entry.sha256,
    }


def _charts(entries: Sequence[Entry], found: Sequence[Coefficients]) -> list[tuple[str, Markup]]:
    """A figure a coefficient: its change since the first record, a panel a gyro."""
    first = found[0]
    since = [changes(first, one) for one in found]
    ticks = some_ticks([entry.record.version for entry in entries])
    stds = {
        "bias": [one.bias_std_deg_h for one in found],
        "scale factor": [one.scale_factor_std_rel * 1e6 for one in found],
        "axis, first": [one.axis_std_rad * 1e3 for one in found],
        "axis, second": [one.axis_std_rad * 1e3 for one in found],
    }
    charts = []
    for name, unit in NAMES.items():
        if name != "bias" and len(entries) == 1:
            continue  # a change needs two records
        panels = []
        for i in range(len(first.bias_deg_h)):
            moved = [next(c.value for c in one if (c.gyro, c.name) == (i, name)) for one in since]
            start = first.bias_deg_h[i] if name == "bias" else 0.0  # a bias has a zero of its own
            values = [float(start + value) for value in moved]
            panels.append(Panel(f"gyro{i + 1}", unit, values, errors=[float(one[i]) for one in stds[name]]))
        of = "" if name == "bias" else ", change since the first record"
        label = f"{_TITLES[name]} of each gyro over its records{of} [{unit}]"
        charts.append((label, points(panels, ticks, label, height=80.0)))
    return charts


def _aged(earlier: Entry, later: Entry, one: Coefficients, other: Coefficients) -> dict[str, Any]:
    """What changed from a record to the next, and how much that is a year."""
    years = (later.record.valid_from - earlier.record.valid_from).days / _DAYS_PER_YEAR
    rows = []
    for change in changes(one, other):
        beyond = change.sigma > _CLEAR_SIGMA
        yearly = change.value / years if years > 0 else np.nan
        rows.append(
            {
                "gyro": f"gyro{change.gyro + 1}",
                "of": change.name,
                "change": plus_minus(change.value, change.std, change.unit),
                "sigma": f"{change.sigma:.1f}",
                "beyond": beyond,
                "yearly": f"{number(yearly, 3)} {change.unit}" if beyond else "",
            }
        )
    return {"earlier": earlier.record_id, "later": later.record_id, "years": number(years, 3), "rows": rows}
