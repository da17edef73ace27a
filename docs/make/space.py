"""Drawing directions in space on paper: a parallel projection, arrows and arcs with their names."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from fogreduce.physics.frames import rotation

Array = NDArray[np.float64]

_Z = np.array([0.0, 0.0, 1.0])
_Y = np.array([0.0, 1.0, 0.0])


@dataclass(frozen=True)
class View:
    """A parallel projection: seen from a direction `turn_deg` from the first axis and `height_deg` above."""

    turn_deg: float
    height_deg: float

    def on_paper(self, vectors: Array) -> Array:
        """Vectors (..., 3), third axis upward, to the paper's right and up (..., 2)."""
        seen = rotation(_Y, np.radians(self.height_deg)) @ rotation(_Z, -np.radians(self.turn_deg))
        return (vectors @ seen.T)[..., 1:]


def blank(axes: Axes, reach: float, bottom: float, top: float) -> None:
    """Axes without frame, equal scales, from -reach to +reach and from bottom to top."""
    axes.set_axis_off()
    axes.set_aspect("equal")
    axes.set_xlim(-reach, reach)
    axes.set_ylim(bottom, top)


def arrow(
    axes: Axes,
    tip: Array,
    name: str,
    color: str,
    *,
    tail: Array | None = None,
    width: float = 1.6,
    style: str = "solid",
    shift: tuple[float, float] = (0.0, 0.0),
) -> None:
    """An arrow on paper with its name beyond the tip (moved by `shift` points)."""
    start = np.zeros(2) if tail is None else tail
    axes.annotate(
        "",
        (tip[0], tip[1]),
        (start[0], start[1]),
        arrowprops={
            "arrowstyle": "-|>",
            "color": color,
            "linewidth": width,
            "linestyle": style,
            "shrinkA": 0,
            "shrinkB": 0,
            "mutation_scale": 12,
        },
    )
    length = float(np.hypot(*(tip - start))) or 1.0
    beyond = 9 * (tip - start) / length
    axes.annotate(
        name,
        (tip[0], tip[1]),
        (beyond[0] + shift[0], beyond[1] + shift[1]),
        textcoords="offset points",
        color=color,
        ha="left" if beyond[0] > 3 else "right" if beyond[0] < -3 else "center",
        va="center",
        size=10,
    )


def arc(
    axes: Axes,
    points: Array,
    name: str,
    color: str,
    *,
    head: bool = True,
    shift: tuple[float, float] = (0.0, 0.0),
) -> None:
    """A line through points on paper (k, 2), an arrow at its end, and its name at its middle."""
    axes.plot(points[:, 0], points[:, 1], color=color, linewidth=1.1)
    if head:
        axes.annotate(
            "",
            tuple(points[-1]),
            tuple(points[-3]),
            arrowprops={"arrowstyle": "-|>", "color": color, "linewidth": 1.1, "shrinkA": 0, "shrinkB": 0},
        )
    middle = points[len(points) // 2]
    axes.annotate(
        name, tuple(middle), shift, textcoords="offset points", color=color, ha="center", va="center"
    )


def between(first: Array, second: Array, radius: float, points: int = 40) -> Array:
    """Arc of a radius from one unit vector to another, (points, 3)."""
    normal = np.cross(first, second)
    sine = np.linalg.norm(normal)
    angle = float(np.arctan2(sine, first @ second))
    steps = np.linspace(0, angle, points)
    return radius * np.array([rotation(normal / sine, step) @ first for step in steps])
