"""Data of plots that zoom, as JSON in the page; `templates/zoom.js` draws them with uPlot.

Values have so many digits as their scatter gives sense to, so that a page stays small.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from fogreduce.pages.svg import Panel

Array = NDArray[np.float64]

#: Digits of a value beyond the first of the values' range.
_DIGITS = 3


@dataclass(frozen=True)
class Line:
    """A panel over time: name with unit; mean, lowest and highest of each column (NaN: none); a level."""

    name: str
    mean: Array
    lowest: Array
    highest: Array
    level: float | None
    words: str


def lines(axis: str, x: Array, panels: Sequence[Line]) -> Markup:
    """Columns over a shared axis.

    Parameters
    ----------
    axis : str
        Name of the axis, with its unit.
    x : (m,) array
    panels : sequence of Line
        Arrays of m values.
    """
    out = []
    for panel in panels:
        digits = _decimals(np.concatenate((panel.lowest, panel.highest)))
        band = bool(np.any(panel.highest > panel.lowest))  # where bins stand for themselves there is none
        out.append(
            {
                "name": panel.name,
                "values": rounded(panel.mean, digits),
                "low": rounded(panel.lowest, digits) if band else None,
                "high": rounded(panel.highest, digits) if band else None,
                "level": panel.level,
                "words": panel.words,
            }
        )
    return _block({"kind": "lines", "axis": axis, "x": rounded(x, _decimals(np.diff(x))), "panels": out})


def runs(names: Sequence[str] | None, dates: Sequence[str] | None, panels: Sequence[Panel]) -> Markup:
    """Runs side by side, as the panels of `fogreduce.pages.svg.points` have them.

    Parameters
    ----------
    names, dates : sequence of str or None
        Of each run; None: those of the page's first figure.
    panels : sequence of Panel
        Of as many runs.
    """
    return _block(
        {"kind": "runs", "axis": "run", "names": names, "dates": dates, "panels": [_panel(p) for p in panels]}
    )


def _panel(panel: Panel) -> dict[str, Any]:
    digits = _decimals_of(panel.values)
    limits = [rounded([pair[side] for pair in panel.limits or ()], digits) for side in (0, 1)]
    return {
        "name": f"{panel.name} [{panel.unit}]",
        "values": rounded(panel.values, digits),
        "errors": rounded(panel.errors, digits) if panel.errors else None,
        "low": rounded(panel.lows, digits) if panel.lows else None,
        "high": rounded(panel.highs, digits) if panel.highs else None,
        "bars": bool(panel.errors or panel.lows),
        "limits": limits if panel.limits else None,
        "level": panel.centre,
        "out": sorted(panel.out),
    }


def rounded(values: Any, digits: int) -> list[float | None]:
    """Values to so many decimals; None for NaN, whole numbers without a point."""
    out: list[float | None] = []
    for value in values:
        if value is None or not math.isfinite(value):
            out.append(None)
        else:
            short = round(float(value), digits)
            out.append(int(short) if short == int(short) else short)
    return out


def _decimals_of(values: Sequence[float | None]) -> int:
    """Decimals that tell values apart, of what is there."""
    return _decimals(np.array([math.nan if value is None else value for value in values], float))


def _decimals(values: Array) -> int:
    there = values[np.isfinite(values)]
    span = float(np.ptp(there)) if there.size else 0.0
    span = span or float(np.max(np.abs(there), initial=0.0)) or 1.0
    return max(0, min(15, _DIGITS - math.floor(math.log10(span))))


def _block(data: dict[str, Any]) -> Markup:
    """JSON that no HTML parser takes for a tag."""
    text = json.dumps(data, allow_nan=False, separators=(",", ":"), ensure_ascii=False)
    return Markup(text.replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026"))
