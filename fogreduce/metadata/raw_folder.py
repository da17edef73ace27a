"""Outputs are written apart from raw data: whether a folder is a run's or a campaign's own."""

from __future__ import annotations

from pathlib import Path

from fogreduce.errors import BadInput


def is_raw(folder: Path) -> bool:
    """Whether a folder is a run's or a campaign's own, with its run.yaml and captures."""
    if any((folder / name).is_file() for name in ("run.yaml", "campaign.yaml")):
        return True
    return any((folder / "runs").glob("*/run.yaml"))


def refuse_raw(option: str, folder: Path) -> None:
    """BadInput where outputs were to be written among raw data."""
    if is_raw(folder):
        found = f"{folder}, the folder of a run or a campaign itself"
        raise BadInput.at(option, "", found=found, expected="a folder of its own, apart from the raw data")
