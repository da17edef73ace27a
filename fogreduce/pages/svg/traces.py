"""Records of several runs one after the other: what was before and what is after."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fogreduce.pages.svg.frame import AFTER, BEFORE, LETTER, QUIET, SLIM, WIDE, plain, stand_alone, text_at

Array = NDArray[np.float64]

_PANEL = 110.0
_MOST_POINTS = 360  # of a whole trace: what is between them is averaged, so that noise hides less


def traces(
    panels: Sequence[tuple[str, Array | None, Array | None]],
    runs: Sequence[tuple[str, int]],
    unit: str,
    label: str,
    width: float = WIDE,
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
    width : float
    """
    left, right = (90.0, 12.0) if width > 2 * SLIM else (44.0, 6.0)
    inner, top = width - left - right, 26.0
    before_too = any(before is not None for _, before, _ in panels)
    changed = any(after is not None for _, _, after in panels)
    body = [text_at(width - right, 16, unit, "end", QUIET)]
    if before_too:
        body.append(text_at(left, 16, "before" if changed else "measured less predicted", colour=BEFORE))
    if changed:
        body.append(text_at(left + 50 * before_too, 16, "after: causes in the simulator", colour=AFTER))
    ends = np.cumsum([0, *(count for _, count in runs)])
    whole_run = max(int(ends[-1]), 1)
    for name, before, after in panels:
        lines = [(values, ink) for values, ink in ((before, BEFORE), (after, AFTER)) if values is not None]
        drawn = [(_means(values, ends), ink) for values, ink in lines]
        body += _trace(name, drawn, (left, top, inner), whole_run)
        top += _PANEL
    room = -1.0
    for (name, _), start in zip(runs, ends[:-1].tolist(), strict=True):
        at = left + inner * start / whole_run
        body.append(f'<path d="M{at:.1f},26V{top - 8:.1f}" stroke="#bbbbbb" stroke-dasharray="3 3"/>')
        if at >= room:  # where names would run into each other, some are left out
            body.append(text_at(at + 3, top + 6, name, colour=QUIET, size=11))
            room = at + 9 + LETTER * len(name)
    return stand_alone(top + 14, body, label, width)


def _trace(
    name: str,
    drawn: Sequence[tuple[list[tuple[Array, Array]], str]],
    place: tuple[float, float, float],
    whole_run: int,
) -> list[str]:
    """One panel of `traces`, its frame, scale and lines; `place`: left, top and inner width."""
    left, top, inner = place
    largest = max((float(np.max(np.abs(y))) for parts, _ in drawn for _, y in parts), default=0.0) or 1e-12
    middle, scale = top + (_PANEL - 8) / 2.0, ((_PANEL - 8) / 2.0 - 5.0) / largest
    body = [
        f'<rect x="{left}" y="{top:.1f}" width="{inner}" height="{_PANEL - 8}" fill="none" '
        'stroke="#999999"/>',
        f'<path d="M{left},{middle:.1f}h{inner}" stroke="#cccccc"/>',
        text_at(left + 6 if left < 60 else 8, top + 14 if left < 60 else middle + 4, name),
    ]
    for value, height in ((largest, top + 12), (0.0, middle + 4), (-largest, top + _PANEL - 12)):
        body.append(text_at(left - 4, height, plain(value), "end", QUIET, size=10))
    for parts, ink in drawn:
        for x, y in parts:
            across = left + inner * x / whole_run
            points = " ".join(f"{a:.1f},{middle - scale * b:.1f}" for a, b in zip(across, y, strict=True))
            body.append(f'<polyline points="{points}" fill="none" stroke="{ink}" stroke-width="1.2"/>')
    return body


def _means(values: Array, ends: NDArray[np.int_]) -> list[tuple[Array, Array]]:
    """Positions and means of each run's points, so many together; no line runs from one run to the next."""
    step, out = max(1, int(ends[-1]) // _MOST_POINTS), []
    for start, end in zip(ends[:-1].tolist(), ends[1:].tolist(), strict=True):
        size = min(step, max(end - start, 1))
        last = start + (end - start) // size * size
        y = values[start:last].reshape(-1, size).mean(axis=1)
        out.append((start + size * (np.arange(len(y)) + 0.5), y))
    return [part for part in out if len(part[1])]
