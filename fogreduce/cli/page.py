"""``fogreduce page run|campaign|index DIR``: pages of results for people, single HTML files."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from fogreduce.errors import BadInput

HELP = "write the page of a run, of a campaign or over all campaigns (a node of the workflow)"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("of", choices=("run",), metavar="OF", help="run")
    parser.add_argument(
        "results", type=Path, metavar="DIR", help="results of the run; index.html is written there"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the page."""
    if not arguments.results.is_dir():
        raise BadInput.at(arguments.results, "", found="no such folder", expected="a folder of results")
    _run(arguments.results)
    return 0


def _run(folder: Path) -> None:
    from fogreduce.datasets.atomic import write_text
    from fogreduce.pages.overview import OVERVIEW, overview
    from fogreduce.pages.run_page import run_page

    seen = overview(folder)
    write_text(folder / OVERVIEW, json.dumps(seen, indent=1, allow_nan=False) + "\n")
    write_text(folder / "index.html", run_page(folder, seen))
