"""How every figure looks: colours, sizes, header and corner, all in this one file.

Colours differ in lightness as well as in hue, and lines in their dashes, so that a grey print still tells.
Text stays text in SVG: small files whose words can be searched.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import matplotlib
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

BAND = "#b5cde3"  # lowest to highest sample
MEAN = "#1d4f80"  # means of bins
CURVE = "#f08a00"  # fitted curve
ADJUSTED = "#111111"  # curve with its offset moved
COMMAND = "#6b6b6b"
UNSTABLE = "#f4e3ae"
SPIKE = "#a3123a"
QUIET = "#5f5f5f"  # run and version, beside what matters
WARNING = "#a3123a"  # a campaign's label: what the data are not

#: One colour and one marker a channel where several share a panel.
CHANNELS = (
    ("#1d4f80", "o"),
    ("#f08a00", "s"),
    ("#1f8a70", "^"),
    ("#9a5fb5", "D"),
    ("#7a7a7a", "v"),
    ("#c2185b", "P"),
)

TIME_LABEL = "time from the run's start [s]"

_RC: dict[Any, Any] = {
    "axes.edgecolor": "#444444",
    "axes.formatter.limits": (-12, 12),
    "axes.formatter.useoffset": False,
    "axes.axisbelow": True,
    "axes.grid": True,
    "axes.labelsize": 9,
    "axes.linewidth": 0.7,
    "axes.titlelocation": "left",
    "axes.titlepad": 4,
    "axes.titlesize": 9,
    "axes.titley": 1.0,  # fixed: finding a free place takes a third of the drawing time
    "axes.xmargin": 0,
    "figure.dpi": 100,
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "grid.color": "#dddddd",
    "grid.linewidth": 0.5,
    "legend.fontsize": 9,
    "lines.linewidth": 1.2,
    "path.simplify": True,
    "savefig.dpi": 100,
    "svg.fonttype": "none",
    "svg.hashsalt": "fogreduce",
    "xtick.labelsize": 9,
    "ytick.labelsize": 9,
}

_WIDTH = 10.8  # inches; times 100 dpi = pixels
_LEFT, _RIGHT, _BOTTOM, _TOP, _GAP = 1.05, 0.32, 0.72, 1.0, 0.34
_LABEL_LINE = 0.24  # a campaign's label has a line of its own in the header
_COLUMN_GAP = 0.85
_Y_LABEL, _X_LABEL = 0.82, 0.30  # from the axes to the middle of their labels


@contextmanager
def style() -> Iterator[None]:
    """Matplotlib's settings while figures are drawn and saved, whatever a user's own settings are."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(_RC)
        yield


@dataclass(frozen=True)
class Identity:
    """What every figure says of where it comes from; `label` is empty for measured data."""

    campaign: str
    run_id: str
    version_id: str
    label: str


def panels(
    identity: Identity,
    title: str,
    rows: int,
    height: float,
    widths: Sequence[float] = (1.0,),
    left_margin: float = _LEFT,
    *,
    sharing: bool = True,
) -> tuple[Figure, list[list[Axes]]]:
    """A figure of panels one above the other, with header and corner.

    Parameters
    ----------
    identity : Identity
        What the header says.
    title : str
        What the figure shows.
    rows : int
        Number of panels in a column.
    height : float
        Of one panel [inch].
    widths : sequence of float
        Relative widths of the columns.
    left_margin : float
        Room for the vertical axis' labels [inch].
    sharing : bool
        Whether the panels of a column share their horizontal axis, labelled below the last.

    Returns
    -------
    Figure, and its axes as rows of columns.
    """
    top = _TOP + (_LABEL_LINE if identity.label else 0.0)
    gap = _GAP if sharing else _BOTTOM
    total = top + rows * height + (rows - 1) * gap + _BOTTOM
    figure = Figure(figsize=(_WIDTH, total))
    free = _WIDTH - left_margin - _RIGHT - _COLUMN_GAP * (len(widths) - 1)
    found: list[list[Axes]] = []
    for row in range(rows):
        bottom = (total - top - height - row * (height + gap)) / total
        left, axes = left_margin, []
        for column, part in enumerate(widths):
            width = free * part / sum(widths)
            place = (left / _WIDTH, bottom, width / _WIDTH, height / total)
            axes.append(figure.add_axes(place, sharex=found[0][column] if found and sharing else None))
            axes[-1].tick_params(labelbottom=row == rows - 1 or not sharing)
            axes[-1].yaxis.set_label_coords(-_Y_LABEL / width, 0.5)
            axes[-1].xaxis.set_label_coords(0.5, -_X_LABEL / height)
            left += width + _COLUMN_GAP
        found.append(axes)
    _identify(figure, identity, title, total)
    return figure, found


def _identify(figure: Figure, identity: Identity, title: str, total: float) -> None:
    """Title and run above, label under the title, version id in a corner."""
    left, right = _LEFT / _WIDTH, 1 - _RIGHT / _WIDTH
    figure.text(left, 1 - 0.14 / total, title, va="top", size=12, weight="bold")
    name = f"{identity.campaign} / {identity.run_id}"
    figure.text(right, 1 - 0.15 / total, name, va="top", ha="right", size=10, color=QUIET)
    if identity.label:
        place = 1 - 0.40 / total
        figure.text(left, place, identity.label, va="top", size=9, weight="bold", color=WARNING)
    corner = f"version {identity.version_id}"
    figure.text(right, 0.08 / total, corner, va="bottom", ha="right", size=7.5, color=QUIET)


def legend(figure: Figure, identity: Identity, handles: Sequence[Artist]) -> None:
    """A legend in the header's last line, clear of the data."""
    height = float(figure.get_size_inches()[1])
    down = 0.39 + (_LABEL_LINE if identity.label else 0.0)
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(_LEFT / _WIDTH, 1 - down / height),
        ncols=len(handles),
        frameon=False,
        borderpad=0,
        borderaxespad=0,
        columnspacing=1.4,
        handlelength=1.8,
        handletextpad=0.5,
    )


def say_empty(axes: Axes, text: str) -> None:
    """A panel that has nothing to show says why, in place of a scale that means nothing."""
    axes.set_yticks([])
    axes.text(0.5, 0.5, text, transform=axes.transAxes, ha="center", va="center", color=QUIET)


def note(axes: Axes, text: str, color: str = QUIET) -> None:
    """A remark above a panel's right end."""
    axes.set_title(text, loc="right", size=8.5, color=color)
