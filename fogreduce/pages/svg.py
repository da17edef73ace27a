"""Figures of pages as SVG text, drawn without a plotting library: points with error bars, traces, bars, maps.

Traces, bars and maps take the width that they are drawn for: `WIDE`, or `SLIM` for a phone, on which a wide
figure's words could not be read.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from fogreduce.pages import numbers

Array = NDArray[np.float64]

INK, POINT, PALE, QUIET, WARNING = "#222222", "#1d4f80", "#86a3c3", "#5f5f5f", "#a3123a"
#: Of shares: dark and light in turn, told apart without colour too.
_SHARES = ("#1d4f80", "#d9a441", "#7a2048", "#9ac1b5", "#3f3f3f", "#c9c9c9")
_WIDTH, _LEFT, _RIGHT, _TOP = 960, 128, 14, 10
_GAP = 14
#: Values beyond so many times the scatter of the rest do not set the scale: they stand at the panel's edge.
_FAR = 12.0
#: Among more points than these, error bars step back.
_MANY = 200
#: Widths of traces, bars and maps, for a screen and for a phone held upright.
WIDE, SLIM = 900, 366
#: What was before and what is after.
BEFORE, AFTER = WARNING, POINT
_PANEL, _EMPTY = 110.0, "#eeeeee"
_MOST_POINTS = 360  # of a whole trace: what is between them is averaged, so that noise hides less
_LETTER = 6.5  # room that a letter takes


Place = Callable[[float], float]


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
        Whether each point carries its entry's number, by which the page's script finds it.
    """
    size = max((len(panel.values) for panel in panels), default=0)
    inner = _WIDTH - _LEFT - _RIGHT
    step = inner / max(size, 1)
    radius = max(1.4, min(4.0, 0.42 * step))
    body, top = [], float(_TOP)
    for panel in panels:
        body += _panel(panel, top, height, step, radius, absent, linked)
        top += height + _GAP
    for entry, text in ticks:
        x = _LEFT + (entry + 0.5) * step
        body.append(_text(min(max(x, _LEFT), _WIDTH - 40), top + 4, text, "middle", QUIET))
    return whole(top + 12, body, label)


def whole(height: float, body: Sequence[str], label: str, width: float = _WIDTH) -> Markup:
    """A figure, as wide as a page unless said otherwise, which says what it shows."""
    return Markup(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height:.0f}" role="img" '
        f'aria-label="{escape(label)}" font-family="sans-serif" font-size="12">' + "".join(body) + "</svg>"
    )


@dataclass(frozen=True)
class Bar:
    """A bar of shares: its name, what stands at its end, and the shares, which sum to 1."""

    name: str
    text: str
    shares: Mapping[str, float]


def shares(bars: Sequence[Bar], label: str) -> Markup:
    """Bars of equal length, one below the other, each cut into its shares; a legend of the parts below."""
    left, right, step = _LEFT + 60, 190, 24
    inner = _WIDTH - left - right
    names = [name for name in dict.fromkeys(name for bar in bars for name in bar.shares)]
    colours = dict(zip(names, _SHARES, strict=False))
    body = []
    for k, bar in enumerate(bars):
        top, x = _TOP + k * step, float(left)
        body.append(_text(left - 8, top + 13, bar.name, "end", INK))
        for name, share in bar.shares.items():
            width = share * inner
            if width >= 0.5:
                at = f'x="{x:.1f}" y="{top}" width="{width:.1f}"'
                body.append(f'<rect {at} height="17" fill="{colours[name]}"/>')
            x += width
        body.append(_text(_WIDTH - right + 8, top + 13, bar.text, "start", INK))
    below, each = _TOP + len(bars) * step + 8, (_WIDTH - 20) / max(len(names), 1)
    for k, name in enumerate(names):
        body.append(
            f'<rect x="{10 + k * each:.1f}" y="{below}" width="12" height="12" fill="{colours[name]}"/>'
        )
        body.append(_text(28 + k * each, below + 11, name, "start", INK))
    return whole(below + 22, body, label)


def some_ticks(names: Sequence[str], most: int = 8) -> list[tuple[int, str]]:
    """Entries to be named below an axis: all of a few, a few of many."""
    if len(names) <= most:
        return list(enumerate(names))
    step = math.ceil(len(names) / most)
    return [(entry, names[entry]) for entry in range(0, len(names), step)]


