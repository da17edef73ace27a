"""``fogreduce diagnose``: where a campaign departs from its prediction, which effect causes it, how far it
closes.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from fogreduce.cli.options import add_calibrations
from fogreduce.errors import BadInput

if TYPE_CHECKING:
    from fogreduce.gap.diagnose import Diagnosis


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "campaign",
        metavar="CAMPAIGN",
        type=Path,
        nargs="+",
        help="campaign folder with captures; of several, or of a folder of campaigns, each is diagnosed into "
        "DIR/<campaign>, and one that cannot be stops no other",
    )
    add_calibrations(parser)
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        help="folder for diagnosis.json and what stands beside it; --detectable does without",
    )
    parser.add_argument(
        "--without", metavar="EFFECT", action="append", default=[], help="take an effect out of the catalogue"
    )
    parser.add_argument("--only-runs", metavar="ID,...", default="", help="diagnose these runs only")
    parser.add_argument(
        "--each",
        metavar="FILE",
        type=Path,
        help="what holds for one campaign alone, YAML or JSON: name -> {without: [...], only_runs: [...]}",
    )
    parser.add_argument(
        "--simulated", metavar="CAMPAIGN2", type=Path, help="captures of another simulator as the prediction"
    )
    parser.add_argument(
        "--verify-next",
        action="store_true",
        help="simulate the run that it proposes, with each rival as the truth, and diagnose again",
    )
    parser.add_argument(
        "--detectable",
        action="store_true",
        help="what the campaign would show of each effect and could not tell apart; needs no captures",
    )
    parser.add_argument(
        "--probability",
        metavar="P",
        type=float,
        default=0.95,
        help="--detectable: with which an amplitude is to be seen (default: %(default)s)",
    )
    parser.add_argument(
        "--snr",
        metavar="S",
        type=float,
        default=10.0,
        help="--detectable: signal-to-noise ratio of what is to be told apart (default: %(default)s)",
    )


def run(args: argparse.Namespace) -> int:
    """Diagnose; the verdict on standard output."""
    from fogreduce.cli.many import Own, campaign_folders, diagnose_each, read_each

    if args.out is None and not args.detectable:
        raise BadInput.at("--out", "", found="nothing", expected="a folder for the diagnosis")
    if args.simulated is not None and (args.verify_next or args.detectable):
        option = "--verify-next" if args.verify_next else "--detectable"
        raise BadInput.at(
            option, "", found="with --simulated", expected="our own simulator, which alone can do it"
        )
    several = campaign_folders(args.campaign)
    campaigns = args.campaign if several is None else several
    if several is not None and args.simulated is not None:
        raise BadInput.at("--simulated", "", found=f"{len(several)} campaigns", expected="one campaign")
    own = read_each(args.each, [path.resolve().name for path in campaigns]) if args.each else {}
    only = tuple(name for name in args.only_runs.split(",") if name)

    def one(campaign: Path) -> None:
        name = campaign.resolve().name
        mine = own.get(name, Own())
        out = args.out if several is None or args.out is None else args.out / name
        do = _detectable if args.detectable else _diagnose
        do(campaign, out, (*args.without, *mine.without), mine.only_runs or only, args)

    if several is not None:
        return diagnose_each(several, one)
    one(args.campaign[0])
    return 0


def _diagnose(
    campaign: Path, out: Path, without: Sequence[str], only: Sequence[str], args: argparse.Namespace
) -> None:
    """One campaign; its verdict on standard output."""
    from fogreduce.gap.diagnose import diagnose
    from fogreduce.gap.write import write
    from fogreduce.metadata.folder import load_campaign

    diagnosis = diagnose(campaign, args.calibrations, without, only, args.simulated)
    if args.verify_next:
        _verify_next(diagnosis, campaign, without, only, args)
    write(diagnosis, out, load_campaign(campaign).label)
    causes = ", ".join(f"{c['effect']} {' '.join(c['channels'])}" for c in diagnosis.document["causes"])
    print(f"{out}: {diagnosis.document['verdict']}{': ' if causes else ''}{causes}", flush=True)


def _detectable(
    campaign: Path, out: Path | None, without: Sequence[str], only: Sequence[str], args: argparse.Namespace
) -> None:
    """What a planned campaign would show, on standard output, and into a folder where one is given."""
    from fogreduce.gap.detectable import detectable
    from fogreduce.gap.detectable_write import in_text, write_detectable

    found = detectable(campaign, args.calibrations, args.probability, args.snr, without, only)
    print(in_text(found), flush=True)
    if out is not None:
        write_detectable(found, out)


def _verify_next(
    diagnosis: Diagnosis,
    campaign: Path,
    without: Sequence[str],
    only: Sequence[str],
    args: argparse.Namespace,
) -> None:
    """Add to the document what the proposed run would bring."""
    from fogreduce.gap.verify_next import verified

    found = verified(diagnosis, campaign, args.calibrations, without, only)
    if found is not None:
        diagnosis.document["next_run"]["verified"] = found
