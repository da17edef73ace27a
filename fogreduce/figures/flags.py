"""How many records are out of the ordinary, and why."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, FuncFormatter

from fogreduce.figures.results import Results
from fogreduce.plotting import style

_ROW = 0.27  # inches a bar


def draw(results: Results) -> Figure:
    """A bar a kind, with its number; the scale is logarithmic from 1 on, 0 included."""
    report = results.ingest
    counts = counts_of(results)
    title = "Records out of the ordinary"
    figure, ((axes,),) = style.panels(results.identity, title, 1, _ROW * (len(counts) + 1), left_margin=1.75)
    places = np.arange(len(counts))[::-1]
    axes.barh(places, list(counts.values()), height=0.62, color=style.MEAN)
    axes.set_xscale("symlog", linthresh=1.0)
    most = max(1, *counts.values())
    axes.set_xlim(0, 8 * most)
    decades = [0.0] + [10.0**k for k in range(int(np.log10(8 * most)) + 1)]
    axes.xaxis.set_major_locator(FixedLocator(decades))
    axes.xaxis.set_minor_locator(FixedLocator([]))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:,.0f}"))
    axes.set_yticks(places, list(counts))
    axes.grid(visible=False, axis="y")
    axes.set_ylim(-0.8, len(counts) - 0.2)
    for place, count in zip(places, counts.values(), strict=True):
        axes.annotate(f"{count:,}", (count, place), (5, 0), textcoords="offset points", va="center")
    axes.set_xlabel("number")
    records, expected = report["records"], report["expected"]
    style.note(axes, f"{records:,} records in the capture, {expected:,} expected")
    return figure


def counts_of(results: Results) -> dict[str, int]:
    """Kind in words to its number, kinds of the whole record first."""
    report = results.ingest
    counts = {"lost": int(report["lost"] or 0), "torn at the end (octets)": int(report["torn_bytes"] or 0)}
    for kind, count in report["flagged"].items():
        words, _, gyro = kind.rpartition("_gyro")
        name = f"gyro{gyro} {words}" if words else kind.replace("_", " ")
        counts[name] = int(count)
    return counts
