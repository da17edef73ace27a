"""``fogreduce figures --out DIR [--formats png,svg] [--run RUN]``: the figures of a reduced run."""

from __future__ import annotations

import argparse
import time
from pathlib import Path

from fogreduce.errors import BadInput
from fogreduce.figures import FORMATS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "--out",
        type=Path,
        required=True,
        metavar="DIR",
        help="the run's results folder; the figures come into its folder `figures`",
    )
    parser.add_argument(
        "--formats",
        default=",".join(FORMATS),
        metavar="LIST",
        help="png, svg or both (default: %(default)s)",
    )
    parser.add_argument(
        "--run", type=Path, metavar="RUN", help="the run's folder, for the figures of its logs"
    )


def run(arguments: argparse.Namespace) -> int:
    """Draw; what is left out, and why, on standard output."""
    formats = list(dict.fromkeys(arguments.formats.split(",")))
    wrong = [name for name in formats if name not in FORMATS]
    if wrong:
        raise BadInput.at("--formats", "", found=wrong[0] or "nothing", expected=" or ".join(FORMATS))
    if arguments.run is not None and not arguments.run.is_dir():
        raise BadInput.at("--run", "", found=f"no folder {arguments.run}", expected="the run's folder")
    began = time.monotonic()
    from fogreduce.datasets.sole_writer import sole_writer
    from fogreduce.figures.catalogue import plan
    from fogreduce.figures.results import Results
    from fogreduce.figures.save import save_all
    from fogreduce.progress import progress

    results = Results.read(arguments.out)
    planned = plan(results, arguments.run)
    with sole_writer(arguments.out), progress(len(planned.drawn), "figures", began) as advance:
        save_all(planned, results.identity, arguments.out / "figures", formats, advance)
    for stem, reason in planned.left_out.items():
        print(f"{stem}: left out, {reason}")
    return 0
