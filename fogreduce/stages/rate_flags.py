"""Rows of rates.csv that are not right, in words: for standard error, logs and pages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

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
    sigma = float(row["difference_sigma"])
    text = f"{place}: mean rate {measured:.6g} deg/s, commanded {commanded:.6g}"
    text += f" ({off:+.4g} ± {error:.2g} deg/h, {sigma:+.3g} sigma)"
    if row["sine_sigma"] and float(row["sine_sigma"]) > abs(sigma):
        sine, far = float(row["sine_deg_h"]), float(row["sine_sigma"])
        text += f"; Earth's rate leaves a sine of {sine:.3g} deg/h ({far:.3g} sigma)"
    return f"{text}; looks like {row['looks_like']}" if row["looks_like"] else text
