"""``fogreduce derive-calibration CAMPAIGN --out DIR``: a calibration record from the campaign itself."""

from __future__ import annotations

import argparse
from pathlib import Path

from fogreduce.cli.options import add_calibrations
from fogreduce.errors import BadInput


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("campaign", type=Path, metavar="CAMPAIGN", help="the campaign's folder")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for what is derived")
    version = parser.add_mutually_exclusive_group()
    version.add_argument(
        "--record-version",
        metavar="VERSION",
        help="version of the candidate record (default: the present one's with -derived after it)",
    )
    version.add_argument(
        "--by-digest",
        action="store_true",
        help="a version with a digest of the record's content in it, so that older candidates stay",
    )
    parser.add_argument(
        "--only-runs", metavar="ID,...", default="", help="runs to use, by id (default: all of them)"
    )
    add_calibrations(parser)


def run(args: argparse.Namespace) -> int:
    """Derive; write candidate record, certificates, document and page; a summary on standard output."""
    from fogreduce.calibrate.derive import derive
    from fogreduce.calibrate.document import summary
    from fogreduce.calibrate.write import write_derivation
    from fogreduce.metadata.folder import is_name
    from fogreduce.metadata.raw_folder import refuse_raw

    refuse_raw("--out", args.out)
    found = derive(args.campaign, args.calibrations, [name for name in args.only_runs.split(",") if name])
    present = found.readings[0].record
    version = args.record_version or f"{present.version}-derived"
    if not args.by_digest and (not is_name(version) or version == present.version):
        expected = f"a name of its own, other than {present.version}"
        raise BadInput.at("--record-version", "", found=version, expected=expected)
    data, paths = write_derivation(
        found, args.campaign, args.calibrations, None if args.by_digest else version, args.out
    )
    print(summary(data))
    print(f"{args.out}: {', '.join(['derivation.json', 'index.html', *map(str, paths)])}")
    return 0
