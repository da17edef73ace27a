"""``fogreduce archive RESULTS --out DIR``: a bag for each campaign, with all that is needed to redo it."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from fogreduce.cli.options import add_places
from fogreduce.errors import BadInput


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("results", type=Path, metavar="RESULTS", help="folder of the results")
    parser.add_argument(
        "--out", type=Path, required=True, metavar="DIR", help="folder for the bags, DIR/<campaign>"
    )
    add_places(parser)
    parser.add_argument(
        "--only", metavar="NAME,...", help="campaigns to archive (default: all that have results)"
    )
    parser.add_argument(
        "--by-digest",
        action="store_true",
        help="name each bag DIR/<campaign>-<first digits of its digest>; what is there already stays",
    )
    parser.add_argument(
        "--source",
        type=Path,
        metavar="DIR",
        help="folder of fogreduce's source (default: the one that runs)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Archive; each bag with the SHA-256 of its tag manifest on standard output."""
    from fogreduce.archive.contents import campaigns_in, contents
    from fogreduce.archive.software import source_folder
    from fogreduce.archive.write import write_bag
    from fogreduce.datasets.sole_writer import sole_writer
    from fogreduce.progress import progress

    source = source_folder(arguments.source)
    found = campaigns_in(arguments.results)
    names = arguments.only.split(",") if arguments.only is not None else found
    if missing := [name for name in names if name not in found]:
        raise BadInput.at("--only", "", found=missing[0] or "nothing", expected=", ".join(found) or "results")
    if not names:
        raise BadInput.at(arguments.results, "", found="no reduced run", expected="<campaign>/<run> in it")
    with sole_writer(arguments.out):
        for name in names:
            left_out = _left_out(arguments.results, arguments.campaigns, name)
            for run_id, reason in left_out.items():
                print(f"{name}: without results of {run_id}: {reason}", file=sys.stderr)
            planned = contents(
                arguments.results, name, arguments.campaigns, arguments.calibrations, source, left_out
            )
            total = sum(item.source.stat().st_size for item in planned.items)
            index = _index(arguments.results / name, arguments.campaigns / name)
            with progress(total, "B") as advance:
                digest, bag = write_bag(
                    planned, arguments.out / name, advance, by_digest=arguments.by_digest, index=index
                )
            print(f"{digest}  {bag}")
    return 0


def _index(folder: Path, campaign: Path) -> str | None:
    """The page over all campaigns, of this one alone; None where the campaign has no page."""
    from fogreduce.pages.gather import gather
    from fogreduce.pages.index_page import index_page

    gathered = gather(folder, campaign)
    return index_page([gathered]) if gathered.page else None


def _left_out(results: Path, campaigns: Path, campaign: str) -> dict[str, str]:
    """Runs of a campaign that failed, and those that were taken out of it since: run -> why.

    A run with tables and no checksums has not failed: it is for the archive to refuse.
    """
    from fogreduce.metadata.folder import find_runs
    from fogreduce.provenance.manifest_file import MANIFEST, OUTPUTS
    from fogreduce.stages.summary import RunResults, why_not_reduced

    if not (campaigns / campaign / "runs").is_dir():
        return {}
    runs = {run.name for run in find_runs(campaigns / campaign)[0]}
    found = {}
    for run_id in sorted(runs):
        folder = results / campaign / run_id
        if not (folder / OUTPUTS).is_file() and (
            reason := why_not_reduced(RunResults(folder, campaign, run_id))
        ):
            # A bag has no paths of the machine that it was made on.
            for path, name in ((campaigns, "campaigns"), (results, "results")):
                reason = reason.replace(f"{path}/", f"{name}/")
            found[run_id] = reason
    for manifest in (results / campaign).glob(f"*/{MANIFEST}"):
        if (run_id := manifest.parent.name) not in runs and not (
            campaigns / campaign / "runs" / run_id
        ).exists():
            found[run_id] = "taken out of the campaign since it was reduced"
    return found
