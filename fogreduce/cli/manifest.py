"""``fogreduce manifest RUN --calibrations DIR --out DIR``: the first node of a run in the workflow."""

from __future__ import annotations

import argparse
import json

from fogreduce.cli.reduce import add_arguments as add_arguments
from fogreduce.cli.reduce import manifest_of
from fogreduce.datasets.atomic import write_text

HELP = "write the manifest of a run (a node of the workflow)"


def run(arguments: argparse.Namespace) -> int:
    """Check the run's metadata, hash its inputs and write the manifest."""
    text = json.dumps(manifest_of(arguments), indent=1, allow_nan=False)
    write_text(arguments.out / "manifest.json", text + "\n")
    return 0
