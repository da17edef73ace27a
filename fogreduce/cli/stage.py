"""``fogreduce stage NAME --out DIR [--run RUN]``: one stage of the reduction, as a node of the workflow."""

from __future__ import annotations

import argparse
import importlib
from pathlib import Path

#: The stages, in the order of the data flow.
STAGES = ("ingest", "calibrate", "project", "remove_earth", "fit", "drift")
_READ_RUN = ("ingest", "remove_earth")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("stage", choices=STAGES, help="the stage")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="the run's results folder, with its manifest"
    )
    parser.add_argument(
        "--run",
        type=Path,
        metavar="RUN",
        help="the run's folder: ingest reads it, and remove_earth its encoder log",
    )


def run(arguments: argparse.Namespace) -> int:
    """Run the stage."""
    from fogreduce.datasets.sole_writer import sole_writer
    from fogreduce.errors import BadInput
    from fogreduce.progress import progress
    from fogreduce.stages.setup import Setup

    node = importlib.import_module(f"fogreduce.stages.nodes.{arguments.stage}")
    setup = Setup.read(arguments.out)
    if arguments.stage == "ingest" and arguments.run is None:
        raise BadInput.at("--run", "", found="nothing", expected="the run's folder")
    given = (arguments.run,) if arguments.stage in _READ_RUN else ()
    with sole_writer(arguments.out), progress(setup.facts.n_expected, "records") as advance:
        node.run(setup, *given, progress=advance)
    if arguments.stage == "drift":
        from fogreduce.cli.flags import say_red_flags

        say_red_flags(setup)
    if arguments.stage == "ingest":
        from fogreduce.cli.warnings import print_warnings

        print_warnings(setup, arguments.run)
    return 0
