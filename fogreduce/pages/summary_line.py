"""What a reduction came to, in one line: records used, flags, drift, difference from the command."""

from __future__ import annotations

from collections.abc import Iterable

from fogreduce.pages.numbers import number, plus_minus, signed
from fogreduce.pages.overview import error_of, real, whole_run
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
    whole = whole_run(rows)
    said = [
        f"{row['axis']} {plus_minus(real(row['drift_deg_h']), error_of(row, 'drift_', 'deg_h')) or 'none'}"
        for row in rows
        if row["segment"] == whole
    ]
    if said:
        yield "drift [deg/h] " + ", ".join(said)


def _difference(rows: list[Row]) -> Iterable[str]:
    """The largest difference of a mean rate from the command, in its standard errors."""
    with_difference = [row for row in rows if row["difference_sigma"]]
    if with_difference:
        worst = max(with_difference, key=lambda row: abs(float(row["difference_sigma"])))
        off = signed(number(float(worst["difference_deg_h"]), 3))
        sigma = number(abs(float(worst["difference_sigma"])), 3)
        yield f"off the command by {off} deg/h at most, {sigma} sigma ({worst['axis']})"
