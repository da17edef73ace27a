"""``fogreduce manifest RUN --calibrations DIR --out DIR``: the first node of a run in the workflow."""

from __future__ import annotations

import argparse
import json

from fogreduce.cli.reduce import add_arguments as add_arguments
from fogreduce.cli.reduce import manifest_of
from fogreduce.datasets.atomic import write_text
from fogreduce.datasets.sole_writer import sole_writer
from fogreduce.reruns.outdated import refuse_another_run, remove_outdated
from fogreduce.reruns.uses import refuse_rewritten


def run(arguments: argparse.Namespace) -> int:
    """Check the run's metadata, hash its inputs and write the manifest."""
    manifest = manifest_of(arguments)
    text = json.dumps(manifest, indent=1, allow_nan=False)
    with sole_writer(arguments.out):
        refuse_another_run(arguments.out, manifest)
        used = manifest["calibration"]
        refuse_rewritten(used["id"], used["sha256"], arguments.calibrations, arguments.out)
        remove_outdated(arguments.out, manifest["version_id"])
        write_text(arguments.out / "manifest.json", text + "\n")
    return 0
