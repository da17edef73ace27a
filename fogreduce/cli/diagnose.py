"""``fogreduce diagnose``: where a campaign departs from its prediction, which effect causes it, how far it
closes.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fogreduce.cli.options import add_calibrations, add_part, read_part, run_ids
from fogreduce.errors import BadInput
from fogreduce.metadata.raw_folder import refuse_raw

if TYPE_CHECKING:
    pass

_PROBABILITY, _SNR = 0.95, 10.0


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
    parser.add_argument("--only-runs", metavar="ID,...", help="diagnose these runs only")
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
        "--bench",
        metavar="FILE",
        type=Path,
        help="what table and chamber can do (fogreduce/bench/1): the run that it proposes stays within it",
    )
    add_part(parser)
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
        help=f"--detectable: with which an amplitude is to be seen (default: {_PROBABILITY})",
    )
    parser.add_argument(
        "--snr",
        metavar="S",
        type=float,
        help=f"--detectable: signal-to-noise ratio of what is to be begin apart (default: {_SNR:g})",
    )


def run(args: argparse.Namespace) -> int:
    """Diagnose; the verdict on standard output."""
    from fogreduce.cli.many import OfCampaign, campaign_folders, diagnose_each, read_each
    from fogreduce.datasets.sole_writer import sole_writer

    if args.out is None and not args.detectable:
        raise BadInput.at("--out", "", found="nothing", expected="a folder for the diagnosis")
    if args.simulated is not None and (args.verify_next or args.detectable):
        option = "--verify-next" if args.verify_next else "--detectable"
        raise BadInput.at(
            option, "", found="with --simulated", expected="our own simulator, which alone can do it"
        )
    _refuse_idle(args)
    several = campaign_folders(args.campaign)
    campaigns = args.campaign if several is None else several
    if several is not None and args.simulated is not None:
        raise BadInput.at("--simulated", "", found=f"{len(several)} campaigns", expected="one campaign")
    by_campaign = read_each(args.each, [path.resolve().name for path in campaigns]) if args.each else {}
    only = run_ids(args.only_runs)

    def one(campaign: Path) -> None:
        name = campaign.resolve().name
        mine = by_campaign.get(name, OfCampaign())
        out = args.out if several is None or args.out is None else args.out / name
        if out is not None:
            refuse_raw("--out", out)
        do = _detectable if args.detectable else _diagnose
        with sole_writer(out) if out is not None else nullcontext():
            do(campaign, out, (*args.without, *mine.without), mine.only_runs or only, args)

    if several is not None:
        return diagnose_each(several, one)
    one(args.campaign[0])
    return 0


def _refuse_idle(args: argparse.Namespace) -> None:
    """Options that would change nothing as they are given."""
    if args.detectable and args.bench:
        raise BadInput.at("--bench", "", found="with --detectable", expected="a run to be proposed")
    if args.detectable and args.verify_next:
        raise BadInput.at("--verify-next", "", found="with --detectable", expected="one of the two")
    for option, value in (("--probability", args.probability), ("--snr", args.snr)):
        if value is not None and not args.detectable:
            raise BadInput.at(option, "", found="no --detectable", expected="both, or neither")


def _steps(names: Sequence[str], args: argparse.Namespace) -> AbstractContextManager[Callable[[str], None]]:
    """Progress through one campaign; of several, their number is shown already."""
    from fogreduce.cli.many import campaign_folders
    from fogreduce.progress import steps

    if campaign_folders(args.campaign) is not None:
        return nullcontext(lambda name: None)
    return steps(names)


def _diagnose(
    campaign: Path, out: Path, without: Sequence[str], only: Sequence[str], args: argparse.Namespace
) -> None:
    """One campaign; its verdict on standard output."""
    from fogreduce.cli.many import campaign_folders
    from fogreduce.diagnosis.diagnose import STEPS, diagnose
    from fogreduce.diagnosis.next.verify import verified
    from fogreduce.diagnosis.report.words import announced, captures_in_words, in_detail
    from fogreduce.diagnosis.report.write import write
    from fogreduce.metadata.bench import Bench
    from fogreduce.metadata.folder import load_campaign

    bench = Bench() if args.bench is None else Bench.from_yaml(args.bench)
    part = read_part(args.part)
    names = (*STEPS, *(["verification"] if args.verify_next else []), "page")
    with _steps(names, args) as begin:
        diagnosis = diagnose(campaign, args.calibrations, without, only, args.simulated, begin, bench, part)
        if args.verify_next:
            begin("verification")
            found = verified(diagnosis, campaign, args.calibrations, without, only, part)
            if found is not None:
                diagnosis.document["next_run"]["verified"] = found
        begin("page")
        write(diagnosis, out, load_campaign(campaign).label)
    for line in captures_in_words(diagnosis.document):
        print(f"{campaign}: {line}", file=sys.stderr, flush=True)
    print(f"{out}: {announced(diagnosis.document)}", flush=True)
    if campaign_folders(args.campaign) is None:
        lines = in_detail(diagnosis.document) + _of_next_run(diagnosis.document["next_run"], out)
        print("".join(f"  {line}\n" for line in lines), end="", flush=True)


def _of_next_run(found: Mapping[str, Any] | None, out: Path) -> list[str]:
    """What to run next, where its file is, and what trying it showed."""
    from fogreduce.diagnosis.report.next_run import RUN_FILE, motion

    if found is None:
        return []
    lines = [f"next run: {motion(found)}: {out / RUN_FILE}"]
    if "verified" in found:
        says = (
            "tells its rivals apart" if found["verified"]["separated"] else "does not tell its rivals apart"
        )
        lines.append(f"the next run, simulated with each rival as the truth, {says}")
    return lines


def _detectable(
    campaign: Path, out: Path | None, without: Sequence[str], only: Sequence[str], args: argparse.Namespace
) -> None:
    """What a planned campaign would show, on standard output, and into a folder where one is given."""
    from fogreduce.diagnosis.next.detectable import detectable
    from fogreduce.diagnosis.next.detectable_write import in_text, write_detectable

    probability = _PROBABILITY if args.probability is None else args.probability
    snr = _SNR if args.snr is None else args.snr
    with _steps(["what would be seen"], args):
        found = detectable(campaign, args.calibrations, probability, snr, without, only, read_part(args.part))
    print(in_text(found), flush=True)
    if out is not None:
        write_detectable(found, out)
