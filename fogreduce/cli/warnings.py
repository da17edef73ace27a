"""Warnings about a run, on standard error."""

from __future__ import annotations

import sys
from pathlib import Path

from fogreduce.stages.read_tables import read_rows
from fogreduce.stages.setup import Setup
from fogreduce.stages.summary import WARNING


def print_warnings(setup: Setup, run_dir: Path) -> int:
    """Every warning about the run, a line each; how many."""
    rows = read_rows(setup.out, "warnings", setup.version_id, setup.facts.raw_unit)
    for row in rows:
        text = f"{WARNING}{run_dir / row['where']}: found {row['found']}; expected {row['expected']}"
        print(" ".join(text.split()), file=sys.stderr)
    return len(rows)
