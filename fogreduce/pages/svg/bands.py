"""Records over time as a band and a line, a panel an axis, with a level across."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from fogreduce.pages import numbers
from fogreduce.pages.svg.frame import INK, PALE, POINT, QUIET, SLIM, WARNING, WIDE, nice, text_at, whole
from fogreduce.stages.read_bins import Columns

Array = NDArray[np.float64]

_HEIGHT, _GAP, _TOP = 104.0, 12.0, 6.0
#: Percent of the columns on either side that do not set the scale; what lies beyond it stands at the edge.
_BEYOND = 0.5
_ROOM = 0.25
_UNITS = (("s", 1.0, 1200.0), ("min", 60.0, 10_800.0), ("h", 3600.0, np.inf))


@dataclass(frozen=True)
class Band:
    """A panel: its name and unit, its columns, and where a line goes across (None: nowhere)."""

    name: str
    unit: str
    columns: Columns
    level: float | None


def bands(panels: Sequence[Band], label: str, width: float = WIDE) -> Markup:
    """Panels one above the other over a shared axis of time; 0 has a line of its own.

    Parameters
    ----------
    panels : sequence of Band
        Columns in the panel's unit, their times in s; all over the same time.
    label : str
        What the figure says, for who cannot see it.
    width : float
        `WIDE` or `SLIM`.
    """
    slim = width <= 2 * SLIM
    left, right = (58.0, 6.0) if slim else (104.0, 10.0)
    inner = width - left - right
    times = np.concatenate([panel.columns.time_s for panel in panels])
    start, stop = min(0.0, float(times.min())), float(times.max())
    length = (stop - start) or 1.0
    body, top = [], _TOP
    for panel in panels:
        body += _band(panel, (left, top, inner), (start, length), slim)
        top += _HEIGHT + _GAP
    unit, scale, _ = next(entry for entry in _UNITS if stop <= entry[2])
    ticks = nice(start / scale, stop / scale)
    for value, text in zip(ticks, numbers.apart(ticks), strict=True):
        x = left + inner * (value * scale - start) / length
        last = value == ticks[-1]
        body.append(
            text_at(min(x, width - 30.0), top + 4, f"{text} {unit}" if last else text, "middle", QUIET)
        )
    return whole(top + 10, body, label, width)


def _band(panel: Band, place: tuple[float, float, float], span: tuple[float, float], slim: bool) -> list[str]:
    """One panel: frame, scale, band, line and level; `place`: left, top and inner width [px]."""
    left, top, inner = place
    low, high = _range(panel)
    scale = (_HEIGHT - 8) / (high - low)

    def y(values: Array) -> Array:
        return top + _HEIGHT - 4 - (np.clip(values, low, high) - low) * scale

    ticks = nice(low, high)
    body = [f'<g fill="none" stroke="#dddddd">{"".join(_across(left, inner, y, v) for v in ticks)}</g>']
    body += [
        text_at(left - 6, float(y(np.array(value))) + 4, text, "end", QUIET)
        for value, text in zip(ticks, numbers.apart(ticks), strict=True)
    ]
    at = left + 6 if slim else 4.0
    body.append(text_at(at, top + 14, panel.name if not slim else f"{panel.name} [{panel.unit}]", bold=True))
    if not slim:
        body.append(text_at(4, top + 29, panel.unit, colour=QUIET))
    frame = f'x="{left}" y="{top:.1f}" width="{inner:.1f}" height="{_HEIGHT}"'
    body.append(f'<rect {frame} fill="none" stroke="#999999"/>')
    columns = panel.columns
    x = left + inner * (columns.time_s - span[0]) / span[1]
    for part in _unbroken(columns.mean):
        upper = _points(x[part], y(columns.highest[part]))
        lower = _points(x[part][::-1], y(columns.lowest[part][::-1]))
        body.append(f'<polygon points="{upper} {lower}" fill="{PALE}" fill-opacity="0.5" stroke="none"/>')
        line = _points(x[part], y(columns.mean[part]))
        body.append(f'<polyline points="{line}" fill="none" stroke="{POINT}" stroke-width="0.9"/>')
    if low < 0.0 < high:
        body.append(f'<g fill="none" stroke="{INK}">{_across(left, inner, y, 0.0)}</g>')
    if panel.level is not None:
        level = _across(left, inner, y, panel.level)
        body.append(
            f'<g fill="none" stroke="{WARNING}" stroke-width="1.6" stroke-dasharray="6 4">{level}</g>'
        )
    beyond = _beyond(columns, low, high)
    if beyond:
        body.append(text_at(left + inner - 6, top + 14, beyond, "end", WARNING, size=11))
    return body


def _range(panel: Band) -> tuple[float, float]:
    """What a panel shows: the bulk of the columns, 0 and the level, with room."""
    columns = panel.columns
    there = np.isfinite(columns.mean)
    ends = [0.0] + ([] if panel.level is None else [panel.level])
    if there.any():
        ends += [
            float(np.percentile(columns.lowest[there], _BEYOND)),
            float(np.percentile(columns.highest[there], 100 - _BEYOND)),
        ]
    low, high = min(ends), max(ends)
    room = _ROOM * (high - low) or 1.0
    return low - room, high + room


def _across(left: float, inner: float, y: Callable[[Array], Array], value: float) -> str:
    return f'<path d="M{left},{float(y(np.array(value))):.1f}h{inner:.1f}"/>'


def _points(x: Array, y: Array) -> str:
    return " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True))


def _unbroken(values: Array) -> list[slice]:
    """Stretches without NaN."""
    there = np.concatenate(([False], np.isfinite(values), [False]))
    edges = np.flatnonzero(np.diff(there.astype(int)))
    return [slice(a, b) for a, b in zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)]


def _beyond(columns: Columns, low: float, high: float) -> str:
    """How many columns reach beyond the panel, and how far."""
    said = []
    for arrow, part, sign, edge in (("▲", columns.highest, 1.0, high), ("▼", columns.lowest, -1.0, low)):
        outside = sign * part > sign * edge
        if outside.any():
            furthest = sign * float(np.max(sign * part[outside]))
            said.append(f"{arrow} {int(outside.sum())} beyond, to {numbers.number(furthest, 3)}")
    return "  ".join(said)
