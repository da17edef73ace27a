"""Figures of pages as SVG text, drawn without a plotting library: points with error bars, bands over time,
traces, bars, maps.

Bands, traces, bars and maps take the width that they are drawn for: `WIDE`, or `SLIM` for a phone, on which
a wide figure's words could not be read.
"""

from fogreduce.pages.svg.bands import Band, bands
from fogreduce.pages.svg.bars import Bar, Step, bars, grid, shares, steps
from fogreduce.pages.svg.frame import AFTER, BEFORE, QUIET, SLIM, WIDE, whole
from fogreduce.pages.svg.points import Panel, points, some_ticks
from fogreduce.pages.svg.traces import traces

__all__ = [
    "AFTER",
    "BEFORE",
    "QUIET",
    "SLIM",
    "WIDE",
    "Band",
    "Bar",
    "Panel",
    "Step",
    "bands",
    "bars",
    "grid",
    "points",
    "shares",
    "some_ticks",
    "steps",
    "traces",
    "whole",
]
