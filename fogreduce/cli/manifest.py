"""``fogreduce manifest RUN --calibrations DIR --out DIR``: the first node of a run in the workflow."""

from __future__ import annotations

import argparse

from fogreduce.cli.reduce import add_arguments as add_arguments
from fogreduce.cli.reduce import manifest_job

HELP = "write the manifest of a run (a node of the workflow)"


def run(arguments: argparse.Namespace) -> int:
    """Check the run's metadata, hash its inputs and write the manifest."""
    job = manifest_job(arguments)
    from fogreduce.datasets.atomic import write_text
    from fogreduce.stages.setup import MANIFEST

    import json

    write_text(arguments.out / MANIFEST, json.dumps(job.manifest(), indent=1, allow_nan=False) + "\n")
    return 0
