"""``fogreduce checksums DIR``: the last node of a run: what the results are, and a copy that stays."""

from __future__ import annotations

import argparse
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("results", type=Path, metavar="DIR", help="the run's results folder")
    parser.add_argument("--no-keep", action="store_true", help="do not keep this version in DIR/versions")


def run(arguments: argparse.Namespace) -> int:
    """Write outputs.json, then keep the version beside older ones."""
    from fogreduce.datasets.sole_writer import sole_writer
    from fogreduce.progress import progress
    from fogreduce.provenance.outputs import results_bytes, write_checksums
    from fogreduce.provenance.versions import keep

    with sole_writer(arguments.results):
        with progress(results_bytes(arguments.results), "bytes") as advance:
            data = write_checksums(arguments.results, advance)
        print(f"{len(data['files'])} files, version {data['version_id']}")
        if not arguments.no_keep:
            print(f"kept as {keep(arguments.results, data).folder}")
    return 0
