"""Runs side by side as points with error bars, a panel a quantity; limits as bands."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

from markupsafe import Markup

from fogreduce.pages import numbers
from fogreduce.pages.svg.frame import (
    GAP,
    INK,
    LEFT,
    PALE,
    POINT,
    QUIET,
    RIGHT,
    TOP,
    WARNING,
    WIDTH,
    Place,
    nice,
    text_at,
    whole,
)

#: Values beyond so many times the scatter of the rest do not set the scale: they stand at the panel's edge.
_FAR = 12.0
#: Among more points than these, error bars step back.
_MANY = 200


@dataclass(frozen=True)
class Panel:
    """One panel; every list has an entry a run, None where there is none.

    Attributes
    ----------
    name, unit : str
    values, errors : list of float or None
        Points and half the length of their error bars.
    lows, highs : list of float or None
        In place of errors, the ends of the bars.
    centre : float or None
        A line across.
    limits : list of (low, high) or None
        A band about it, of its own width at each point.
    out : set of int
        Points to be marked as outside.
    zero : bool
        Whether 0 has a line and belongs into the panel.
    """

    name: str
    unit: str
    values: Sequence[float | None]
    errors: Sequence[float | None] = ()
    lows: Sequence[float | None] = ()
    highs: Sequence[float | None] = ()
    centre: float | None = None
    limits: Sequence[tuple[float, float]] | None = None
    out: frozenset[int] = field(default_factory=frozenset)
    zero: bool = False

    def ends(self, entry: int, value: float) -> tuple[float, float] | None:
        """Ends of an entry's bar; None where it has none."""
        if self.lows:
            low, high = self.lows[entry], self.highs[entry]
            return None if low is None or high is None else (low, high)
        error = self.errors[entry] if self.errors else None
        return None if error is None else (value - error, value + error)


def points(
    panels: Sequence[Panel],
    ticks: Sequence[tuple[int, str]],
    label: str,
    absent: Sequence[int] = (),
    height: float = 130.0,
    linked: bool = False,
) -> Markup:
    """Panels over a shared horizontal axis, the runs side by side in order.

    Parameters
    ----------
    panels : sequence of Panel
        All with the same number of entries.
    ticks : sequence of (entry, text)
        What stands below the axis.
    label : str
        What the figure says, for who cannot see it.
    absent : sequence of int
        Entries without any value, to be seen as such: runs that failed.
    height : float
        Of a panel [px].
    linked : bool
        Whether each group of points carries its entries' numbers, by which the page's script finds them.
    """
    size = max((len(panel.values) for panel in panels), default=0)
    inner = WIDTH - LEFT - RIGHT
    step = inner / max(size, 1)
    radius = max(1.5, min(4.0, 0.42 * step))
    body, top = [], float(TOP)
    # A run's marks in all panels are one path: a figure of a thousand runs stays small.
    marks: dict[str, dict[int, str]] = {"in": {}, "out": {}, "absent": {}}
    for panel in panels:
        body += _panel(panel, top, height, step)
        for kind, entry, path in _marks(panel, top, height, step, radius, absent):
            marks[kind][entry] = marks[kind].get(entry, "") + path
        top += height + GAP
    bars = POINT if size <= _MANY else PALE
    for kind, look in (
        ("in", f'fill="{POINT}" stroke="{bars}"'),
        ("out", f'fill="#ffffff" stroke="{WARNING}" stroke-width="2"'),
        ("absent", f'fill="none" stroke="{QUIET}" stroke-width="1.5"'),
    ):
        entries = f' data-r="{" ".join(map(str, marks[kind]))}"' if linked and marks[kind] else ""
        paths = "".join(f'<path d="{path}"/>' for path in marks[kind].values())
        body.append(f"<g {look}{entries}>{paths}</g>")
    for entry, text in ticks:
        x = LEFT + (entry + 0.5) * step
        body.append(text_at(min(max(x, LEFT), WIDTH - 40), top + 4, text, "middle", QUIET))
    return whole(top + 12, body, label)


def some_ticks(names: Sequence[str], most: int = 8) -> list[tuple[int, str]]:
    """Entries to be named below an axis: all of a few, a few of many."""
    if len(names) <= most:
        return list(enumerate(names))
    step = math.ceil(len(names) / most)
    return [(entry, names[entry]) for entry in range(0, len(names), step)]


def _panel(panel: Panel, top: float, height: float, step: float) -> list[str]:
    """Frame, scale, limits and centre of a panel."""
    low, high = _span(panel)
    y = _place(low, high, top, height)
    inner = WIDTH - LEFT - RIGHT
    body = [f'<g fill="none" stroke="#dddddd">{_grid(low, high, y)}</g>']
    ticks = nice(low, high)
    body += [
        text_at(LEFT - 6, y(value) + 4, text, "end", QUIET)
        for value, text in zip(ticks, numbers.apart(ticks), strict=True)
    ]
    body.append(text_at(4, top + 12, panel.name, colour=INK, bold=True))
    body.append(text_at(4, top + 27, panel.unit, colour=QUIET))
    body.append(
        f'<rect x="{LEFT}" y="{top:.1f}" width="{inner}" height="{height:.1f}" fill="none" stroke="#999999"/>'
    )
    if panel.limits:
        body.append(_band(panel.limits, y, top, height, step))
    if panel.centre is not None and low <= panel.centre <= high:
        line = f"M{LEFT},{y(panel.centre):.1f}H{WIDTH - RIGHT}"
        body.append(f'<path d="{line}" stroke="{INK}"/>')
    return body


