"""``fogreduce trace BAG|RESULTS drift.csv:x:drift_deg_h``: where one number comes from."""

from __future__ import annotations

import argparse
from pathlib import Path

from fogreduce.cli.options import add_places


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("place", type=Path, metavar="BAG|RESULTS", help="a bag, or a folder of results")
    parser.add_argument(
        "cell",
        metavar="CELL",
        help="[run:]table.csv:row[@segment]:column, for instance 1-x-plus:drift.csv:x:drift_deg_h",
    )
    parser.add_argument(
        "--format",
        choices=("text", "json", "prov"),
        default="text",
        help="text, json, or prov (PROV-JSON) (default: %(default)s)",
    )
    add_places(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the chain; every input, the record, the manifest and the table are hashed on the way."""
    from fogreduce.provenance.cell import CellName
    from fogreduce.trace.chain import trace
    from fogreduce.trace.places import one_run, run_places
    from fogreduce.trace.text import trace_text

    name = CellName.parse(arguments.cell)
    places = run_places(arguments.place, arguments.campaigns, arguments.calibrations)
    found = trace(one_run(places, name.run, arguments.place, "RUN:table.csv:row:column"), name)
    if arguments.format == "text":
        print(trace_text(found), end="")
        return 0
    import json

    if arguments.format == "prov":
        from fogreduce.trace.prov import prov

        found = prov(found)
    print(json.dumps(found, indent=1, ensure_ascii=False))
    return 0
