"""The certificate of a candidate record on paper: pages of A4 to print and to sign.

The same facts give the same bytes: the file names no date and no software.
"""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path

from matplotlib.backends.backend_pdf import FigureCanvasPdf, PdfPages
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from fogreduce.calibrate.certificate import COVERAGE_FACTOR, COVERAGE_PROBABILITY, NOT_STATED, Facts
from fogreduce.datasets.atomic import whole_file
from fogreduce.metadata.certificate import Party
from fogreduce.pages.numbers import number, plus_minus
from fogreduce.plotting.style import style

_A4_INCH = (8.27, 11.69)
_LEFT, _RIGHT, _TOP, _BOTTOM = 0.10, 0.92, 0.94, 0.06
_LINE = 0.0155  # of the page's height
_CHARACTERS = 100  # of a line of plain text

#: Column of the table of coefficients -> its width among the others.
_COLUMNS = {"gyro": 0.8, "bias": 2.0, "scale factor": 2.6, "input axis [x, y, z]": 3.2, "pointing": 1.3}
_RUNS_SHOWN = 12


def write_pdf(facts: Facts, path: Path) -> None:
    """Write the certificate.

    Parameters
    ----------
    facts : Facts
    path : Path
    """
    metadata: dict[str, str | None] = {"Title": f"Calibration certificate {facts.record.record_id}"}
    metadata |= dict.fromkeys(("Creator", "Producer", "CreationDate"))
    with style(), whole_file(path) as temporary, PdfPages(temporary, metadata=metadata) as pdf:
        paper = _Paper()
        _first_page(paper, facts)
        paper.turn()
        _results(paper, facts)
        _pedigree(paper, facts)
        for figure in paper.numbered(facts.record.record_id):
            FigureCanvasPdf(figure)
            pdf.savefig(figure)


class _Paper:
    """Pages that are written from top to bottom; a full one is turned."""

    def __init__(self) -> None:
        self.figures: list[Figure] = []
        self.turn()

    def turn(self) -> None:
        """Begin a page."""
        self.figures.append(Figure(figsize=_A4_INCH))
        self.y = _TOP

    def down(self, lines: float) -> None:
        """Go on further below, or on the next page."""
        self.y -= lines * _LINE
        if self.y < _BOTTOM + _LINE:
            self.turn()

    def put(self, x: float, text: str, *, size: float = 9, bold: bool = False) -> None:
        """Words at the present height, as plain text: a name's dollar signs are no formula."""
        weight = "bold" if bold else "normal"
        self.figures[-1].text(x, self.y, text, fontsize=size, fontweight=weight, va="top", parse_math=False)

    def text(
        self, text: str, x: float = _LEFT, *, size: float = 9, bold: bool = False, width: int = _CHARACTERS
    ) -> None:
        """A paragraph."""
        for line in textwrap.wrap(text, width):
            self.put(x, line, size=size, bold=bold)
            self.down(size / 9)

    def heading(self, text: str) -> None:
        """A heading with room above."""
        self.down(1)
        self.text(text, size=11, bold=True)
        self.down(0.2)

    def pair(self, name: str, value: str) -> None:
        """A name and what it stands for."""
        self.put(_LEFT, name, bold=True)
        self.text(value, x=_LEFT + 0.19, width=76)

    def row(self, cells: Sequence[str], *, bold: bool = False) -> None:
        """A row of the table of coefficients."""
        x, scale = _LEFT, (_RIGHT - _LEFT) / sum(_COLUMNS.values())
        for cell, width in zip(cells, _COLUMNS.values(), strict=True):
            self.put(x, cell, size=7.5, bold=bold)
            x += width * scale
        self.down(1)

    def rule(self, left: float = _LEFT, right: float = _RIGHT) -> None:
        """A line across at the present height."""
        line = Line2D([left, right], [self.y, self.y], color="#444444", linewidth=0.7)
        self.figures[-1].add_artist(line)

    def numbered(self, name: str) -> list[Figure]:
        """The pages, with name and number below everything."""
        for k, figure in enumerate(self.figures, start=1):
            figure.text(_LEFT, _BOTTOM - 0.02, name, fontsize=7.5, parse_math=False)
            figure.text(_RIGHT, _BOTTOM - 0.02, f"page {k} of {len(self.figures)}", fontsize=7.5, ha="right")
        return self.figures


