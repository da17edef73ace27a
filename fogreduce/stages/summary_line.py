"""What a reduction came to, in one line: records used, flags, drift, difference from the command."""

from __future__ import annotations

import math
from collections.abc import Iterable

from fogreduce.stages.files import read_report
from fogreduce.stages.read_table import Row
from fogreduce.stages.read_tables import read_rows
from fogreduce.stages.setup import Setup


def summary_line(setup: Setup, warnings: int) -> str:
    """Records used of expected, flags, drift, difference from the command."""
    report = read_report(setup, "ingest")
    gyros, axes = report["usable"]["gyros"], report["usable"]["axes"]
    used = axes if setup.axes else max(gyros)
    flagged = sum(report["flagged"].values())
    parts = [
        f"{used} of {report['expected']} records used, {report['lost']} lost, {flagged} flags, "
        f"{warnings} warning{'' if warnings == 1 else 's'}"
    ]
    parts += _drift(read_rows(setup.out, "drift", setup.version_id, setup.facts.raw_unit))
    parts += _difference(read_rows(setup.out, "rates", setup.version_id, setup.facts.raw_unit))
    return "; ".join(parts)


def _drift(rows: list[Row]) -> Iterable[str]:
    """Drift of each axis, over the whole run, with its coloured standard error where there is one."""
    whole = [row for row in rows if row["segment"] == "all"] or rows
    said = []
    for row in whole:
        value = _number(row["drift_deg_h"])
        if math.isnan(value):
            said.append(f"{row['axis']} none")
            continue
        error = _number(row["drift_err_coloured_deg_h"])
        if math.isnan(error):
            error = _number(row["drift_err_deg_h"])
        said.append(f"{row['axis']} {value:.4g} ± {error:.2g}")
    if said:
        yield "drift [deg/h] " + ", ".join(said)


def _difference(rows: list[Row]) -> Iterable[str]:
    """The largest difference of a mean rate from the command, in its standard errors."""
    with_difference = [row for row in rows if row["difference_sigma"]]
    if with_difference:
        worst = max(with_difference, key=lambda row: abs(float(row["difference_sigma"])))
        sigma = float(worst["difference_sigma"])
        yield (
            f"off the command by {float(worst['difference_deg_h']):+.3g} deg/h at most, "
            f"{sigma:+.2g} sigma ({worst['axis']})"
        )


def _number(text: str) -> float:
    return float(text) if text else math.nan
