"""``fogreduce reduce RUN --calibrations DIR --out DIR``: all stages of one run in one process."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

from fogreduce.cli.forked import in_a_fork
from fogreduce.cli.memory import keep_freed_memory
from fogreduce.cli.options import add_calibrations
from fogreduce.errors import BadInput
from fogreduce.metadata.raw_folder import refuse_raw


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("run", type=Path, metavar="RUN", help="the run's folder, with its run.yaml")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the results")
    add_input_arguments(parser)


def add_input_arguments(parser: argparse.ArgumentParser) -> None:
    """Options that say what a run is reduced with."""
    add_calibrations(parser)
    parser.add_argument(
        "--parameters", default="{}", metavar="JSON", help="parameters of the reduction, as JSON"
    )
    parser.add_argument(
        "--config",
        type=Path,
        metavar="FILE",
        help="configuration of the workflow; its part `reduction` is used",
    )


def manifest_of(arguments: argparse.Namespace) -> dict[str, Any]:
    """The run's metadata checked, its inputs hashed: its manifest."""
    if not arguments.run.is_dir():
        found = "a file" if arguments.run.exists() else "no such folder"
        raise BadInput.at(arguments.run, "", found=found, expected="a run's folder")
    _refuse_campaigns(arguments.run)
    refuse_raw("--out", arguments.out)
    from fogreduce.provenance.manifest import manifest

    return manifest(arguments.run, arguments.calibrations, _parameters(arguments))


def _refuse_campaigns(folder: Path) -> None:
    """A campaign is no run: what to call for it."""
    if any(folder.glob("run.yaml")):  # no error where the folder may not be read: the reader says that
        return
    of_one = sorted(path.parent for path in folder.glob("runs/*/run.yaml"))
    of_several = sorted(path.parent for path in folder.glob("*/runs/*/run.yaml"))
    if runs := of_one or of_several:
        parent = folder.absolute().parent if of_one else folder
        raise BadInput.at(
            folder,
            "",
            found="a campaign" if of_one else "a folder of campaigns",
            expected=f"the folder of one run, such as {runs[0]}; for all of them: "
            f"snakemake --cores 2 --config campaigns_dir={parent}",
        )


def _parameters(arguments: argparse.Namespace) -> dict[str, Any]:
    parameters: dict[str, Any] = {}
    if arguments.config is not None:
        from fogreduce.metadata.config import WorkflowConfig

        parameters = WorkflowConfig.from_yaml(arguments.config).reduction.model_dump(mode="json")
    try:
        given = json.loads(arguments.parameters)
    except ValueError as error:
        raise BadInput.at("--parameters", "", found=str(error), expected="a JSON object") from None
    if not isinstance(given, dict):
        raise BadInput.at("--parameters", "", found=arguments.parameters, expected="a JSON object")
    return parameters | given


def run(arguments: argparse.Namespace) -> int:
    """Reduce; the tables are byte for byte those of the workflow."""
    manifest = in_a_fork(lambda: manifest_of(arguments))
    keep_freed_memory()
    from fogreduce.cli.flags import say_red_flags
    from fogreduce.cli.warnings import print_warnings
    from fogreduce.pages.summary_line import summary_line
    from fogreduce.stages.reduce_into import reduce_into
    from fogreduce.stages.setup import Setup

    setup = Setup(manifest(), arguments.out)
    reduce_into(setup, arguments.run, arguments.calibrations)
    say_red_flags(setup)
    warnings = print_warnings(setup, arguments.run)
    print(f"{arguments.run}: {summary_line(setup, warnings)}")
    return 0
