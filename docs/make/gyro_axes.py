"""Input axes of a unit's gyros, from its H: along x (the paper's figure 2) and in space (its figure A2)."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray
from space import View, arc, arrow, between, blank

from fogreduce.physics.alignment import gyro_axes
from fogreduce.plotting import style

Array = NDArray[np.float64]

_ALONG = 0.2  # an axis whose part across x is shorter is drawn as one along x


def draw(projection: Array, name: str) -> Figure:
    """Both views of the axes of G, the pseudo-inverse of `projection` (H, 3 x n); `name` for the title."""
    axes = gyro_axes(projection)
    axes = axes / np.linalg.norm(axes, axis=1)[:, None]
    figure = Figure(figsize=(10.8, 5.0))
    figure.text(0.03, 0.965, f"Input axes of {name}", size=12, weight="bold", va="top")
    flat, space = (figure.add_axes((left, 0.02, 0.46, 0.84)) for left in (0.03, 0.51))
    figure.text(0.03, 0.87, "seen along x, x towards the reader", size=9)
    figure.text(0.53, 0.87, "in space; angles are those from x", size=9)
    _draw_flat(flat, axes)
    _draw_space(space, axes)
    return figure


def _draw_flat(paper: Axes, gyros: Array) -> None:
    """The y-z plane, y to the right, z up; angles between neighbouring projections."""
    blank(paper, 1.25, -0.75, 1.2)
    arrow(paper, np.array([1.05, 0.0]), "y", style.QUIET, width=1.0)
    arrow(paper, np.array([0.0, 1.05]), "z", style.QUIET, width=1.0, shift=(12, 0))
    across = [k for k, axis in enumerate(gyros) if np.hypot(*axis[1:]) > _ALONG]
    for k in across:
        color = style.CHANNELS[k % len(style.CHANNELS)][0]
        arrow(
            paper,
            gyros[k, 1:],
            f"gyro{k + 1}",
            color,
            width=2.2,
            shift=(-22 if abs(gyros[k, 1]) < 0.1 else 0, -4),
        )
    around = sorted(across, key=lambda k: float(np.arctan2(gyros[k, 2], gyros[k, 1])))
    for k, following in zip(around, around[1:] + around[:1], strict=True):
        if len(around) < 2:
            break
        start = float(np.arctan2(gyros[k, 2], gyros[k, 1]))
        step = (float(np.arctan2(gyros[following, 2], gyros[following, 1])) - start) % (2 * np.pi)
        sweep = start + np.linspace(0, step, 60)
        points = 0.42 * np.array([np.cos(sweep), np.sin(sweep)]).T
        outward = 30 * points[30] / 0.42
        arc(paper, points, f"{np.degrees(step):.2f} deg", style.QUIET, head=False, shift=tuple(outward))
    for k in set(range(len(gyros))) - set(across):
        color = style.CHANNELS[k % len(style.CHANNELS)][0]
        paper.plot(0, 0, "o", color=color, markersize=10, markerfacecolor="white")
        paper.plot(0, 0, "o", color=color, markersize=3)
        paper.annotate(f"gyro{k + 1}", (0, 0), (20, 8), textcoords="offset points", color=color, ha="center")


def _draw_space(paper: Axes, gyros: Array) -> None:
    """X up, as on the table; a dashed line drops each axis onto the y-z plane."""
    blank(paper, 1.25, -0.6, 1.2)
    view = View(62.0, 24.0)
    to_room = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])  # x upward on paper
    x_axis = np.array([1.0, 0.0, 0.0])

    def on_paper(vectors: Array) -> Array:
        return view.on_paper(vectors @ to_room.T)

    for name, vector in zip("xyz", np.eye(3), strict=True):
        arrow(paper, on_paper(1.12 * vector), name, style.QUIET, width=1.0)
    ring = np.linspace(0, 2 * np.pi, 120)
    circle = on_paper(np.array([np.zeros(ring.size), np.cos(ring), np.sin(ring)]).T)
    paper.plot(circle[:, 0], circle[:, 1], color="#cccccc", linewidth=0.8)
    for k, axis in enumerate(gyros):
        color = style.CHANNELS[k % len(style.CHANNELS)][0]
        angle = np.degrees(np.arccos(np.clip(axis @ x_axis, -1, 1)))
        if np.hypot(*axis[1:]) > _ALONG:
            foot = on_paper(np.stack([axis, axis * [0, 1, 1], np.zeros(3)]))
            paper.plot(foot[:, 0], foot[:, 1], color=color, linewidth=0.8, dashes=(3, 2))
            arc(paper, on_paper(between(x_axis, axis, 0.28 + 0.09 * k)), "", color, head=False)
        arrow(
            paper,
            on_paper(axis),
            f"gyro{k + 1}: {angle:.2f} deg",
            color,
            width=2.2,
            shift=(50, -4) if angle < 30 else (0, 0),
        )
