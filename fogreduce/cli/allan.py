"""``fogreduce allan OUT``: Allan deviation of a reduced run, every sample of it, as tables and a figure."""

from __future__ import annotations

import argparse
from pathlib import Path

from fogreduce.errors import BadInput
from fogreduce.figures import FORMATS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("results", type=Path, metavar="OUT", help="the run's results folder")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="folder to write to (default: `allan` in the results folder)"
    )


def run(arguments: argparse.Namespace) -> int:
    """Write allan.csv, noise.csv, spectrum.csv and the figure; say the coefficients."""
    if not arguments.results.is_dir():
        raise BadInput.at(arguments.results, "", found="no such folder", expected="a run's results folder")
    from fogreduce.characterise.allan_run import allan_of_run
    from fogreduce.characterise.allan_tables import write_tables
    from fogreduce.figures.save import save
    from fogreduce.plotting.style import style

    result = allan_of_run(arguments.results)
    folder = arguments.out or arguments.results / "allan"
    written = write_tables(result, folder)
    figure = result.plot()
    with style():
        for file_format in FORMATS:
            written.append(folder / f"allan.{file_format}")
            save(figure, written[-1], file_format)
    print(result)
    for path in written:
        print(path)
    if folder.is_relative_to(arguments.results) and (arguments.results / "outputs.json").is_file():
        print(f"take the checksums anew, for an archive: fogreduce checksums {arguments.results}")
    return 0
