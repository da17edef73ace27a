"""The report as a PDF, to print and sign: the same rows as the page, set in tables."""

from __future__ import annotations

from pathlib import Path

from fogreduce.characterise import report_rows as rows
from fogreduce.plotting.paper import Paper, paper

_SIZE_PT = 7.0


def write_pdf(document: rows.Document, path: Path) -> None:
    """Write the report's document as a PDF; the same document gives the same bytes."""
    title = f"Test report: {document['unit']}, campaign {document['campaign']}"
    with paper(path, title, title, _SIZE_PT) as pages:
        pages.title(title)
        pages.text(
            f"{len(document['runs'])} runs, started from record {document['calibration']}. "
            + rows.verdict_line(document)
        )
        _quantities(pages, document)
        _checks(pages, document)
        pages.heading("Definitions")
        for k, name, formula, source in rows.definition_rows(document):
            pages.text(f"[{k}] {name}: {formula} ({source}).")
        pages.heading("Runs")
        heads, widths = ("run", "started", "duration", "rates [deg/s]", "capture"), (0.2, 0.2, 0.1, 0.3, 0.2)
        pages.table(heads, widths, rows.runs(document))
        pages.heading("Signed")
        pages.table(("Date", "Tested by", "Approved by"), (0.3, 0.35, 0.35), [])


def _quantities(pages: Paper, document: rows.Document) -> None:
    keys = ("of", "value", "interval", "verdict")
    pages.heading("What the runs determine: ± one standard uncertainty, and the 95 % interval")
    pages.table(
        ("quantity", "of", "value", "95 % interval", "verdict"),
        (0.2, 0.15, 0.33, 0.24, 0.08),
        [
            ["" if k else f"{group['title']} [{group['footnote']}]", *(row[key] for key in keys)]
            for group in rows.determined(document)
            for k, row in enumerate(group["rows"])
        ],
    )
    pages.heading("Not determinable from these runs, and the runs that would determine it")
    pages.table(
        ("quantity", "of", "needs"),
        (0.3, 0.25, 0.45),
        [
            [f"{row['title']} [{row['footnote']}]", row["of"], row["needs"]]
            for row in rows.not_determined(document)
        ],
    )


def _checks(pages: Paper, document: rows.Document) -> None:
    if document["response"]:
        pages.heading("Response to a swing of the table: gain and phase, ± one standard uncertainty")
        names = ("run", "gyro", "frequency [Hz]", "gain", "phase [deg]")
        pages.table(names, (0.25, 0.1, 0.17, 0.24, 0.24), rows.responses(document))
    if document["left_out"]:
        first = document["left_out"][0]
        pages.heading(
            f"One gyro failed: run {first['run']}, segment {first['segment']}, without each in turn"
        )
        heads = ("without", "trace", "noise x [deg/√h]", "y", "z", "drift x [deg/h]", "y", "z")
        pages.table(heads, (0.08, 0.07, 0.15, 0.1, 0.1, 0.18, 0.16, 0.16), rows.left_out(document))
    if document["parity"]["checked"]:
        parity = document["parity"]
        pages.heading("Parity checks")
        pages.text(
            f"{len(parity['alarms'])} alarms in {parity['hours']:.3g} h; "
            f"{parity['false_alarms_expected']:.2g} false ones are to be expected."
        )
        if parity["alarms"]:
            columns = ("run", "check", "what", "since [s]", "noticed [s]", "size", "gyro", "evidence")
            widths = (0.1, 0.07, 0.17, 0.09, 0.11, 0.07, 0.16, 0.23)
            pages.table(columns, widths, rows.alarms(document))
    for turn in rows.turns(document):
        pages.heading("The same turn about other axes")
        pages.text(turn["profile"] + ": drift [deg/h] ± error of white noise")
        pages.table(("run", "about", "x", "y", "z"), (0.2, 0.1, 0.23, 0.23, 0.24), turn["rows"])
        if turn["effects"]:
            pages.table(("part", "deg/h"), (0.4, 0.6), turn["effects"])
    if document["windows"] is not None:
        pages.heading("Windows of greatest stability")
        pages.text(f"Run {document['windows']['run']}. {rows.steadiest(document['windows'])}")
