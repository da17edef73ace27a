"""``fogreduce restore BAG --out DIR``: a working folder again; ``--compare RESULTS``: is it the same?"""

from __future__ import annotations

import argparse
from pathlib import Path

from fogreduce.errors import BadInput


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("bag", type=Path, metavar="BAG", help="the bag's folder")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--out", type=Path, metavar="DIR", help="the folder to be made")
    what.add_argument(
        "--compare",
        type=Path,
        metavar="RESULTS",
        help="results that were made anew: compare their tables and datasets with the archived ones",
    )
    parser.add_argument("--expect", metavar="SHA256", help="what `fogreduce archive` printed")


def run(arguments: argparse.Namespace) -> int:
    """Restore, or compare."""
    if arguments.compare is not None:
        return _compare(arguments.bag, arguments.compare, arguments.expect)
    from fogreduce.archive.restore import ARCHIVED, restore
    from fogreduce.archive.verify import listed
    from fogreduce.datasets.sole_writer import sole_writer
    from fogreduce.progress import progress

    out = arguments.out
    with sole_writer(out), progress(2 * sum(listed(arguments.bag).sizes.values()), "B") as advance:
        found, note = restore(arguments.bag, out, arguments.expect, advance)
    print(f"{out}: {found.campaign}, verified; archived results in {out / ARCHIVED}")
    if note is not None:
        print(note)
    print(f"to redo it: cd {out} && make reduce; or, where its environment is at hand, snakemake")
    print(f"then: fogreduce restore {arguments.bag} --compare {out / 'results'}")
    return 0


def _compare(bag: Path, results: Path, expect: str | None) -> int:
    from fogreduce.archive.verify import verify
    from fogreduce.provenance.compare import TOLERANCE, compare_run, runs_to_compare

    # What is not what it was proves nothing, and its datasets are not to be opened.
    faults = list(verify(bag, expect).faults)
    if faults:
        raise BadInput(*faults)
    for archived, new in runs_to_compare(bag / "data" / "results", results):
        found = compare_run(archived, new)
        faults += found.faults
        if not found.differing:
            tables = f"{found.tables} tables, byte for byte the archived ones"
        else:
            names = ", ".join(found.differing)
            how = "within" if found.worst <= TOLERANCE else "beyond"
            tables = (
                f"{names} differ, {how} {TOLERANCE:g} of the standard uncertainty (at most {found.worst:.2g})"
            )
        print(f"{found.run}: {tables}; datasets {found.datasets}")
        for cause in found.causes:
            print(f"  {cause}")
    if faults:
        raise BadInput(*faults)
    return 0
