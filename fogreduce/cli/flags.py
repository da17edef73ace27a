"""Red flags of rates.csv on standard error: where a run's mean rates are not those that were commanded."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from fogreduce.stages.setup import Setup

#: So many rows are said; all of them stand in the table.
_MOST = 3


def say_red_flags(setup: Setup) -> None:
    """One line a row of rates.csv that is flagged or has no rate, the first few; nothing for a good run."""
    from fogreduce.pages.rate_flags import flag_text, odd_rows
    from fogreduce.stages.rates import RATES_COLUMNS
    from fogreduce.stages.read_table import read_table
    from fogreduce.stages.summary import RED_FLAG

    odd = odd_rows(read_table(setup.table("rates"), RATES_COLUMNS, setup.version_id))
    said = [flag_text(row) for row in odd[:_MOST]]
    if len(odd) > _MOST:
        said.append(f"{len(odd) - _MOST} more rows, see {setup.table('rates')}")
    for text in said:
        run = f"{setup.manifest['campaign']}/{setup.manifest['run_id']}"
        print(f"{RED_FLAG}{run}: {text}", file=sys.stderr)
