"""``fogreduce simulate``: a capture for every run of a campaign, by the forward physics."""

from __future__ import annotations

import argparse
from pathlib import Path

from fogreduce.errors import BadInput

HELP = "simulate the captures of a campaign's runs, with or without effects"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "campaign", metavar="CAMPAIGN", type=Path, help="campaign folder; captures are not needed"
    )
    parser.add_argument(
        "--calibrations",
        metavar="DIR",
        type=Path,
        default=Path("calibrations"),
        help="folder of the calibration records (default: %(default)s)",
    )
    parser.add_argument("--out", metavar="DIR", type=Path, help="becomes a campaign folder with the captures")
    parser.add_argument(
        "--effects", metavar="FILE", type=Path, help="effects to put in (fogreduce/effects/1)"
    )
    parser.add_argument(
        "--seed", metavar="N", type=int, help="seed of the noise (default: campaign.yaml's, else 0)"
    )
    parser.add_argument("--no-noise", action="store_true", help="no noise: only rounding is left")
    parser.add_argument(
        "--draw-uncertainties",
        action="store_true",
        help="draw the stated uncertainties; DIR.injected.yaml says what",
    )
    parser.add_argument("--only-runs", metavar="ID,...", default="", help="simulate these runs only")


def run(args: argparse.Namespace) -> int:
    """Simulate; what was made on standard output."""
    from fogreduce.cli.progress import progress
    from fogreduce.simulate.campaign import write_campaign
    from fogreduce.simulate.plan import Options, prepare

    if args.out is None:
        raise BadInput.at("--out", "", found="nothing", expected="a folder for the campaign")
    if args.seed is not None and args.seed < 0:
        raise BadInput.at("--seed", "", found=args.seed, expected="a whole number, 0 or more")
    options = Options(
        effects_file=args.effects,
        seed=args.seed,
        noise=not args.no_noise,
        draw_uncertainties=args.draw_uncertainties,
        only_runs=tuple(name for name in args.only_runs.split(",") if name),
    )
    plan = prepare(args.campaign, args.calibrations, options)
    with progress(plan.n_records, "records") as told:
        write_campaign(plan, args.out, told)
    print(f"{args.out}: {len(plan.chosen)} captures simulated")
    return 0
