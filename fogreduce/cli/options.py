"""Options that several commands share."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from fogreduce.errors import BadInput

if TYPE_CHECKING:
    from fogreduce.metadata.part import Part


def add_calibrations(parser: argparse.ArgumentParser) -> None:
    """Where the calibration records lie."""
    parser.add_argument(
        "--calibrations",
        type=Path,
        default=Path("calibrations"),
        metavar="DIR",
        help="folder of the calibration records (default: %(default)s)",
    )


def add_places(parser: argparse.ArgumentParser) -> None:
    """Where the inputs of results lie; a bag has its own."""
    parser.add_argument(
        "--campaigns",
        type=Path,
        default=Path("campaigns"),
        metavar="DIR",
        help="folder of the campaigns (default: %(default)s)",
    )
    add_calibrations(parser)


def add_part(parser: argparse.ArgumentParser) -> None:
    """``--part``, of the commands that take the place of what a record does not state."""
    parser.add_argument(
        "--part",
        metavar="FILE",
        help="a data sheet (fogreduce/part/1), or the name of a bundled one: tactical-fog, ring-laser, mems; "
        "it stands in where the calibration record states nothing",
    )


def read_part(name: str | None) -> Part | None:
    """The part that ``--part`` names."""
    if name is None:
        return None
    from fogreduce.metadata.part import Part

    return Part.named(name)


def run_ids(text: str | None) -> tuple[str, ...]:
    """The runs of ``--only-runs ID,...``; none where the option is not given."""
    names = () if text is None else tuple(name for name in text.split(",") if name)
    if text is not None and not names:
        raise BadInput.at("--only-runs", "", found=text, expected="names of runs: ID,...")
    return names