def _place(low: float, high: float, top: float, height: float) -> Place:
    """Where a value stands in a panel that shows values from low to high."""
    scale = (height - 12) / (high - low)
    return lambda value: top + height - 6 - (value - low) * scale


def _marks(
    panel: Panel, top: float, height: float, step: float, radius: float, absent: Sequence[int]
) -> Iterator[tuple[str, int, str]]:
    """Each entry's mark in a panel: whether it is in, out or absent, the entry, and its path."""
    span = _span(panel)
    y = _place(*span, top, height)
    for entry, value in enumerate(panel.values):
        if value is not None:
            yield (
                "out" if entry in panel.out else "in",
                entry,
                _point(panel, entry, value, span, y, step, radius),
            )
    for entry in absent:
        x, at = LEFT + (entry + 0.5) * step, top + height - 8
        yield "absent", entry, _cross(x, at, max(2.0, radius))


def _point(
    panel: Panel,
    entry: int,
    value: float,
    span: tuple[float, float],
    y: Place,
    step: float,
    radius: float,
) -> str:
    """Error bar and marker as one path; a triangle at the edge for what lies beyond the panel."""
    x = LEFT + (entry + 0.5) * step
    if not span[0] <= value <= span[1]:
        up = value > span[1]
        at, way = (y(span[1]), -1.0) if up else (y(span[0]), 1.0)
        w = radius + 1.0
        return f"M{x - w:.1f},{at:.1f}h{2 * w:.1f}l{-w:.1f},{1.6 * w * way:.1f}z"
    ends = panel.ends(entry, value)
    bar, move, left, above = "", "M", 0.0, 0.0
    if ends is not None:
        low, high = (y(min(max(end, span[0]), span[1])) for end in ends)
        bar = f"M{_short(x)},{_short(low)}v{_short(high - low)}"
        move, left, above = "m", x, high  # on from the bar's upper end
    half = radius + 1.5 if entry in panel.out else radius
    start, at = f"{bar}{move}{_short(x - half - left)}", y(value) - above
    r, side = _short(half), _short(2 * half)
    if entry in panel.out:  # a diamond: the shape says it without the colour
        return f"{start},{_short(at)}l{r},-{r}l{r},{r}l-{r},{r}z"
    if len(panel.values) > _MANY:  # a square, which takes fewer letters than a circle
        return f"{start},{_short(at - half)}h{side}v{side}h-{side}z"
    return f"{start},{_short(at)}a{r},{r} 0 1 0 {side},0a{r},{r} 0 1 0 -{side},0"


def _short(value: float) -> str:
    """A length to a tenth of a pixel."""
    return f"{value:.1f}".removesuffix(".0")


def _cross(x: float, y: float, r: float) -> str:
    return f"M{x - r:.1f},{y - r:.1f}l{2 * r:.1f},{2 * r:.1f}m0,{-2 * r:.1f}l{-2 * r:.1f},{2 * r:.1f}"


def _band(limits: Sequence[tuple[float, float]], y: Place, top: float, height: float, step: float) -> str:
    """Lower and upper limit as steps, dashed where there are few, cut at the panel's edge."""
    lines = []
    dashes = ' stroke-dasharray="5 3"' if len(limits) <= _MANY else ' stroke-opacity="0.45"'
    for side in (0, 1):
        path = ""
        for entry, pair in enumerate(limits):
            at = min(max(y(pair[side]), top), top + height)
            path += f"{'M' if not path else 'L'}{LEFT + entry * step:.1f},{at:.1f}h{step:.1f}"
        lines.append(f'<path d="{path}" fill="none" stroke="{WARNING}"{dashes}/>')
    return "".join(lines)


def _span(panel: Panel) -> tuple[float, float]:
    """What the panel shows: every point but those far from all others, with room."""
    values = sorted(value for value in panel.values if value is not None)
    if not values:
        return (-1.0, 1.0)
    middle = values[len(values) // 2]
    scatter = sorted(abs(value - middle) for value in values)[len(values) // 2]
    shown = [v for v in values if len(values) < 5 or scatter == 0 or abs(v - middle) <= _FAR * scatter]
    ends = [
        end
        for entry, value in enumerate(panel.values)
        if value is not None and shown[0] <= value <= shown[-1]
        for end in panel.ends(entry, value) or (value,)
    ]
    if panel.zero:
        ends.append(0.0)
    if panel.limits and len(values) > 1:
        wide = [edge for pair in panel.limits for edge in pair]
        ends += [sorted(wide)[len(wide) // 10], sorted(wide)[-1 - len(wide) // 10]]
    low, high = min(ends), max(ends)
    room = 0.06 * (high - low) or 0.1 * abs(high) or 1.0
    return low - room, high + room


def _grid(low: float, high: float, y: Place) -> str:
    return "".join(f'<path d="M{LEFT},{y(v):.1f}H{WIDTH - RIGHT}"/>' for v in nice(low, high))
