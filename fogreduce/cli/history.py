"""``fogreduce history RUN``: the versions of a run's results, and what changed between them."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from fogreduce.cli.options import add_places

_SHOWN = 20


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument(
        "place", type=Path, metavar="RUN", help="a run's results folder; or a bag or results, with --run"
    )
    parser.add_argument("--run", metavar="NAME", help="the run, where the folder holds several")
    parser.add_argument("--all", action="store_true", help=f"every cell that changed, not only {_SHOWN}")
    parser.add_argument("--format", choices=("text", "json"), default="text", help="(default: %(default)s)")
    add_places(parser)


def run(arguments: argparse.Namespace) -> int:
    """Print the history; the kept tables are held against their checksums on the way."""
    from fogreduce.provenance.history import history
    from fogreduce.trace.places import one_run, run_places

    places = run_places(arguments.place, arguments.campaigns, arguments.calibrations)
    found = history(one_run(places, arguments.run, arguments.place, "--run NAME").results)
    if arguments.format == "json":
        import json

        print(json.dumps(found, indent=1, ensure_ascii=False))
        return 0
    print(f"{found['run']}, now version {found['now']}")
    for item in found["versions"]:
        print(f"  version {item['number']}  {item['version_id']}  {item['folder']}")
    for item in found["changes"]:
        _print_change(item, None if arguments.all else _SHOWN)
    return 0


def _print_change(change: dict[str, Any], limit: int | None) -> None:
    print(f"\nfrom version {change['from']} to {change['to']}")
    for cause in change["causes"] or ["no cause recorded: same inputs, code, libraries and parameters"]:
        print(f"  because  {cause}")
    for line in change["tables"]:
        print(f"  {line}")
    cells = change["cells"]
    print(f"  {len(cells)} cells changed, {change['unchanged']} did not")
    for cell in cells[:limit]:
        moved = f"  ({cell['sigma']:.3g} standard errors)" if cell["sigma"] is not None else ""
        print(f"    {cell['cell']}: {_said(cell, 'old')} -> {_said(cell, 'new')}{moved}")
    if limit is not None and len(cells) > limit:
        print(f"    and {len(cells) - limit} more, with --all")


def _said(cell: dict[str, Any], which: str) -> str:
    value = cell[which]
    if value is None:
        return "none"
    error = next((text for text in cell[f"{which}_uncertainty"].values() if text), None)
    return (value or "empty") + (f" ± {float(error):.3g}" if error else "")
