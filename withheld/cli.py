"""The bench's commands.  Each does one rule's work, and works by hand as well."""

import argparse
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from withheld.errors import BadInput


def _protocol(args: argparse.Namespace) -> None:
    from withheld.atomic import write_json
    from withheld.study.batch import check_study
    from withheld.study.protocol import protocol_document, study
    from withheld.study.seal import write_seal

    check_study(args.seed)
    protocol = study(args.study, args.seed)
    if args.cases not in (None, protocol.cases):
        raise BadInput(f"study {args.study}: has {protocol.cases} cases, not {args.cases}")
    write_json(args.out, protocol_document(protocol))
    write_seal(args.out.with_suffix(".sha256"), [args.out], args.out.parent)


def _make(args: argparse.Namespace) -> None:
    from withheld.atomic import read_json
    from withheld.study.batch import batch_plans, make_batch
    from withheld.study.protocol import protocol_from

    protocol = protocol_from(read_json(args.protocol))
    chosen = batch_plans(protocol, args.batch, args.size)
    shutil.rmtree(args.out, ignore_errors=True)
    make_batch(protocol, chosen, args.out, args.labels)


def _inject(args: argparse.Namespace) -> None:
    from dataclasses import replace

    from withheld.chain.campaign import read_campaign
    from withheld.chain.injector import exact_world, realistic_world, write_campaign
    from withheld.chain.temperature import read_log
    from withheld.effects.effects_file import read_effects

    campaign = read_campaign(args.campaign, args.calibrations)
    runs = tuple(run.run_id for run in campaign.runs)
    entries = read_effects(args.effects, campaign.unit.n, runs) if args.effects else ()
    if args.exact:
        world = exact_world(campaign, entries)
        logs = {run: args.campaign / "runs" / run / "temperature.csv" for run in runs}
        read = {run: read_log(path) for run, path in logs.items() if path.exists()}
        world = replace(world, heat=world.heat | read)
    else:
        world = realistic_world(campaign, entries, args.seed)
    write_campaign(world, args.out / "campaigns" / campaign.name, args.out / "calibrations")


def _train(args: argparse.Namespace) -> None:
    from dataclasses import replace

    from withheld.study.batch import check_training, make_batch
    from withheld.study.cases import plans
    from withheld.study.protocol import study

    check_training(args.seed)
    protocol = replace(study(args.study, args.seed), name=f"training-{args.study}")
    chosen = plans(protocol)[: args.first]
    make_batch(protocol, chosen, args.out, args.out / "labels.json")


def _examine(args: argparse.Namespace) -> None:
    from withheld.examine import DIAGNOSER, examine
    from withheld.report.page import tables

    summary = examine(
        args.kind,
        args.seed,
        args.campaigns,
        args.diagnoser or DIAGNOSER,
        args.out,
        args.batch,
        args.keep_captures,
    )
    print("\n".join(tables(summary)))


def _diagnose(args: argparse.Namespace) -> None:
    from withheld.study.run_diagnoser import run_batch

    run_batch(args.diagnoser, args.batch, args.out)


def _candidate(args: argparse.Namespace) -> None:
    from withheld.candidates import diagnose, diagnose_batch

    if args.batch is not None:
        diagnose_batch(args.name, args.batch, args.out)
    elif args.campaign is None or args.calibrations is None:
        raise BadInput("candidate: expected CAMPAIGN and --calibrations DIR, or --batch DIR")
    else:
        diagnose(args.name, args.campaign, args.calibrations, args.out, tuple(args.without))


def _seal(args: argparse.Namespace) -> None:
    from withheld.study.seal import write_seal

    write_seal(args.out, [path for path in args.root.glob(args.files) if path.is_file()], args.root)


def _score(args: argparse.Namespace) -> None:
    from withheld.atomic import write_json
    from withheld.score.scoring import score

    scores = score(
        args.protocol, args.protocol.with_suffix(".sha256"), args.labels, args.labels_seal,
        args.diagnoses, args.diagnoses_seal, args.candidate, args.ledger,
    )  # fmt: skip
    write_json(args.out, scores)


def _report(args: argparse.Namespace) -> None:
    from withheld.atomic import read_json
    from withheld.report.page import write_page

    write_page(read_json(args.scores), args.out)


