"""What every figure shares: its frame, its text, its ticks, and the widths that it is drawn for."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from html import escape

from markupsafe import Markup

from fogreduce.pages import numbers

INK, POINT, PALE, QUIET, WARNING = "#222222", "#1d4f80", "#86a3c3", "#5f5f5f", "#a3123a"
EMPTY = "#eeeeee"
WIDTH, LEFT, RIGHT, TOP = 960, 128, 14, 10
GAP = 14
#: Widths of traces, bars and maps, for a screen and for a phone held upright.
WIDE, SLIM = 900, 366
#: What was before and what is after.
BEFORE, AFTER = WARNING, POINT
LETTER = 6.5  # room that a letter takes

#: A value's height in a panel [px].
Place = Callable[[float], float]


def whole(height: float, body: Sequence[str], label: str, width: float = WIDTH) -> Markup:
    """A figure, as wide as a page unless said otherwise, which says what it shows."""
    return Markup(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height:.0f}" role="img" '
        f'aria-label="{escape(label)}" font-family="sans-serif" font-size="12">' + "".join(body) + "</svg>"
    )


def stand_alone(height: float, body: Sequence[str], label: str, width: float) -> str:
    """A figure that is a file too: on white."""
    ground = f'<rect width="{width}" height="{height:.0f}" fill="white"/>'
    return str(whole(height, [ground, *body], label, width)) + "\n"


def text_at(
    x: float,
    y: float,
    text: str,
    anchor: str = "start",
    colour: str = INK,
    *,
    bold: bool = False,
    size: int = 0,
) -> str:
    """A line of text at a place [px], escaped."""
    more = ' font-weight="bold"' if bold else ""
    more += f' font-size="{size}"' if size else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}"{more}>{escape(text)}</text>'


def nice(low: float, high: float) -> list[float]:
    """Round numbers between two, two to five of them."""
    raw = (high - low) / 5
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= raw)
    first = math.ceil(low / step)
    return [k * step for k in range(first, math.floor(high / step) + 1)]


def plain(value: float, digits: int = 2) -> str:
    """So many digits, without a power of ten where there is room for the zeros."""
    rounded = float(f"{value:.{digits}g}")
    return numbers.number(rounded, 6)
