"""``fogreduce page run|campaign|index DIR``: pages of results for people, single HTML files."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from fogreduce.errors import BadInput
from fogreduce.metadata.raw_folder import refuse_raw


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("of", choices=tuple(_WRITERS), metavar="OF", help="run, campaign or index")
    parser.add_argument(
        "results",
        type=Path,
        metavar="DIR",
        help="results of the run, of the campaign or of all; index.html is written there",
    )
    parser.add_argument(
        "--campaigns",
        metavar="DIR",
        type=Path,
        help="folder of the campaigns, for their titles and for runs that failed (default: what has results)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Write the page."""
    if not arguments.results.is_dir():
        raise BadInput.at(arguments.results, "", found="no such folder", expected="a folder of results")
    if arguments.campaigns is not None and not arguments.campaigns.is_dir():
        raise BadInput.at("--campaigns", "", found=f"no folder {arguments.campaigns}", expected="a folder")
    refuse_raw("DIR", arguments.results)
    _refuse_other(arguments.of, arguments.results)
    _WRITERS[arguments.of](arguments.results, arguments.campaigns)
    return 0


def _refuse_other(of: str, folder: Path) -> None:
    """A page over runs is not written over that of a run, nor one over campaigns over a campaign's."""
    expected = {"campaign": "results of a campaign", "index": "results of all campaigns"}
    if of in expected and (folder / "manifest.json").exists():
        raise BadInput.at(folder, "", found="results of a run", expected=expected[of])
    if of == "index" and any(folder.glob("*/manifest.json")):
        raise BadInput.at(folder, "", found="results of a campaign", expected=expected[of])


def _run(folder: Path, campaigns: Path | None) -> None:
    from fogreduce.datasets.atomic import write_text
    from fogreduce.pages.overview import OVERVIEW, overview
    from fogreduce.pages.run_page import run_page

    seen = overview(folder)
    write_text(folder / OVERVIEW, json.dumps(seen, indent=1, allow_nan=False) + "\n")
    write_text(folder / "index.html", run_page(folder, seen))


def _campaign(folder: Path, campaigns: Path | None) -> None:
    from fogreduce.datasets.atomic import write_text
    from fogreduce.pages.campaign_page import campaign_page
    from fogreduce.pages.gather import gather

    folder = folder.resolve()
    gathered = gather(folder, campaigns and campaigns / folder.name)
    write_text(folder / "index.html", campaign_page(gathered, folder))


def _index(folder: Path, campaigns: Path | None) -> None:
    from fogreduce.datasets.atomic import write_text
    from fogreduce.pages.gather import gather
    from fogreduce.pages.index_page import index_page

    names = sorted(path.name for path in folder.iterdir() if path.is_dir() and path.name[0] not in "_.")
    gathered = [gather(folder / name, campaigns and campaigns / name) for name in names]
    unit_pages = {path.stem for path in (folder / "_units").glob("*.html")}
    write_text(folder / "index.html", index_page(gathered, unit_pages))


_WRITERS = {"run": _run, "campaign": _campaign, "index": _index}
