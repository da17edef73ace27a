"""Red flags of rates.csv on standard error: where a run's mean rates are not those that were commanded."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

from fogreduce.stages.rates import FLAG, GROSS, NONE
from fogreduce.stages.summary import SAID_BESIDE

if TYPE_CHECKING:
    from fogreduce.stages.setup import Setup

#: So many rows are said; all of them stand in the table.
_MOST = 3


def say_red_flags(setup: Setup) -> None:
    """One line a row of rates.csv that is flagged or has no rate, the first few; nothing for a good run."""
    from fogreduce.stages.read_tables import read_rows

    rows = read_rows(setup.out, "rates", setup.version_id, setup.facts.raw_unit)
    run = f"{setup.manifest['campaign']}/{setup.manifest['run_id']}"
    odd = [row for row in rows if row["verdict"] in (FLAG, GROSS, NONE) and row["segment"] != "all"]
    for row in odd[:_MOST]:
        print(f"{SAID_BESIDE[0]}{run}: {flag_text(row)}", file=sys.stderr)
    if len(odd) > _MOST:
        more = f"{len(odd) - _MOST} more rows, see {setup.table('rates')}"
        print(f"{SAID_BESIDE[0]}{run}: {more}", file=sys.stderr)


def flag_text(row: dict[str, str]) -> str:
    """What a row of rates.csv says, in a line."""
    place = f"{row['axis']}, segment {row['segment']}"
    if row["verdict"] == NONE:
        return f"{place}: no rate: {row['looks_like']}"
    measured, commanded = float(row["measured_deg_s"]), float(row["commanded_deg_s"])
    off, sigma = float(row["difference_deg_h"]), float(row["difference_sigma"])
    text = f"{place}: mean rate {measured:.6g} deg/s, commanded {commanded:.6g}"
    text += f" ({off:+.4g} deg/h, {sigma:+.3g} sigma)"
    if row["sine_sigma"] and float(row["sine_sigma"]) > abs(sigma):
        sine, far = float(row["sine_deg_h"]), float(row["sine_sigma"])
        text += f"; Earth's rate leaves a sine of {sine:.3g} deg/h ({far:.3g} sigma)"
    return f"{text}; looks like {row['looks_like']}" if row["looks_like"] else text
