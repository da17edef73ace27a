"""What each uncertainty of a run comes from, as bars for its page."""

from __future__ import annotations

from collections.abc import Sequence

from markupsafe import Markup

from fogreduce.pages import svg
from fogreduce.pages.numbers import number
from fogreduce.pages.overview import real, whole_run
from fogreduce.stages.budget import PARTS
from fogreduce.stages.read_table import Row

#: Quantity -> in words. Those of the whole run, or of its only segment.
_SHOWN = {"drift": "drift", "mean_rate": "mean rate"}
_PARTS = {part: part.replace("_", " ") for part in PARTS} | {"turn_on": "turn-on bias"}


def budget_bars(rows: Sequence[Row]) -> Markup | None:
    """Bars of the parts of each combined variance, and the combined standard uncertainty at their ends.

    Parameters
    ----------
    rows : sequence of Row
        Of tables/budget.csv.

    Returns
    -------
    Markup or None
        None where no quantity that is shown has an uncertainty.
    """
    of = whole_run(rows)
    bars, said = [], []
    for quantity, words in _SHOWN.items():
        for row in rows:
            combined = real(row["u_combined"])
            if (row["quantity"], row["segment"]) != (quantity, of) or not combined:
                continue
            parts = {name: real(row[f"u_{part}"]) or 0.0 for part, name in _PARTS.items()}
            shares = {part: (size / combined) ** 2 for part, size in parts.items()}
            bars.append(svg.Bar(f"{words} {row['channel']}", f"{number(combined, 2)} {row['unit']}", shares))
            largest = max(shares, key=lambda part: shares[part])
            said.append(f"{bars[-1].name} {bars[-1].text}, {100 * shares[largest]:.0f} % {largest}")
    if not bars:
        return None
    return svg.shares(bars, f"Shares of the combined variances: {'; '.join(said)}")
