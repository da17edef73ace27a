"""``fogreduce summary``: the drift and rate tables of many runs in one, and the runs that have none."""

from __future__ import annotations

import argparse
import json
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from fogreduce.errors import BadInput

if TYPE_CHECKING:
    from fogreduce.stages.summary import RunResults


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "run_results",
        metavar="RESULTS",
        type=Path,
        nargs="*",
        help="results of a run, as reduce --out wrote them",
    )
    parser.add_argument(
        "--results",
        metavar="DIR",
        type=Path,
        help="folder of results <campaign>/<run_id>, as the workflow writes them",
    )
    parser.add_argument(
        "--runs",
        metavar="FILE",
        type=Path,
        help="JSON list of [campaign, run_id]: the runs of --results (default: all that it holds)",
    )
    parser.add_argument(
        "--campaigns",
        metavar=("DIR", "NAME"),
        nargs="+",
        help="folder of the campaigns, and the names of some: the runs that --results should hold",
    )
    parser.add_argument("--out", metavar="DIR", type=Path, required=True, help="folder for the tables")


def run(arguments: argparse.Namespace) -> int:
    """Write the tables over all runs."""
    from fogreduce.stages.summary import write_summary

    runs = list(_runs(arguments))
    if not runs:
        raise BadInput.at("RESULTS", "", found="no run", expected="results of at least one run")
    gathered, failed = write_summary(runs, arguments.out)
    if failed:
        print(f"{arguments.out}: {gathered} runs gathered, {failed} without tables (failed.csv)")
    return 0


def _runs(arguments: argparse.Namespace) -> Iterator[RunResults]:
    """The runs asked for, in the order given."""
    from fogreduce.stages.summary import RunResults, find_results, one_result

    for folder in arguments.run_results:
        yield one_result(folder)
    if arguments.runs is not None or arguments.campaigns is not None:
        if arguments.results is None:
            raise BadInput.at(
                "--results", "", found="nothing", expected="the folder that holds the runs' results"
            )
        listed = _listed(arguments.runs) if arguments.runs is not None else _asked_for(*arguments.campaigns)
        for campaign, run_id in listed:
            yield RunResults(arguments.results / campaign / run_id, campaign, run_id)
    elif arguments.results is not None:
        yield from find_results(arguments.results)


def _asked_for(campaigns: str, *names: str) -> Iterator[tuple[str, str]]:
    """Campaign and run of every run folder, of all campaigns or of those named."""
    from fogreduce.metadata.folder import find_runs, list_campaigns

    for folder in list_campaigns(campaigns):
        if not names or folder.name in names:
            for run in find_runs(folder)[0]:
                yield folder.name, run.name


def _listed(path: Path) -> list[tuple[str, str]]:
    """The pairs in a list of runs."""
    expected = "a JSON list of [campaign, run_id]"
    try:
        data = json.loads(path.read_text(encoding="utf-8"))
    except ValueError as error:
        raise BadInput.at(path, "", found=str(error), expected=expected) from None
    if not isinstance(data, list):
        raise BadInput.at(path, "", found=type(data).__name__, expected=expected)
    for number, pair in enumerate(data):
        if not (isinstance(pair, list) and len(pair) == 2 and all(isinstance(name, str) for name in pair)):
            raise BadInput.at(path, f"[{number}]", found=json.dumps(pair)[:80], expected="[campaign, run_id]")
    return [(campaign, run_id) for campaign, run_id in data]
