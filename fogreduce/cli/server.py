"""``fogreduce server DIR``: a warm server for the jobs of a workflow, which starts it."""

from __future__ import annotations

import argparse
import shutil
from pathlib import Path

from fogreduce.cli.main import main
from fogreduce.warm.serve import Server


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Options of the command."""
    parser.add_argument("folder", type=Path, metavar="DIR", help="its private folder; removed at the end")


def run(arguments: argparse.Namespace) -> int:
    """Serve until standard input closes."""
    try:
        Server(arguments.folder, main).run()
    finally:
        shutil.rmtree(arguments.folder, ignore_errors=True)
    return 0
