"""What several commands ask of their options: outputs apart from raw data, runs by their names."""

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


def run_ids(text: str | None) -> tuple[str, ...]:
    """The runs of ``--only-runs ID,...``; none where the option is not given."""
    names = () if text is None else tuple(name for name in text.split(",") if name)
    if text is not None and not names:
        raise BadInput.at("--only-runs", "", found=text, expected="names of runs: ID,...")
    return names