def _keep(args: argparse.Namespace) -> None:
    from withheld.atomic import read_json

    scores = read_json(args.report / "scores.json")
    place = args.under / f"{scores['study']}-{scores['seed']}-{scores['candidate']}"
    if place.exists():
        raise BadInput(f"{place}: already kept")
    args.under.mkdir(parents=True, exist_ok=True)
    partial = place.with_name(f".{place.name}.part")
    shutil.copytree(args.report, partial, dirs_exist_ok=True)
    partial.rename(place)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="withheld", description=__doc__)
    commands = parser.add_subparsers(dest="command", required=True)

    one = commands.add_parser("protocol", help="fix a study and seal it, before any label exists")
    one.add_argument("--study", required=True, help="small, quarter, full or whole")
    one.add_argument("--seed", type=int, required=True)
    one.add_argument("--cases", type=int, help="how many cases are expected; another number is an error")
    one.add_argument("--out", type=Path, required=True)
    one.set_defaults(do=_protocol)

    one = commands.add_parser("make", help="campaigns and sealed labels of one batch")
    one.add_argument("--protocol", type=Path, required=True)
    one.add_argument("--batch", type=int, required=True)
    one.add_argument("--size", type=int, required=True)
    one.add_argument("--out", type=Path, required=True)
    one.add_argument("--labels", type=Path, required=True)
    one.set_defaults(do=_make)

    one = commands.add_parser(
        "inject", help="captures for a campaign's metadata, with an effects file in them"
    )
    one.add_argument("campaign", type=Path)
    one.add_argument("--calibrations", type=Path, required=True)
    one.add_argument("--effects", type=Path)
    one.add_argument("--seed", type=int, default=0)
    one.add_argument("--exact", action="store_true", help="the catalogue's shapes, no noise, nothing drawn")
    one.add_argument("--out", type=Path, required=True)
    one.set_defaults(do=_inject)

    one = commands.add_parser("train", help="campaigns with open labels, for tuning; never a study's")
    one.add_argument("--study", default="full", help="whose mixture of cases")
    one.add_argument("--seed", type=int, required=True)
    one.add_argument("--first", type=int, required=True, help="how many cases of it")
    one.add_argument("--out", type=Path, required=True)
    one.set_defaults(do=_train)

    one = commands.add_parser(
        "examine", help="one kind of campaigns, made, diagnosed and scored, open labels"
    )
    one.add_argument(
        "kind", help="a class (stale, strong, ...) or a kind of the first studies (nothing, ...)"
    )
    one.add_argument("--seed", type=int, required=True, help="a training seed, below every study's")
    one.add_argument("--campaigns", type=int, required=True)
    one.add_argument("--diagnoser", default=None, help="as for diagnose; default: fogreduce diagnose")
    one.add_argument("--batch", type=int, default=4, help="campaigns whose captures lie on disk at once")
    one.add_argument("--keep-captures", action="store_true")
    one.add_argument("--out", type=Path, required=True)
    one.set_defaults(do=_examine)

    one = commands.add_parser("diagnose", help="run a diagnoser over a batch")
    one.add_argument(
        "--diagnoser", required=True, help="command with {campaign} {calibrations} {out}, or {batch} {out}"
    )
    one.add_argument("--batch", type=Path, required=True)
    one.add_argument("--out", type=Path, required=True)
    one.set_defaults(do=_diagnose)

    one = commands.add_parser("candidate", help="a diagnoser that knows nothing")
    one.add_argument("name")
    one.add_argument("campaign", type=Path, nargs="?")
    one.add_argument("--calibrations", type=Path)
    one.add_argument("--batch", type=Path)
    one.add_argument("--out", type=Path, required=True)
    one.add_argument("--without", action="append", default=[])
    one.set_defaults(do=_candidate)

    one = commands.add_parser("seal", help="hashes of files, as sha256sum writes them")
    one.add_argument("--root", type=Path, required=True)
    one.add_argument("--files", required=True, help="pattern under the root")
    one.add_argument("--out", type=Path, required=True)
    one.set_defaults(do=_seal)

    one = commands.add_parser("score", help="score a study, once")
    one.add_argument("--protocol", type=Path, required=True)
    one.add_argument("--labels", type=Path, required=True)
    one.add_argument("--labels-seal", type=Path, required=True)
    one.add_argument("--diagnoses", type=Path, required=True)
    one.add_argument("--diagnoses-seal", type=Path, required=True)
    one.add_argument("--candidate", required=True)
    one.add_argument("--ledger", type=Path, required=True)
    one.add_argument("--out", type=Path, required=True)
    one.set_defaults(do=_score)

    one = commands.add_parser("report", help="figures and the page")
    one.add_argument("--scores", type=Path, required=True)
    one.add_argument("--out", type=Path, required=True)
    one.set_defaults(do=_report)

    one = commands.add_parser("keep", help="keep a report under docs/")
    one.add_argument("--report", type=Path, required=True)
    one.add_argument("--under", type=Path, required=True)
    one.set_defaults(do=_keep)
    return parser


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command; 2 after bad input, with one line on standard error."""
    args = _parser().parse_args(arguments)
    try:
        args.do(args)
    except BadInput as error:
        print(f"withheld: {error}", file=sys.stderr)
        return 2
    return 0
