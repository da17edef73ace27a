"""``fogreduce verify BAG [--expect SHA256]``: is every byte what it was, and does all of it agree?"""

from __future__ import annotations

import argparse
import re
import sys
from pathlib import Path

from fogreduce.errors import BadInput


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("bag", type=Path, metavar="BAG", help="the bag's folder")
    parser.add_argument(
        "--expect",
        metavar="SHA256",
        help="what `fogreduce archive` printed: the SHA-256 of the bag's tag manifest",
    )


def run(arguments: argparse.Namespace) -> int:
    """Verify; every fault is named, a line each."""
    expect = arguments.expect
    if expect is not None and not re.fullmatch(r"[0-9a-f]{64}", expect):
        raise BadInput.at("--expect", "", found=expect, expected="64 hexadecimal digits in lower case")
    from fogreduce.archive.verify import listed, verify
    from fogreduce.archive.write import RECORD
    from fogreduce.progress import progress

    with progress(sum(listed(arguments.bag).sizes.values()), "B") as advance:
        found = verify(arguments.bag, expect, advance)
    if found.faults:
        raise BadInput(*found.faults)
    if found.unusual:
        print(f"{arguments.bag}: valid, though unusual: {'; '.join(found.unusual)}", file=sys.stderr)
    how = "all as archived" if found.ours else f"all as its manifests list them; no {RECORD}, so no records"
    print(f"{found.digest or '-'}  {arguments.bag}: {found.files} files, {found.bytes} bytes, {how}")
    return 0
