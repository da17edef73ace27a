"""The table of runs: what planning a workflow needs of campaigns and calibration records.

The process that plans lists the folders and writes the table; a worker may have none of them, and reads it.
"""

from __future__ import annotations

import hashlib
import json
import os
import re
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from fogreduce.errors import BadInput
from fogreduce.metadata.campaign import Campaign
from fogreduce.metadata.file_name import problem_of_file_name
from fogreduce.metadata.folder import find_runs, list_campaigns, load_campaign

#: Files up to this size are read for their digest; of larger ones their size counts [bytes].
SMALL_BYTES = 1 << 16
_NAMED_RECORD = re.compile(r"""^calibration:[ ]*['"]?([\w.-]+)@([\w.-]+)['"]?[ ]*(?:\#.*)?$""", re.MULTILINE)


@dataclass(frozen=True)
class ListedRun:
    """A run: names of its files, a digest of what they say, and the records that it is reduced with.

    Attributes
    ----------
    files : list of str
        In order; hidden ones and those that no run.yaml may name are passed over.
    says : str
        SHA-256 over its small files and the sizes of the large ones: Snakemake goes by times, and does not
        see what was edited while the clock stood earlier.
    records : list of str
        ``<unit>/<version>.yaml``: the one that it names; all where that is for its manifest to find out.
    """

    files: list[str]
    says: str
    records: list[str]


@dataclass(frozen=True)
class ListedCampaign:
    """A campaign: campaign.yaml, names of the files beside it, its runs, and what was left out."""

    about: Campaign
    files: list[str]
    runs: dict[str, ListedRun]
    left_out: list[str]


@dataclass(frozen=True)
class RunTable:
    """Campaigns by name, and the calibration records, ``<unit>/<version>.yaml``."""

    campaigns: dict[str, ListedCampaign]
    records: list[str]

    def text(self) -> str:
        """As JSON."""
        data: dict[str, Any] = {"records": self.records, "campaigns": {}}
        for name, campaign in self.campaigns.items():
            data["campaigns"][name] = {
                "about": campaign.about.model_dump(mode="json", by_alias=True, exclude_none=True),
                "files": campaign.files,
                "runs": {run: asdict(listed) for run, listed in campaign.runs.items()},
                "left_out": campaign.left_out,
            }
        return json.dumps(data)

    @classmethod
    def read(cls, path: Path) -> RunTable:
        """The table that `text` made."""
        data = json.loads(path.read_bytes())
        campaigns = {
            name: ListedCampaign(
                Campaign.from_data(listed["about"], path),
                listed["files"],
                {run: ListedRun(**of_run) for run, of_run in listed["runs"].items()},
                listed["left_out"],
            )
            for name, listed in data["campaigns"].items()
        }
        return cls(campaigns, data["records"])


def list_runs(campaigns_dir: str, calibrations_dir: str, names: Sequence[str] = ()) -> RunTable:
    """List the folders.

    Parameters
    ----------
    campaigns_dir, calibrations_dir : str
        Folders of the campaigns and of the calibration records.
    names : sequence of str
        The campaigns asked for; empty: all.

    Raises
    ------
    BadInput
        A folder is not there, a campaign has a name that will not do or a campaign.yaml with faults, or one
        that was asked for is absent.
    """
    folders = {path.name: path for path in list_campaigns(campaigns_dir)}
    for name in names:
        if name not in folders:
            found = f"no campaign {name}"
            raise BadInput.at(campaigns_dir, "", found=found, expected="one, as configured")
    parent = Path(calibrations_dir)
    records = sorted(path.relative_to(parent).as_posix() for path in parent.glob("*/*.yaml"))
    campaigns = {}
    for name in names or sorted(folders):
        about = load_campaign(folders[name])
        runs, faults = find_runs(folders[name])
        listed = {run.name: _listed(run, about, records) for run in runs}
        campaigns[name] = ListedCampaign(
            about, _files_in(folders[name]), listed, [str(fault) for fault in faults]
        )
    return RunTable(campaigns, records)


def _files_in(folder: Path) -> list[str]:
    with os.scandir(folder) as entries:
        return sorted(
            entry.name
            for entry in entries
            if entry.name[0] != "." and not problem_of_file_name(entry.name) and entry.is_file()
        )


def _listed(folder: Path, about: Campaign, records: list[str]) -> ListedRun:
    files = _files_in(folder)
    digest = hashlib.sha256()
    for name in files:
        digest.update(hashlib.sha256(_said(folder / name)).digest())
    text = _said(folder / "run.yaml").decode(errors="replace")
    named = _NAMED_RECORD.search(text) or _NAMED_RECORD.search(f"calibration: {about.calibration}")
    record = f"{'/'.join(named.groups())}.yaml" if named else ""
    return ListedRun(files, digest.hexdigest(), [record] if record in records else records)


def _said(path: Path) -> bytes:
    """What a small file says, of a large one its size; what cannot be read is for its run to tell."""
    try:
        size = path.stat().st_size
        return path.read_bytes() if size <= SMALL_BYTES else b"%d" % size
    except OSError:
        return b""
