"""The runs of a campaign as its page needs them: the overview of each, or why there is none."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fogreduce.errors import BadInput
from fogreduce.metadata.campaign import Campaign
from fogreduce.metadata.folder import find_runs, load_campaign, load_run
from fogreduce.pages.overview import kept_overview
from fogreduce.stages.summary import why_none


@dataclass(frozen=True)
class Entry:
    """A run: its overview, or the stage that failed and why.

    Attributes
    ----------
    run_id : str
    started_at : str
        As run.yaml has it; empty where that could not be read.
    overview : dict or None
        See `fogreduce.pages.overview`; None: not reduced.
    stage, reason : str
        Where it is not reduced.
    page : bool
        Whether it has a page.
    """

    run_id: str
    started_at: str
    overview: dict[str, Any] | None
    stage: str = ""
    reason: str = ""
    page: bool = False


@dataclass(frozen=True)
class Gathered:
    """A campaign.

    Attributes
    ----------
    name : str
    about : Campaign
        What campaign.yaml says.
    runs : list of Entry
        By date.
    left_out : list of str
        Run folders that could not be used, with the reason.
    page : bool
        Whether it has a page.
    """

    name: str
    about: Campaign
    runs: list[Entry]
    left_out: list[str]
    page: bool = False

    @property
    def reduced(self) -> list[Entry]:
        """The runs with numbers."""
        return [entry for entry in self.runs if entry.overview is not None]

    @property
    def failed(self) -> list[Entry]:
        """The runs without."""
        return [entry for entry in self.runs if entry.overview is None]


def gather(folder: Path, campaign: Path | None) -> Gathered:
    """All runs of a campaign.

    Parameters
    ----------
    folder : Path
        Its results, ``<results>/<campaign>``.
    campaign : Path or None
        The campaign's own folder, which says which runs there are, failed ones among them; None: those
        that have results or logs.
    """
    about, left_out = Campaign(), []
    if campaign is None or not campaign.is_dir():
        campaign, names = None, sorted(_folders(folder))
    else:
        about = load_campaign(campaign)
        runs, faults = find_runs(campaign)
        names, left_out = [run.name for run in runs], [str(fault) for fault in faults]
        campaign = campaign / "runs"
    entries = [_entry(folder / name, campaign and campaign / name) for name in names]
    # By date; those without one come last.
    entries.sort(key=lambda entry: (entry.started_at or "~", entry.run_id))
    return Gathered(folder.name, about, entries, left_out, (folder / "index.html").is_file())


def _folders(folder: Path) -> Iterator[str]:
    for path in folder.iterdir():
        if path.is_dir() and path.name[0] not in "_.":
            yield path.name


def _entry(folder: Path, run: Path | None) -> Entry:
    try:
        seen = kept_overview(folder)
    except BadInput as error:
        stage, reason = why_none(folder, str(error))
        return Entry(folder.name, _started(run), None, stage, reason)
    return Entry(folder.name, seen["started_at"], seen, page=(folder / "index.html").is_file())


def _started(run: Path | None) -> str:
    """When a run that failed began, where its run.yaml can be read."""
    if run is None:
        return ""
    try:
        return str(load_run(run, need_capture=False).model_dump(mode="json")["started_at"])
    except (BadInput, OSError):
        return ""
