"""``fogreduce simulate``: a capture for every run of a campaign, by the forward physics."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from fogreduce.cli.options import add_calibrations, add_part, read_part, run_ids
from fogreduce.errors import BadInput

if TYPE_CHECKING:
    from fogreduce.simulate.plan import Plan


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the command's arguments."""
    parser.add_argument(
        "campaign", metavar="CAMPAIGN", type=Path, help="campaign folder; captures are not needed"
    )
    add_calibrations(parser)
    parser.add_argument(
        "--out",
        metavar="DIR",
        type=Path,
        help="becomes a campaign folder with the captures; DIR.injected.yaml beside it says what was put in",
    )
    parser.add_argument(
        "--effects", metavar="FILE", type=Path, help="effects to put in (fogreduce/effects/1)"
    )
    add_part(parser)
    parser.add_argument(
        "--seed", metavar="N", type=int, help="seed of the noise (default: campaign.yaml's, else 0)"
    )
    parser.add_argument("--no-noise", action="store_true", help="no noise: only rounding is left")
    parser.add_argument(
        "--draw-uncertainties",
        action="store_true",
        help="draw the stated uncertainties; DIR.injected.yaml, beside DIR, says what",
    )
    parser.add_argument(
        "--no-captures", action="store_true", help="write DIR/campaign.yaml alone (a node of the workflow)"
    )
    parser.add_argument("--only-runs", metavar="ID,...", help="simulate these runs only")
    parser.add_argument(
        "--overwrite", action="store_true", help="write over the captures of an earlier simulation in DIR"
    )
    parser.add_argument(
        "--export-model",
        metavar="FILE",
        type=Path,
        help="write the unit's model as JSON, with its attitude error",
    )
    parser.add_argument(
        "--diagnosis",
        metavar="FILE",
        type=Path,
        help="diagnosis.json whose causes the exported model takes up",
    )


def run(args: argparse.Namespace) -> int:
    """Simulate, or export the model, or both; what was made on standard output."""
    from fogreduce.simulate.plan import Options, prepare

    if args.out is None and args.export_model is None:
        raise BadInput.at("--out", "", found="nothing", expected="a folder for the campaign")
    if args.no_captures and args.out is None:
        raise BadInput.at("--no-captures", "", found="no --out", expected="both, or neither")
    if args.diagnosis is not None and args.export_model is None:
        raise BadInput.at("--diagnosis", "", found="no --export-model", expected="both, or --effects")
    if args.seed is not None and args.seed < 0:
        raise BadInput.at("--seed", "", found=args.seed, expected="a whole number, 0 or more")
    if args.no_captures:
        _write_campaign_yaml(args.campaign, args.out)
        return 0
    options = Options(
        effects_file=args.effects,
        seed=args.seed,
        noise=not args.no_noise,
        draw_uncertainties=args.draw_uncertainties,
        only_runs=run_ids(args.only_runs),
        part=read_part(args.part),
    )
    plan = prepare(args.campaign, args.calibrations, options)
    if args.export_model is not None:
        _export(plan, args)
    if args.out is not None:
        _simulate(plan, args.out, args.overwrite)
    return 0


def _export(plan: Plan, args: argparse.Namespace) -> None:
    from fogreduce.datasets.atomic import write_text
    from fogreduce.simulate.export_model import model_text

    write_text(args.export_model, model_text(plan, args.diagnosis))
    print(f"{args.export_model}: model of {next(iter(plan.records))}")


def _write_campaign_yaml(campaign: Path, out: Path) -> None:
    from fogreduce.datasets.sole_writer import sole_writer
    from fogreduce.simulate.campaign import write_campaign_yaml

    with sole_writer(out):
        write_campaign_yaml(campaign, out)


def _simulate(plan: Plan, out: Path, overwrite: bool) -> None:
    from fogreduce.datasets.sole_writer import sole_writer
    from fogreduce.progress import progress
    from fogreduce.simulate.campaign import write_campaign

    with sole_writer(out), progress(plan.n_records, "records") as advance:
        write_campaign(plan, out, advance, overwrite)
    print(f"{out}: {len(plan.chosen)} captures simulated")
