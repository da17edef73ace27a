"""``fogreduce impact RECORD``: every result that used a calibration record."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from fogreduce.cli.options import add_calibrations
from fogreduce.errors import BadInput


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("record", metavar="UNIT@VERSION", help="the record")
    parser.add_argument(
        "--results",
        type=Path,
        default=Path("results"),
        metavar="DIR",
        help="folder of the results (default: %(default)s)",
    )
    parser.add_argument("--format", choices=("text", "json"), default="text", help="(default: %(default)s)")
    add_calibrations(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print what used the record; exit status 0 also where nothing did."""
    from fogreduce.calibrate.impact import impact
    from fogreduce.metadata.folder import is_name

    unit, at, version = arguments.record.partition("@")
    if not (at and is_name(unit) and is_name(version)):
        raise BadInput.at("RECORD", "", found=arguments.record, expected="<unit>@<version>")
    found = impact(arguments.record, arguments.results, arguments.calibrations)
    if arguments.format == "json":
        print(json.dumps(found, indent=1, ensure_ascii=False))
        return 0
    runs = found["runs"]
    print(
        f"{arguments.record}: {len(runs) or 'no'} run{'' if len(runs) == 1 else 's'} in {arguments.results}"
    )
    for key, words in (("runs", ""), ("of_runs", ""), ("records", "record "), ("kept", "kept: ")):
        for name in found[key]:
            print(f"  {words}{name}")
    return 0
