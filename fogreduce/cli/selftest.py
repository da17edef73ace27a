"""``fogreduce selftest``: published numbers through the installed software, expected beside obtained."""

from __future__ import annotations

import argparse
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "--out",
        type=Path,
        default=Path("results/_selftest"),
        metavar="DIR",
        help="folder of the page (default: %(default)s, which archives take up)",
    )


def run(arguments: argparse.Namespace) -> int:
    """Compute, write, say; 1 where a number does not agree."""
    from fogreduce.metadata.raw_folder import refuse_raw
    from fogreduce.selftest.run import checks, write

    refuse_raw("--out", arguments.out)
    found = checks()
    written = write(found, arguments.out)
    for one in found:
        if not one.good:
            print(f"{one.group}, {one.what}: expected {one.expected:.10g}, obtained {one.obtained:.10g}")
    failed = sum(not one.good for one in found)
    print(f"{len(found)} published numbers, {failed} of them do not agree: {written[-1]}")
    return 1 if failed else 0
