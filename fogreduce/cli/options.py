"""Options that several commands share."""

from __future__ import annotations

import argparse
from pathlib import Path


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