def _panel(
    panel: Panel, top: float, height: float, step: float, radius: float, absent: Sequence[int], linked: bool
) -> list[str]:
    low, high = _span(panel)
    scale = (height - 12) / (high - low)

    def y(value: float) -> float:
        return top + height - 6 - (value - low) * scale

    inner = _WIDTH - _LEFT - _RIGHT
    body = [f'<g fill="none" stroke="#dddddd">{_grid(low, high, y)}</g>']
    ticks = _nice(low, high)
    body += [
        _text(_LEFT - 6, y(value) + 4, text, "end", QUIET)
        for value, text in zip(ticks, numbers.apart(ticks), strict=True)
    ]
    body.append(_text(4, top + 12, panel.name, colour=INK, bold=True))
    body.append(_text(4, top + 27, panel.unit, colour=QUIET))
    body.append(
        f'<rect x="{_LEFT}" y="{top:.1f}" width="{inner}" height="{height:.1f}" '
        'fill="none" stroke="#999999"/>'
    )
    if panel.limits:
        body.append(_band(panel.limits, y, top, height, step))
    if panel.centre is not None and low <= panel.centre <= high:
        line = f"M{_LEFT},{y(panel.centre):.1f}H{_WIDTH - _RIGHT}"
        body.append(f'<path d="{line}" stroke="{INK}"/>')
    marks: dict[str, list[str]] = {"in": [], "out": [], "absent": []}
    for entry, value in enumerate(panel.values):
        if value is not None:
            kind = "out" if entry in panel.out else "in"
            path = _point(panel, entry, value, (low, high), y, step, radius)
            marks[kind].append(_path(path, entry, linked))
    for entry in absent:
        x, at = _LEFT + (entry + 0.5) * step, top + height - 8
        marks["absent"].append(_path(_cross(x, at, max(2.0, radius)), entry, linked))
    bars = POINT if len(panel.values) <= _MANY else PALE
    body.append(f'<g fill="{POINT}" stroke="{bars}">{"".join(marks["in"])}</g>')
    body.append(f'<g fill="#ffffff" stroke="{WARNING}" stroke-width="2">{"".join(marks["out"])}</g>')
    body.append(f'<g fill="none" stroke="{QUIET}" stroke-width="1.5">{"".join(marks["absent"])}</g>')
    return body


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
    x = _LEFT + (entry + 0.5) * step
    if not span[0] <= value <= span[1]:
        up = value > span[1]
        at, way = (y(span[1]), -1.0) if up else (y(span[0]), 1.0)
        w = radius + 1.0
        return f"M{x - w:.1f},{at:.1f}h{2 * w:.1f}l{-w:.1f},{1.6 * w * way:.1f}z"
    ends = _ends(panel, entry, value)
    bar = ""
    if ends is not None:
        low, high = (y(min(max(end, span[0]), span[1])) for end in ends)
        bar = f"M{x:.1f},{low:.1f}V{high:.1f}"
    if entry in panel.out:
        d = radius + 1.5  # a diamond: the shape says it without the colour
        return f"{bar}M{x - d:.1f},{y(value):.1f}l{d:.1f},{-d:.1f}l{d:.1f},{d:.1f}l{-d:.1f},{d:.1f}z"
    r = f"{radius:.1f}"
    half = f"a{r},{r} 0 1 0"
    return f"{bar}M{x - radius:.1f},{y(value):.1f}{half} {2 * radius:.1f},0{half} {-2 * radius:.1f},0"


def _ends(panel: Panel, entry: int, value: float) -> tuple[float, float] | None:
    if panel.lows:
        low, high = panel.lows[entry], panel.highs[entry]
        return None if low is None or high is None else (low, high)
    error = panel.errors[entry] if panel.errors else None
    return None if error is None else (value - error, value + error)


def _cross(x: float, y: float, r: float) -> str:
    return f"M{x - r:.1f},{y - r:.1f}l{2 * r:.1f},{2 * r:.1f}m0,{-2 * r:.1f}l{-2 * r:.1f},{2 * r:.1f}"


def _path(path: str, entry: int, linked: bool) -> str:
    return f'<path d="{path}" data-r="{entry}"/>' if linked else f'<path d="{path}"/>'


