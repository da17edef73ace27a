"""``fogreduce diagnose``: where a campaign departs from its prediction, which effect causes it, how far it
closes.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from fogreduce.errors import BadInput

if TYPE_CHECKING:
    from fogreduce.gap.diagnose import Diagnosis


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument("campaign", metavar="CAMPAIGN", type=Path, help="campaign folder with captures")
    parser.add_argument(
        "--calibrations",
        metavar="DIR",
        type=Path,
        default=Path("calibrations"),
        help="folder of the calibration records (default: %(default)s)",
    )
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        required=True,
        help="folder for diagnosis.json and what stands beside it",
    )
    parser.add_argument(
        "--without", metavar="EFFECT", action="append", default=[], help="take an effect out of the catalogue"
    )
    parser.add_argument("--only-runs", metavar="ID,...", default="", help="diagnose these runs only")
    parser.add_argument(
        "--simulated", metavar="CAMPAIGN2", type=Path, help="captures of another simulator as the prediction"
    )
    parser.add_argument(
        "--verify-next",
        action="store_true",
        help="simulate the run that it proposes, with each rival as the truth, and diagnose again",
    )


def run(args: argparse.Namespace) -> int:
    """Diagnose; the verdict on standard output."""
    from fogreduce.gap.diagnose import diagnose
    from fogreduce.gap.write import write
    from fogreduce.metadata.folder import load_campaign

    only = tuple(name for name in args.only_runs.split(",") if name)
    diagnosis = diagnose(args.campaign, args.calibrations, args.without, only, args.simulated)
    if args.verify_next:
        _verify_next(diagnosis, args, only)
    write(diagnosis, args.out, load_campaign(args.campaign).label)
    causes = ", ".join(f"{c['effect']} {' '.join(c['channels'])}" for c in diagnosis.document["causes"])
    print(f"{args.out}: {diagnosis.document['verdict']}{': ' if causes else ''}{causes}")
    return 0


def _verify_next(diagnosis: Diagnosis, args: argparse.Namespace, only: tuple[str, ...]) -> None:
    """Add to the document what the proposed run would bring."""
    from fogreduce.gap.verify_next import verified

    if args.simulated is not None:
        raise BadInput.at(
            "--verify-next", "", found="with --simulated", expected="our own simulator, which alone can do it"
        )
    found = verified(diagnosis, args.campaign, args.calibrations, args.without, only)
    if found is not None:
        diagnosis.document["next_run"]["verified"] = found
