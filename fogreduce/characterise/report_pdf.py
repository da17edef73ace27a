"""The report as a PDF, to print and sign: the same rows as the page, set in tables."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path

from matplotlib.backends.backend_pdf import PdfPages
from matplotlib.figure import Figure

from fogreduce.characterise import report_rows as rows
from fogreduce.characterise.report_page import run_rows, steadiest, turn_rows

_PAGE = (8.27, 11.69)  # A4 [inch]
_LEFT, _RIGHT, _TOP, _BOTTOM = 0.07, 0.95, 0.95, 0.06
_LINE = 0.0135
_SIZE = 7.0
_CHARACTERS = 158  # of the width of a page at that size, on average


class _Paper:
    """Pages, filled from the top."""

    def __init__(self, pdf: PdfPages, title: str) -> None:
        self._pdf, self._title, self._number = pdf, title, 0
        self._figure: Figure | None = None
        self._y = 0.0

    def line(self, parts: Sequence[tuple[float, str]], size: float = _SIZE, bold: bool = False) -> None:
        """A line of texts at places across (0 to 1)."""
        if self._figure is None or self._y < _BOTTOM + _LINE:
            self._turn()
        assert self._figure is not None
        for place, text in parts:
            self._figure.text(
                _LEFT + place * (_RIGHT - _LEFT),
                self._y,
                text.replace("$", r"\$"),
                fontsize=size,
                fontweight="bold" if bold else "normal",
                va="top",
            )
        self._y -= _LINE * size / _SIZE

    def heading(self, text: str) -> None:
        """A heading, not at a page's foot."""
        if self._figure is not None and self._y < _BOTTOM + 5 * _LINE:
            self._turn()
        self._y -= 0.6 * _LINE
        self.line([(0.0, text)], 10.0, bold=True)

    def text(self, text: str) -> None:
        """A paragraph."""
        for part in textwrap.wrap(text, _CHARACTERS - 18):
            self.line([(0.0, part)])

    def table(self, heads: Sequence[str], widths: Sequence[float], cells: Sequence[Sequence[str]]) -> None:
        """Rows, each cell wrapped in its column; widths sum to 1."""
        places = [sum(widths[:k]) for k in range(len(widths))]
        self.line(list(zip(places, heads, strict=True)), bold=True)
        for row in cells:
            wrapped = [
                textwrap.wrap(cell, max(6, int(width * _CHARACTERS * 0.92))) or [""]
                for cell, width in zip(row, widths, strict=True)
            ]
            for k in range(max(map(len, wrapped))):
                self.line(
                    [(place, part[k]) for place, part in zip(places, wrapped, strict=True) if k < len(part)]
                )

    def close(self) -> None:
        """The last page."""
        if self._figure is not None:
            self._pdf.savefig(self._figure)  # type: ignore[no-untyped-call]

    def _turn(self) -> None:
        self.close()
        self._number += 1
        self._figure = Figure(figsize=_PAGE)
        self._figure.text(_LEFT, 0.975, self._title, fontsize=_SIZE, color="#5f5f5f", va="top")
        self._figure.text(
            _RIGHT, 0.975, str(self._number), fontsize=_SIZE, color="#5f5f5f", va="top", ha="right"
        )
        self._y = _TOP


def write_pdf(document: rows.Document, path: Path) -> None:
    """Write the report's document as a PDF; the same document gives the same bytes."""
    title = f"Test report: {document['unit']}, campaign {document['campaign']}"
    with PdfPages(path, metadata={"Title": title, "CreationDate": None, "Producer": None}) as pdf:
        paper = _Paper(pdf, title)
        paper.line([(0.0, title)], 13.0, bold=True)
        paper.text(
            f"{len(document['runs'])} runs, started from record {document['calibration']}. "
            + rows.verdict_line(document)
        )
        _quantities(paper, document)
        _checks(paper, document)
        paper.heading("Definitions")
        for k, name, formula, source in rows.definition_rows(document):
            paper.text(f"[{k}] {name}: {formula} ({source}).")
        paper.heading("Runs")
        heads, widths = ("run", "started", "duration", "rates [deg/s]", "capture"), (0.2, 0.2, 0.1, 0.3, 0.2)
        paper.table(heads, widths, run_rows(document))
        paper.heading("Signed")
        paper.line([(0.0, "Date"), (0.3, "Tested by"), (0.65, "Approved by")])
        paper.close()


def _quantities(paper: _Paper, document: rows.Document) -> None:
    keys = ("of", "value", "interval", "verdict")
    paper.heading("What the runs determine: ± one standard uncertainty, and the 95 % interval")
    paper.table(
        ("quantity", "of", "value", "95 % interval", "verdict"),
        (0.2, 0.15, 0.33, 0.24, 0.08),
        [
            ["" if k else f"{group['title']} [{group['footnote']}]", *(row[key] for key in keys)]
            for group in rows.determined(document)
            for k, row in enumerate(group["rows"])
        ],
    )
    paper.heading("Not determinable from these runs, and the runs that would determine it")
    paper.table(
        ("quantity", "of", "needs"),
        (0.3, 0.25, 0.45),
        [
            [f"{row['title']} [{row['footnote']}]", row["of"], row["needs"]]
            for row in rows.not_determined(document)
        ],
    )


def _checks(paper: _Paper, document: rows.Document) -> None:
    if document["response"]:
        paper.heading("Response to a swing of the table: gain and phase, ± one standard uncertainty")
        names = ("run", "gyro", "frequency [Hz]", "gain", "phase [deg]")
        paper.table(names, (0.25, 0.1, 0.17, 0.24, 0.24), rows.responses(document))
    if document["left_out"]:
        first = document["left_out"][0]
        paper.heading(
            f"One gyro failed: run {first['run']}, segment {first['segment']}, without each in turn"
        )
        heads = ("without", "trace", "noise x [deg/√h]", "y", "z", "drift x [deg/h]", "y", "z")
        paper.table(heads, (0.08, 0.07, 0.15, 0.1, 0.1, 0.18, 0.16, 0.16), rows.left_out(document))
    if document["parity"]["checked"]:
        parity = document["parity"]
        paper.heading("Parity checks")
        paper.text(
            f"{len(parity['alarms'])} alarms in {parity['hours']:.3g} h; "
            f"{parity['false_alarms_expected']:.2g} false ones are to be expected."
        )
        if parity["alarms"]:
            columns = ("run", "check", "what", "since [s]", "noticed [s]", "size", "gyro", "evidence")
            widths = (0.1, 0.07, 0.17, 0.09, 0.11, 0.07, 0.16, 0.23)
            paper.table(columns, widths, rows.alarms(document))
    for turn in turn_rows(document):
        paper.heading("The same turn about other axes")
        paper.text(turn["profile"] + ": drift [deg/h] ± error of white noise")
        paper.table(("run", "about", "x", "y", "z"), (0.2, 0.1, 0.23, 0.23, 0.24), turn["rows"])
        if turn["effects"]:
            paper.table(("part", "deg/h"), (0.4, 0.6), turn["effects"])
    if document["windows"] is not None:
        paper.heading("Windows of greatest stability")
        paper.text(f"Run {document['windows']['run']}. {steadiest(document['windows'])}")
