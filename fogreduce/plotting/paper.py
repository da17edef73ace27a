"""Pages of A4 to print and to sign, as PDF: the same words give the same bytes, whatever the day."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from matplotlib.backends.backend_pdf import FigureCanvasPdf, PdfPages
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fogreduce.datasets.atomic import whole_file
from fogreduce.plotting.style import style

_A4_INCH = (8.27, 11.69)
_POINTS_PER_INCH = 72
_LEFT, _RIGHT, _TOP, _BOTTOM = 0.08, 0.94, 0.95, 0.06  # parts of the page
_LEADING = 1.45  # of a line over the size of its letters
_CHARACTER = 0.57  # width of a character over its size, of text with many digits
_HEADING, _TITLE = 1.25, 2.0  # sizes over that of plain text
_FOOT_PT = 7.5
_NAMES = 0.22  # of the width, for the names of pairs


class Paper:
    """Pages that are written from top to bottom; a full one is turned.

    Places across are parts of the width between the margins, 0 to 1; sizes of letters are in points.

    Parameters
    ----------
    size : float
        Of plain text [pt].
    """

    def __init__(self, size: float) -> None:
        self.figures: list[Figure] = []
        self._size = size
        self._line = _LEADING * size / _POINTS_PER_INCH / _A4_INCH[1]
        self._y = 0.0

    def turn(self) -> None:
        """Leave the rest of the page empty."""
        self._y = 0.0

    def down(self, lines: float) -> None:
        """Go on further below, by so many lines of plain text."""
        self._y -= lines * self._line

    def put(self, place: float, text: str, *, size: float | None = None, bold: bool = False) -> None:
        """Words at the present height, as plain text: a name's dollar signs are no formula."""
        if self._y < _BOTTOM + self._line:
            self.figures.append(Figure(figsize=_A4_INCH))
            self._y = _TOP
        weight, size = "bold" if bold else "normal", size or self._size
        self.figures[-1].text(
            _across(place), self._y, text, fontsize=size, fontweight=weight, va="top", parse_math=False
        )

    def text(self, text: str, place: float = 0.0, *, size: float | None = None, bold: bool = False) -> None:
        """A paragraph from a place across to the right margin."""
        self._row([place], [self._wrapped(text, 1.0 - place, size)], size, bold)

    def title(self, text: str) -> None:
        """What the paper is."""
        self.text(text, size=_TITLE * self._size, bold=True)

    def heading(self, text: str) -> None:
        """A heading with room above, not at a page's foot."""
        if self._y < _BOTTOM + 5 * self._line:
            self.turn()
        self.down(1)
        self.text(text, size=_HEADING * self._size, bold=True)
        self.down(0.2)

    def pair(self, name: str, value: str) -> None:
        """A name and what it stands for."""
        self.put(0.0, name, bold=True)
        self.text(value, _NAMES)

    def table(
        self,
        heads: Sequence[str],
        widths: Sequence[float],
        rows: Sequence[Sequence[str]],
        size: float | None = None,
    ) -> None:
        """Rows below their heads, each cell wrapped in its column; `widths` sum to 1."""
        places = [sum(widths[:k]) for k in range(len(widths))]
        for k, row in enumerate([heads, *rows]):
            cells = [self._wrapped(cell, width, size) for cell, width in zip(row, widths, strict=True)]
            self._row(places, cells, size, bold=k == 0)

    def rule(self, left: float = 0.0, right: float = 1.0) -> None:
        """A line across at the present height."""
        ends = [_across(left), _across(right)]
        self.figures[-1].add_artist(Line2D(ends, [self._y, self._y], color="#444444", linewidth=0.7))

    def _wrapped(self, text: str, width: float, size: float | None) -> list[str]:
        points = width * (_RIGHT - _LEFT) * _A4_INCH[0] * _POINTS_PER_INCH
        return textwrap.wrap(text, max(6, int(points / (size or self._size) / _CHARACTER)))

    def _row(
        self, places: Sequence[float], cells: Sequence[Sequence[str]], size: float | None, bold: bool
    ) -> None:
        for k in range(max(map(len, cells))):
            for place, lines in zip(places, cells, strict=True):
                if k < len(lines):
                    self.put(place, lines[k], size=size, bold=bold)
            self.down((size or self._size) / self._size)


@contextmanager
def paper(path: Path, title: str, name: str, size: float) -> Iterator[Paper]:
    """A paper that is written to a file when the block ends, whole or not at all.

    Parameters
    ----------
    path : Path
    title : str
        In the file's metadata.
    name : str
        At the foot of each page, beside its number.
    size : float
        Of plain text [pt].
    """
    metadata: dict[str, str | None] = {"Title": title}
    metadata |= dict.fromkeys(("Creator", "Producer", "CreationDate"))
    with style():
        made = Paper(size)
        yield made
        with whole_file(path) as temporary, PdfPages(temporary, metadata=metadata) as pdf:
            for k, figure in enumerate(made.figures, start=1):
                number = f"page {k} of {len(made.figures)}"
                figure.text(_LEFT, _BOTTOM - 0.02, name, fontsize=_FOOT_PT, parse_math=False)
                figure.text(_RIGHT, _BOTTOM - 0.02, number, fontsize=_FOOT_PT, ha="right")
                FigureCanvasPdf(figure)
                pdf.savefig(figure)


def _across(place: float) -> float:
    """Part of the page's width, from that between the margins."""
    return _LEFT + place * (_RIGHT - _LEFT)
