"""Small figures as SVG text: traces, bars and a map, drawn without a plotting library so that a page costs
nothing.
"""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

BEFORE, AFTER, QUIET, FRAME = "#a3123a", "#1d4f80", "#5f5f5f", "#999999"
_WIDTH, _LEFT, _RIGHT = 900, 90, 12
_PANEL = 110
_EMPTY = "#eeeeee"
_NARROW = 60  # a cell that has no room for words
_POINTS = 360  # of a whole trace: what is between them is averaged, so that noise hides less


def _text(
    x: float, y: float, text: str, anchor: str = "start", colour: str = "#222222", size: int = 12
) -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}" font-size="{size}">'
        f"{escape(text)}</text>"
    )


def _svg(height: float, body: Sequence[str], label: str) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height:.0f}" role="img" '
        f'aria-label="{escape(label)}" font-family="sans-serif" font-size="12">'
        f'<rect width="{_WIDTH}" height="{height:.0f}" fill="white"/>' + "".join(body) + "</svg>\n"
    )


def traces(
    panels: Sequence[tuple[str, Array | None, Array | None]],
    runs: Sequence[tuple[str, int]],
    unit: str,
    label: str,
) -> str:
    """Panels one above the other, each with what was before and what is after.

    Parameters
    ----------
    panels : sequence of (name, before (N,) or None, after (N,) or None)
        None: that line is not drawn.
    runs : sequence of (name, points)
        Runs one after the other; their points sum to N.
    unit : str
    label : str
        What the figure shows, for who cannot see it.
    """
    body, top, inner = [], 26.0, _WIDTH - _LEFT - _RIGHT
    before_too = any(before is not None for _, before, _ in panels)
    changed = any(after is not None for _, _, after in panels)
    if before_too:
        body.append(_text(_LEFT, 16, "before" if changed else "measured less predicted", colour=BEFORE))
    if changed:
        body.append(
            _text(_LEFT + 60 * before_too, 16, "after: the causes are in the simulator", colour=AFTER)
        )
    body.append(_text(_WIDTH - _RIGHT, 16, unit, "end", QUIET))
    counts = [count for _, count in runs]
    ends = np.cumsum([0, *counts])
    step = max(1, int(ends[-1]) // _POINTS)
    for name, before, after in panels:
        lines = [
            (values, colour) for values, colour in ((before, BEFORE), (after, AFTER)) if values is not None
        ]
        drawn = [(_parts(values, ends, step), colour) for values, colour in lines]
        largest = (
            max((float(np.max(np.abs(y))) for parts, _ in drawn for _, y in parts), default=0.0) or 1e-12
        )
        middle, scale = top + (_PANEL - 8) / 2.0, ((_PANEL - 8) / 2.0 - 5.0) / largest
        body.append(
            f'<rect x="{_LEFT}" y="{top:.1f}" width="{inner}" height="{_PANEL - 8}" '
            f'fill="none" stroke="{FRAME}"/>'
        )
        body.append(
            f'<line x1="{_LEFT}" x2="{_LEFT + inner}" y1="{middle:.1f}" y2="{middle:.1f}" stroke="#cccccc"/>'
        )
        body.append(_text(8, middle + 4, name))
        for value, height in ((largest, top + 12), (0.0, middle + 4), (-largest, top + _PANEL - 12)):
            body.append(_text(_LEFT - 4, height, f"{value:.2g}", "end", QUIET, 10))
        for parts, colour in drawn:
            for x, y in parts:
                across = _LEFT + inner * x / max(int(ends[-1]), 1)
                points = " ".join(f"{a:.1f},{middle - scale * b:.1f}" for a, b in zip(across, y, strict=True))
                body.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.2"/>')
        top += _PANEL
    for (name, _), start in zip(runs, ends[:-1].tolist(), strict=True):
        at = float(_LEFT + inner * start / max(int(ends[-1]), 1))
        body.append(
            f'<line x1="{at:.1f}" x2="{at:.1f}" y1="26" y2="{top - 8:.1f}" '
            'stroke="#bbbbbb" stroke-dasharray="3 3"/>'
        )
        body.append(_text(at + 3, top + 6, name, colour=QUIET, size=11))
    return _svg(top + 14, body, label)


def _parts(values: Array, ends: NDArray[np.int_], step: int) -> list[tuple[Array, Array]]:
    """Positions and means of each run's points, so many together; no line runs from one run to the next."""
    out = []
    for start, end in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
        size = min(step, max(end - start, 1))
        whole = (end - start) // size * size
        y = values[start : start + whole].reshape(-1, size).mean(axis=1)
        out.append((start + size * (np.arange(len(y)) + 0.5), y))
    return [part for part in out if len(part[1])]


def bars(
    rows: Sequence[tuple[str, float, str]], label: str, colour: str = AFTER, whole: float | None = None
) -> str:
    """Horizontal bars from 0: (name, length, what stands behind it); `whole`: what a full bar is.

    Negative lengths are drawn as none.
    """
    largest = whole or max([abs(length) for _, length, _ in rows] or [1.0]) or 1.0
    left, body = 360, []
    room = _WIDTH - left - 150
    for k, (name, length, text) in enumerate(rows):
        y = 8 + 26 * k
        width = min(max(length, 0.0) / largest, 1.0) * room
        body.append(_text(left - 8, y + 14, name, "end"))
        if whole:
            body.append(f'<rect x="{left}" y="{y}" width="{room}" height="18" fill="{_EMPTY}"/>')
        body.append(f'<rect x="{left}" y="{y}" width="{max(width, 1.0):.1f}" height="18" fill="{colour}"/>')
        body.append(_text(left + (room if whole else max(width, 1.0)) + 6, y + 14, text, colour=QUIET))
    return _svg(16 + 26 * len(rows), body, label)


def grid(
    rows: Sequence[str], columns: Sequence[str], values: Array, words: Sequence[Sequence[str]], label: str
) -> str:
    """A map: cells (rows, columns), the darker the larger, with number and word in them; 0 is empty."""
    room = _WIDTH - _LEFT - _RIGHT
    width, height = room / max(len(columns), 1), 34
    top = max(float(np.max(values)), 5.0)
    body = []
    for c, name in enumerate(columns):
        body.append(_text(_LEFT + width * (c + 0.5), 16, name, "middle", QUIET, 11))
    for r, name in enumerate(rows):
        y = 24 + height * r
        body.append(_text(_LEFT - 8, y + 21, name, "end"))
        for c in range(len(columns)):
            value, x = float(values[r, c]), _LEFT + width * c
            deep = float(np.log(max(value, 4.0) / 4.0)) / max(float(np.log(top / 4.0)), 0.5)
            shade = 0.25 + 0.75 * min(deep, 1.0) if value > 0.0 else 1.0
            fill = BEFORE if value > 0.0 else _EMPTY
            body.append(
                f'<rect x="{x:.1f}" y="{y}" width="{width - 2:.1f}" height="{height - 2}" '
                f'fill="{fill}" fill-opacity="{shade:.2f}"/>'
            )
            if value > 0.0 and width > _NARROW:
                ink = "#ffffff" if shade > 0.6 else "#222222"
                body.append(_text(x + width / 2, y + 14, f"{value:.3g} sigma", "middle", ink, 11))
                body.append(_text(x + width / 2, y + 27, words[r][c], "middle", ink, 10))
    return _svg(30 + height * len(rows), body, label)
