"""Rows of rates.csv that are not right, in words: for standard error, logs and pages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from fogreduce.pages.numbers import number, plus_minus, signed
from fogreduce.stages.rates import OK

Row = Mapping[str, str]


def odd_rows(rows: Sequence[Row]) -> list[Row]:
    """The rows that are flagged or have no rate; the whole run's only where no segment's is."""
    odd = [row for row in rows if row["verdict"] != OK]
    return [row for row in odd if row["segment"] != "all"] or odd


def flag_text(row: Row) -> str:
    """What a row of rates.csv says, in a line."""
    place = f"{row['axis']}, " + ("whole run" if row["segment"] == "all" else f"segment {row['segment']}")
    if not row["measured_deg_s"]:
        return f"{place}: no rate: {row['looks_like']}"
    measured, commanded = float(row["measured_deg_s"]), float(row["commanded_deg_s"])
    off, error = float(row["difference_deg_h"]), float(row["difference_err_deg_h"])
    far = abs(float(row["difference_sigma"]))
    text = f"{place}: mean rate {number(measured, 6)} deg/s, commanded {number(commanded, 6)}"
    text += f" ({signed(plus_minus(off, error))} deg/h, {number(far, 3)} sigma)"
    if row["sine_sigma"] and float(row["sine_sigma"]) > far:
        sine, sine_error = float(row["sine_deg_h"]), float(row["sine_err_deg_h"])
        text += f"; Earth's rate leaves a sine of {plus_minus(sine, sine_error)} deg/h"
        text += f" ({number(float(row['sine_sigma']), 3)} sigma)"
    return f"{text}; looks like {row['looks_like']}" if row["looks_like"] else text