def _first_page(paper: _Paper, facts: Facts) -> None:
    about, record = facts.about, facts.record
    paper.text("Calibration certificate", size=18, bold=True)
    paper.text(f"{record.record_id}: candidate, in force once it is signed and named by a run or a campaign")
    paper.rule()
    paper.heading("Calibrated item")
    paper.pair("Unit", f"{record.unit}, {record.n} gyro{'' if record.n == 1 else 's'}")
    paper.pair("Customer", _party(about.customer))
    paper.heading("Calibration")
    paper.pair("Laboratory", _party(about.laboratory))
    paper.pair("Carried out", f"{facts.first:%Y-%m-%d %H:%M} to {facts.last:%Y-%m-%d %H:%M} UTC")
    paper.pair("Procedure", facts.procedure)
    paper.pair("Campaign", facts.campaign)
    table = about.table
    if table is None:
        paper.pair("Rate table", NOT_STATED)
    else:
        serial = f", serial number {table.serial_number}" if table.serial_number else ""
        paper.pair("Rate table", table.name + serial)
        paper.pair("Its certificate", f"{table.certificate}, SHA-256 {table.certificate_sha256}")
    paper.pair("Software", facts.software)
    fit = f"chi-square {facts.chi2:.0f} for {facts.freedom:.0f} degrees of freedom"
    paper.pair("Goodness of fit", f"{fit}, p = {number(facts.p_value)}")
    paper.heading("Records")
    paper.pair("This record", f"{record.record_id}, SHA-256 {facts.record_sha256}")
    paper.pair("Supersedes", f"{facts.present_id}, SHA-256 {facts.present_sha256}")
    paper.pair("Valid from", f"{record.valid_from:%Y-%m-%d %H:%M} UTC")
    paper.heading("Uncertainty")
    paper.text(
        f"± is the expanded uncertainty, {COVERAGE_FACTOR:g} standard deviations, which holds "
        f"{COVERAGE_PROBABILITY:.2%} of a normal quantity. It includes noise within runs, turn-on scatter "
        "between runs, and azimuth, latitude and table rate as far as they are stated uncertain. It does not "
        "include departures of the scale factor from a straight line, nor change after the calibration. The "
        "full covariance is in the record."
    )
    paper.heading("Signature")
    paper.pair("Responsible", about.responsible or NOT_STATED)
    paper.down(3.5)
    paper.rule(_LEFT, 0.45)
    paper.rule(0.55, _RIGHT)
    paper.down(0.3)
    paper.put(_LEFT, "place and date", size=7.5)
    paper.put(0.55, "signature", size=7.5)


def _results(paper: _Paper, facts: Facts) -> None:
    found, raw = facts.coefficients, facts.record.raw_unit.name
    paper.heading("Results")
    paper.row(list(_COLUMNS), bold=True)
    paper.row(["", "[deg/h]", f"[{raw}/(deg/s)]", "unit frame", "[mrad]"])
    paper.rule()
    paper.down(0.3)
    for i in range(facts.record.n):
        scale = found.scale_factor[i]
        scale_std = abs(scale) * found.scale_factor_std_rel[i]
        paper.row(
            [
                f"gyro{i + 1}",
                plus_minus(found.bias_deg_h[i], COVERAGE_FACTOR * found.bias_std_deg_h[i]),
                plus_minus(scale, COVERAGE_FACTOR * scale_std),
                "[" + ", ".join(f"{one:.6f}" for one in found.axes[i]) + "]",
                f"± {number(COVERAGE_FACTOR * found.axis_std_rad[i] * 1e3, 2)}",
            ]
        )


def _pedigree(paper: _Paper, facts: Facts) -> None:
    paper.down(0.5)
    paper.text(
        "pointing: of the axis, in each of two directions at right angles to it; bias: by the scale factor "
        "beside it."
    )
    turn_on, noise = facts.coefficients.turn_on_bias_deg_h, facts.record.stated_noise
    paper.heading("Repeatability and noise, one standard deviation")
    for i in range(facts.record.n):
        paper.pair(
            f"gyro{i + 1}",
            f"turn-on bias {number(turn_on[i], 2)} deg/h; angle random walk "
            f"{number(noise.angle_random_walk_deg_sqrt_h[i], 3)} deg/√h; bias instability "
            f"{number(noise.bias_instability_deg_h[i], 3)} deg/h; rate random walk "
            f"{number(noise.rate_random_walk_deg_h_sqrt_h[i], 3)} deg/h/√h",
        )
    runs = facts.record.pedigree.runs if facts.record.pedigree is not None else ()
    paper.heading("Runs")
    shown = runs[:_RUNS_SHOWN]
    for run in shown:
        paper.pair(run.run_id, f"capture SHA-256 {run.capture_sha256}")
    if len(runs) > len(shown):
        paper.text(f"and {len(runs) - len(shown)} more, in the record's pedigree")


def _party(party: Party | None) -> str:
    if party is None:
        return NOT_STATED
    return ", ".join(filter(None, (party.name, party.street, party.city, party.country)))
