"""``fogreduce report CAMPAIGN --out DIR``: the unit's test report, as page, PDF and document."""

from __future__ import annotations

import argparse
from pathlib import Path

from fogreduce.cli.options import add_calibrations


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("campaign", type=Path, metavar="CAMPAIGN", help="the campaign's folder")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the report")
    parser.add_argument("--limits", type=Path, metavar="FILE", help="YAML file of limits to pass or fail")
    parser.add_argument(
        "--definitions", type=Path, metavar="FILE", help="YAML file of definitions (default: IEEE's)"
    )
    parser.add_argument(
        "--only-runs", metavar="ID,...", default="", help="runs to use, by id (default: all of them)"
    )
    add_calibrations(parser)


def run(args: argparse.Namespace) -> int:
    """Write report.json, index.html and report.pdf; a summary on standard output."""
    from fogreduce.characterise.definitions import read_definitions
    from fogreduce.characterise.limits import read_limits
    from fogreduce.characterise.report import report
    from fogreduce.characterise.report_page import FOLDER, report_page
    from fogreduce.characterise.report_pdf import write_pdf
    from fogreduce.characterise.report_rows import verdict_line
    from fogreduce.datasets.atomic import write_text
    from fogreduce.metadata.raw_folder import refuse_raw
    from fogreduce.stages.files import write_json

    refuse_raw("--out", args.out)
    choices, limits = read_definitions(args.definitions), read_limits(args.limits)
    only = [name for name in args.only_runs.split(",") if name]
    document = report(args.campaign, args.calibrations, only, choices, limits)
    page = report_page(document, args.out.resolve().name == FOLDER)
    write_pdf(document, args.out / "report.pdf")
    write_text(args.out / "index.html", page)
    write_json(args.out / "report.json", document)
    determined = sum(one["determined"] for one in document["quantities"])
    print(
        f"{document['unit']}: {determined} of {len(document['quantities'])} quantities determined by "
        f"{len(document['runs'])} runs; {len(document['parity']['alarms'])} parity alarms. "
        + verdict_line(document)
    )
    print(f"{args.out}: index.html, report.pdf, report.json")
    return 0
