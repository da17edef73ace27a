"""Small figures as SVG text: traces and bars, drawn without a plotting library so that a page costs
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
_MOST_POINTS = 900


def _text(x: float, y: float, text: str, anchor: str = "start", colour: str = "#222222") -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}">{escape(text)}</text>'


def _svg(height: float, body: Sequence[str], label: str) -> str:
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height:.0f}" role="img" '
        f'aria-label="{escape(label)}" font-family="sans-serif" font-size="12">'
        f'<rect width="{_WIDTH}" height="{height:.0f}" fill="white"/>' + "".join(body) + "</svg>\n"
    )


def traces(
    panels: Sequence[tuple[str, Array, Array]], marks: Sequence[tuple[float, str]], unit: str, label: str
) -> str:
    """Panels one above the other, each with what was before and what is after.

    Parameters
    ----------
    panels : sequence of (name, before (N,), after (N,))
    marks : sequence of (position from 0 to 1, name)
        Where runs begin along the horizontal axis.
    unit : str
    label : str
        What the figure shows, for who cannot see it.
    """
    body, top = [], 26.0
    inner = _WIDTH - _LEFT - _RIGHT
    body.append(_text(_LEFT, 16, "before", colour=BEFORE) + _text(_LEFT + 60, 16, "after", colour=AFTER))
    body.append(_text(_WIDTH - _RIGHT, 16, unit, "end", QUIET))
    for name, before, after in panels:
        largest = max(
            float(np.max(np.abs(before), initial=0.0)), float(np.max(np.abs(after), initial=0.0)), 1e-12
        )
        middle, scale = top + _PANEL / 2.0, (_PANEL / 2.0 - 6.0) / largest
        body.append(
            f'<rect x="{_LEFT}" y="{top:.1f}" width="{inner}" height="{_PANEL - 8}" '
            f'fill="none" stroke="{FRAME}"/>'
        )
        body.append(
            f'<line x1="{_LEFT}" x2="{_LEFT + inner}" y1="{middle:.1f}" y2="{middle:.1f}" stroke="#dddddd"/>'
        )
        body.append(_text(8, middle + 4, name) + _text(_LEFT - 4, top + 12, f"{largest:.2g}", "end", QUIET))
        for values, colour in ((before, BEFORE), (after, AFTER)):
            step = max(1, len(values) // _MOST_POINTS)
            level = values[: len(values) // step * step].reshape(-1, step).mean(axis=1)
            x = _LEFT + inner * (np.arange(len(level)) + 0.5) / max(len(level), 1)
            points = " ".join(f"{a:.1f},{middle - scale * b:.1f}" for a, b in zip(x, level, strict=True))
            body.append(f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="0.8"/>')
        top += _PANEL
    for position, name in marks:
        at = float(_LEFT + inner * position)
        body.append(
            f'<line x1="{at:.1f}" x2="{at:.1f}" y1="26" y2="{top - 8:.1f}" '
            'stroke="#bbbbbb" stroke-dasharray="3 3"/>'
        )
        body.append(_text(at + 3, top + 6, name, colour=QUIET))
    return _svg(top + 14, body, label)


def bars(rows: Sequence[tuple[str, float, str]], label: str, colour: str = AFTER) -> str:
    """Horizontal bars from 0: (name, length, what stands behind it); negative lengths are drawn as none."""
    largest = max([abs(length) for _, length, _ in rows] or [1.0]) or 1.0
    left, body = 330, []
    for k, (name, length, text) in enumerate(rows):
        y = 8 + 26 * k
        width = max(length, 0.0) / largest * (_WIDTH - left - 200)
        body.append(_text(left - 8, y + 14, name, "end"))
        body.append(f'<rect x="{left}" y="{y}" width="{max(width, 1.0):.1f}" height="18" fill="{colour}"/>')
        body.append(_text(left + max(width, 1.0) + 6, y + 14, text, colour=QUIET))
    return _svg(16 + 26 * len(rows), body, label)