def _band(limits: Sequence[tuple[float, float]], y: Place, top: float, height: float, step: float) -> str:
    """Lower and upper limit as steps, dashed where there are few, cut at the panel's edge."""
    lines = []
    dashes = ' stroke-dasharray="5 3"' if len(limits) <= _MANY else ' stroke-opacity="0.45"'
    for side in (0, 1):
        path = ""
        for entry, pair in enumerate(limits):
            at = min(max(y(pair[side]), top), top + height)
            path += f"{'M' if not path else 'L'}{_LEFT + entry * step:.1f},{at:.1f}h{step:.1f}"
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
        for end in _ends(panel, entry, value) or (value,)
    ]
    if panel.zero:
        ends.append(0.0)
    if panel.limits and len(values) > 1:
        wide = [edge for pair in panel.limits for edge in pair]
        ends += [sorted(wide)[len(wide) // 10], sorted(wide)[-1 - len(wide) // 10]]
    low, high = min(ends), max(ends)
    room = 0.06 * (high - low) or 0.1 * abs(high) or 1.0
    return low - room, high + room


def _nice(low: float, high: float) -> list[float]:
    """Round numbers between two, two to five of them."""
    raw = (high - low) / 5
    power = 10.0 ** math.floor(math.log10(raw))
    step = next(factor * power for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= raw)
    first = math.ceil(low / step)
    return [k * step for k in range(first, math.floor(high / step) + 1)]


def _grid(low: float, high: float, y: Place) -> str:
    return "".join(f'<path d="M{_LEFT},{y(v):.1f}H{_WIDTH - _RIGHT}"/>' for v in _nice(low, high))


def _text(
    x: float,
    y: float,
    text: str,
    anchor: str = "start",
    colour: str = INK,
    *,
    bold: bool = False,
    size: int = 0,
) -> str:
    more = ' font-weight="bold"' if bold else ""
    more += f' font-size="{size}"' if size else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="{colour}"{more}>{escape(text)}</text>'


def _stand_alone(height: float, body: Sequence[str], label: str, width: float) -> str:
    """A figure that is a file too: on white."""
    ground = f'<rect width="{width}" height="{height:.0f}" fill="white"/>'
    return str(whole(height, [ground, *body], label, width)) + "\n"


def _plain(value: float, digits: int = 2) -> str:
    """So many digits, without a power of ten where there is room for the zeros."""
    rounded = float(f"{value:.{digits}g}")
    return numbers.number(rounded, 6)


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
    body = [_text(width - right, 16, unit, "end", QUIET)]
    if before_too:
        body.append(_text(left, 16, "before" if changed else "measured less predicted", colour=BEFORE))
    if changed:
        body.append(_text(left + 50 * before_too, 16, "after: causes in the simulator", colour=AFTER))
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
            body.append(_text(at + 3, top + 6, name, colour=QUIET, size=11))
            room = at + 9 + _LETTER * len(name)
    return _stand_alone(top + 14, body, label, width)


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
        _text(left + 6 if left < 60 else 8, top + 14 if left < 60 else middle + 4, name),
    ]
    for value, height in ((largest, top + 12), (0.0, middle + 4), (-largest, top + _PANEL - 12)):
        body.append(_text(left - 4, height, _plain(value), "end", QUIET, size=10))
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
    slim = width <= 2 * SLIM
    left, step, low, body = (0.0, 46, 20, []) if slim else (360.0, 26, 0, [])
    room = width - left - (0 if slim else 150)
    for k, (name, length, text) in enumerate(rows):
        y = 8 + step * k
        long = max(min(max(length, 0.0) / largest, 1.0) * room, 1.0)
        body.append(_text(*((0, y + 14, name) if slim else (left - 8, y + 14, name, "end"))))
        if full:
            body.append(f'<rect x="{left}" y="{y + low}" width="{room}" height="18" fill="{_EMPTY}"/>')
        body.append(f'<rect x="{left}" y="{y + low}" width="{long:.1f}" height="18" fill="{colour}"/>')
        if slim:
            body.append(_text(width, y + 14, text, "end", QUIET))
        else:
            body.append(_text(left + (room if full else long) + 6, y + 14, text, colour=QUIET))
    return _stand_alone(16 + step * len(rows), body, label, width)


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
        middle, half = left + wide * (c + 0.5), 0.5 * _LETTER * len(name)
        if middle - half >= room:
            body.append(_text(middle, 16, name, "middle", QUIET, size=11))
            room = middle + half + 4
    for r, name in enumerate(rows):
        y = 24 + high * r
        body.append(_text(left - 6, y + 21, name, "end"))
        for c in range(len(columns)):
            value, x = float(values[r, c]), left + wide * c
            deep = math.log(max(value, 4.0) / 4.0) / max(math.log(top / 4.0), 0.5)
            shade = 0.25 + 0.75 * min(deep, 1.0) if value > 0.0 else 1.0
            fill, place = (BEFORE if value > 0.0 else _EMPTY), f'x="{x:.1f}" y="{y}" width="{wide - 2:.1f}"'
            body.append(f'<rect {place} height="{high - 2}" fill="{fill}" fill-opacity="{shade:.2f}"/>')
            if value > 0.0:
                ink = "#ffffff" if shade > 0.6 else INK
                lines = [(_plain(value, 3), 20), ("", 0)]
                if _LETTER * len(words[r][c]) < wide:
                    lines = [(f"{_plain(value, 3)} sigma", 14), (words[r][c], 27)]
                body += [
                    _text(x + wide / 2, y + down, text, "middle", ink, size=11)
                    for text, down in lines
                    if text and _LETTER * len(text) < wide + 6
                ]
    return _stand_alone(30 + high * len(rows), body, label, width)
