"""The archive of one campaign: its contents planned, copied into a bag, described, sealed."""

from __future__ import annotations

import json
from importlib.metadata import version
from pathlib import Path

import fogreduce
from fogreduce.archive.bag import BagWriter
from fogreduce.archive.contents import PAGE, Contents
from fogreduce.archive.crate import CRATE, crate
from fogreduce.errors import BadInput, Fault
from fogreduce.progress import Progress, silent
from fogreduce.provenance.code import digest_of, reduction_parts

RECORD = "archive.json"
RECORD_SCHEMA = "fogreduce/archive/1"
#: How the value of Bag-Software-Agent begins in bag-info.txt.
AGENT = "fogreduce "
_PACKAGE = "software/fogreduce/"


def write_bag(
    contents: Contents,
    target: Path,
    progress: Progress = silent,
    *,
    by_digest: bool = False,
    index: str | None = None,
) -> tuple[str, Path]:
    """Write the bag of a campaign; returns the SHA-256 of its tag manifest, and the bag's folder.

    The parameters are those of `fogreduce.archive.bag.BagWriter`, and `index`: the page over all
    campaigns, of this one alone, to which the pages in the bag link.

    Raises
    ------
    BadInput
        The bag is there already; a file is not what the records say; the source is not the code that the
        results come from.
    """
    with BagWriter(target, progress, by_digest=by_digest) as bag:
        # The source first: where it is the wrong one, that is known before a capture is copied.
        bag.add(item for item in contents.items if item.path.startswith("software/"))
        sources = {
            item.path.removeprefix(_PACKAGE): item.source
            for item in contents.items
            if item.path.startswith(_PACKAGE) and item.path.endswith(".py")
        }
        parts = reduction_parts()
        code = digest_of(sources, parts)
        _same_code(contents, code)
        bag.add(item for item in contents.items if not item.path.startswith("software/"))
        if index is not None:
            bag.add_text(f"results/{PAGE}", index)
        record = {
            "schema": RECORD_SCHEMA,
            "campaign": contents.campaign,
            "software": {"fogreduce": fogreduce.__version__, "code_sha256": code},
            "code_parts": parts,
            "runs": [
                {
                    "run_id": run.manifest.run_id,
                    "version_id": run.manifest.version_id,
                    "inputs": run.inputs,
                    "results": run.results,
                }
                for run in contents.runs
            ],
        }
        about = f"fogreduce archive of the campaign {contents.campaign}"
        if contents.left_out:
            record["left_out"] = [{"run_id": name, "reason": why} for name, why in contents.left_out.items()]
            about += f", without results of {', '.join(contents.left_out)}"
        bag.add_text(RECORD, json.dumps(record, indent=1) + "\n")
        versions = {"fogreduce": fogreduce.__version__, "snakemake": version("snakemake")}
        bag.add_text(CRATE, crate(contents, bag.hashes, bag.sizes, versions))
        digest = bag.finish(
            {
                "Bag-Software-Agent": f"{AGENT}{fogreduce.__version__}",
                "External-Description": about,
                "External-Identifier": contents.campaign,
            }
        )
        return digest, bag.target


def _same_code(contents: Contents, code: str) -> None:
    faults = []
    for run in contents.runs:
        if (found := run.manifest.software.get("code_sha256")) != code:
            expected = f"{code}, the code of the source: reduce again, or name the right --source"
            faults.append(Fault(f"{run.results}/manifest.json", "software.code_sha256", str(found), expected))
    if faults:
        raise BadInput(*faults[:1])
