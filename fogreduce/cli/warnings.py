"""Warnings about a run, on standard error."""

from __future__ import annotations

import sys
from pathlib import Path

from fogreduce.pages.attention import found
from fogreduce.stages.look import COLUMNS
from fogreduce.stages.read_table import read_table
from fogreduce.stages.setup import Setup
from fogreduce.stages.summary import WARNING


def print_warnings(setup: Setup, run_dir: Path) -> int:
    """Every warning about the run, a line each; how many."""
    rows = read_table(setup.table("warnings"), COLUMNS, setup.version_id)
    for row in rows:
        text = f"{WARNING}{run_dir / row['where']}: {found(row)}"
        print(" ".join(text.split()), file=sys.stderr)
    return len(rows)
