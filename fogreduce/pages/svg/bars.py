"""Bars of shares, bars of lengths, and maps."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from fogreduce.pages.svg.frame import (
    AFTER,
    BEFORE,
    EMPTY,
    INK,
    LEFT,
    LETTER,
    QUIET,
    SLIM,
    TOP,
    WIDE,
    WIDTH,
    plain,
    stand_alone,
    text_at,
    whole,
)

Array = NDArray[np.float64]

#: Of shares: dark and light in turn, told apart without colour too.
_SHARES = ("#1d4f80", "#d9a441", "#7a2048", "#9ac1b5", "#3f3f3f", "#c9c9c9")


@dataclass(frozen=True)
class Bar:
    """A bar of shares: its name, what stands at its end, and the shares, which sum to 1."""

    name: str
    text: str
    shares: Mapping[str, float]


def shares(bars: Sequence[Bar], label: str) -> Markup:
    """Bars of equal length, one below the other, each cut into its shares; a legend of the parts below."""
    left, right, step = LEFT + 60, 190, 24
    inner = WIDTH - left - right
    names = [name for name in dict.fromkeys(name for bar in bars for name in bar.shares)]
    colours = dict(zip(names, _SHARES, strict=False))
    body = []
    for k, bar in enumerate(bars):
        top, x = TOP + k * step, float(left)
        body.append(text_at(left - 8, top + 13, bar.name, "end", INK))
        for name, share in bar.shares.items():
            width = share * inner
            if width >= 0.5:
                at = f'x="{x:.1f}" y="{top}" width="{width:.1f}"'
                body.append(f'<rect {at} height="17" fill="{colours[name]}"/>')
            x += width
        body.append(text_at(WIDTH - right + 8, top + 13, bar.text, "start", INK))
    below, each = TOP + len(bars) * step + 8, (WIDTH - 20) / max(len(names), 1)
    for k, name in enumerate(names):
        body.append(
            f'<rect x="{10 + k * each:.1f}" y="{below}" width="12" height="12" fill="{colours[name]}"/>'
        )
        body.append(text_at(28 + k * each, below + 11, name, "start", INK))
    return whole(below + 22, body, label)


def bars(
    rows: Sequence[tuple[str, float, str]],
    label: str,
    colour: str = AFTER,
    full: float | None = None,
    width: float = WIDE,
) -> str:
    """Horizontal bars from 0: (name, length, what stands behind it); `full`: what a full bar is.

    Negative lengths are drawn as none. In a slim figure names stand above their bars.
    """
    largest = full or max([abs(length) for _, length, _ in rows] or [1.0]) or 1.0
    each = [Step(name, text, 0.0, max(length, 0.0) / largest, colour) for name, length, text in rows]
    return steps(each, label, width, ground=full is not None)


@dataclass(frozen=True)
class Step:
    """A bar from `start` to `end`, of 1 at most: its name, what stands behind it, its colour."""

    name: str
    text: str
    start: float
    end: float
    colour: str


def steps(
    rows: Sequence[Step], label: str, width: float = WIDE, ground: bool = True, mark: float | None = None
) -> str:
    """Horizontal bars, each where it begins and ends, one below the other.

    In a slim figure names stand above their bars. `ground`: whether each stands on a pale bar of 1;
    `mark`: where a broken line crosses each.
    """
    slim = width <= 2 * SLIM
    left, step, low, body = (0.0, 46, 20, []) if slim else (360.0, 26, 0, [])
    room = width - left - (0 if slim else 150)
    for k, row in enumerate(rows):
        y = 8 + step * k
        start, end = (room * min(max(x, 0.0), 1.0) for x in sorted((row.start, row.end)))
        long = max(end - start, 1.0)
        body.append(text_at(*((0, y + 14, row.name) if slim else (left - 8, y + 14, row.name, "end"))))
        if ground:
            body.append(f'<rect x="{left}" y="{y + low}" width="{room}" height="18" fill="{EMPTY}"/>')
        bar = f'x="{left + min(start, room - long):.1f}" y="{y + low}" width="{long:.1f}"'
        body.append(f'<rect {bar} height="18" fill="{row.colour}"/>')
        if slim:
            body.append(text_at(width, y + 14, row.text, "end", QUIET))
        else:
            body.append(text_at(left + (room if ground else end) + 6, y + 14, row.text, colour=QUIET))
        if mark is not None:
            line = f"M{left + room * mark:.1f},{y + low - 4}v26"
            body.append(f'<path d="{line}" stroke="{INK}" stroke-dasharray="4 3"/>')
    return stand_alone(16 + step * len(rows), body, label, width)


def grid(
    rows: Sequence[str],
    columns: Sequence[str],
    values: Array,
    words: Sequence[Sequence[str]],
    label: str,
    width: float = WIDE,
) -> str:
    """A map: cells (rows, columns), the darker the larger, with number and word where they fit; 0: empty."""
    left = 90.0 if width > 2 * SLIM else 44.0
    wide, high = (width - left - 4) / max(len(columns), 1), 34
    top = max(float(np.max(values)), 5.0)
    body, room = [], -1.0
    for c, name in enumerate(columns):
        middle, half = left + wide * (c + 0.5), 0.5 * LETTER * len(name)
        if middle - half >= room:
            body.append(text_at(middle, 16, name, "middle", QUIET, size=11))
            room = middle + half + 4
    for r, name in enumerate(rows):
        y = 24 + high * r
        body.append(text_at(left - 6, y + 21, name, "end"))
        for c in range(len(columns)):
            value, x = float(values[r, c]), left + wide * c
            deep = math.log(max(value, 4.0) / 4.0) / max(math.log(top / 4.0), 0.5)
            shade = 0.25 + 0.75 * min(deep, 1.0) if value > 0.0 else 1.0
            fill, place = (BEFORE if value > 0.0 else EMPTY), f'x="{x:.1f}" y="{y}" width="{wide - 2:.1f}"'
            body.append(f'<rect {place} height="{high - 2}" fill="{fill}" fill-opacity="{shade:.2f}"/>')
            if value > 0.0:
                ink = "#ffffff" if shade > 0.6 else INK
                lines = [(plain(value, 3), 20), ("", 0)]
                if LETTER * len(words[r][c]) < wide:
                    lines = [(f"{plain(value, 3)} sigma", 14), (words[r][c], 27)]
                body += [
                    text_at(x + wide / 2, y + down, text, "middle", ink, size=11)
                    for text, down in lines
                    if text and LETTER * len(text) < wide + 6
                ]
    return stand_alone(30 + high * len(rows), body, label, width)
