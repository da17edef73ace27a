"""The frames of a run on the table (after the paper's figure 1): local, unit, Earth's rate, angle alpha."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from space import View, arc, arrow, between, blank

from fogreduce.physics.earth_rate import earth_rate_enu
from fogreduce.physics.frames import rotation, unit_from_enu
from fogreduce.plotting import style

Array = NDArray[np.float64]

LATITUDE_DEG = -23.21132308  # the published run's
ALPHA_DEG = 50.0

_UNIT = style.MEAN
_LOCAL = style.QUIET
_EARTH = style.CURVE


def draw() -> Figure:
    """Two views: from the side, and from above, the unit turned by alpha."""
    figure = Figure(figsize=(10.8, 5.0))
    figure.text(0.03, 0.965, "Frames of a run: x up, z north at alpha = 0", size=12, weight="bold", va="top")
    side, above = (figure.add_axes((left, 0.02, 0.46, 0.84)) for left in (0.03, 0.51))
    figure.text(0.03, 0.87, "seen from the east-south-east; latitude 23.2 deg south", size=9)
    figure.text(0.53, 0.87, "seen from above, x towards the reader", size=9)
    _draw_side(side)
    _draw_above(above)
    return figure


def _unit_axes() -> tuple[Array, Array]:
    """Unit axes (a row each) in east-north-up, at alpha = 0 and at `ALPHA_DEG`."""
    start = unit_from_enu({"x": "up", "z": "north"}, 0.0)
    return start, start @ rotation(start[0], np.radians(ALPHA_DEG)).T


def _draw_side(axes: Axes) -> None:
    blank(axes, 1.25, -0.75, 1.2)
    view = View(-33.0, 22.0)
    start, turned = _unit_axes()
    for direction, name in zip(np.eye(3), ("east", "north", "up"), strict=True):
        arrow(axes, view.on_paper(1.05 * direction), name, _LOCAL, width=1.0)
    for k, name in enumerate("xyz"):
        shift = (12.0, -8.0) if name == "x" else (0.0, 0.0)
        arrow(axes, view.on_paper(0.85 * turned[k]), name, _UNIT, width=2.2, shift=shift)
    earth = earth_rate_enu(LATITUDE_DEG)
    earth = earth / np.linalg.norm(earth)
    arrow(axes, view.on_paper(0.95 * earth), "Earth's rate W", _EARTH, width=2.2, shift=(0, -6))
    latitude = view.on_paper(between(np.array([0.0, 1.0, 0.0]), earth, 0.72))
    arc(axes, latitude, "latitude", _EARTH, head=False, shift=(30, 9))
    arc(axes, view.on_paper(between(start[1], turned[1], 0.6)), "alpha", _UNIT, shift=(4, -12))
    arc(axes, view.on_paper(between(start[2], turned[2], 0.6)), "alpha", _UNIT, shift=(14, 9))
    spin = np.radians(np.linspace(-100, 200, 60))
    ring = view.on_paper(np.array([0.12 * np.cos(spin), 0.12 * np.sin(spin), np.full(60, 0.6)]).T)
    arc(axes, ring, "the table turns about x", _UNIT, shift=(92, 6))


def _draw_above(axes: Axes) -> None:
    blank(axes, 1.25, -0.75, 1.2)
    start, turned = _unit_axes()
    arrow(axes, np.array([1.05, 0.0]), "east", _LOCAL, width=1.0)
    arrow(axes, np.array([0.0, 1.05]), "north", _LOCAL, width=1.0)
    north = np.array([0.0, 0.8, 0.0])
    for k in (1, 2):
        part = (north @ turned[k]) * turned[k, :2]
        axes.plot([north[0], part[0]], [north[1], part[1]], color=_EARTH, linewidth=0.9, dashes=(3, 2))
        axes.plot([0, part[0]], [0, part[1]], color=_EARTH, linewidth=8, alpha=0.4, solid_capstyle="butt")
    for k, name, shift in ((1, "y", (20, 4)), (2, "z", (-8, 11))):
        arrow(axes, turned[k, :2], name, _UNIT, width=2.2)
        arc(axes, between(start[k], turned[k], 0.9)[:, :2], "alpha", _UNIT, shift=shift)
    arrow(axes, north[:2], "W cos(lat)", _EARTH, width=2.4, shift=(32, -16))
    axes.plot(0, 0, "o", color=_UNIT, markersize=9, markerfacecolor="white")
    axes.plot(0, 0, "o", color=_UNIT, markersize=3)
    axes.annotate("x", (0, 0), (0, -16), textcoords="offset points", color=_UNIT, ha="center", size=10)
    for row, text in enumerate(
        (
            "of Earth's rate, y reads W cos(lat) sin(alpha),",
            "z reads W cos(lat) cos(alpha), x reads W sin(lat)",
        )
    ):
        axes.text(0, -0.38 - 0.13 * row, text, color=_EARTH, ha="center")
