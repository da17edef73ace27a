"""What goes into the archive of a campaign, and where it lies there; nothing is read but the records.

============================================ ===========================================================
``campaigns/<campaign>/``                    campaign.yaml, run.yaml of each run, captures and logs
``captures/<campaign>/``                     captures that the workflow made, where campaign.yaml says so
``calibrations/<unit>/<version>.yaml``       the records that the runs used
``results/<campaign>/<run>/``                manifest, checksums, datasets, reports, tables, figures, versions
``results/<campaign>/index.html``            its page, where there is one
``results/<campaign>/_diagnosis/``           its diagnosis, where there is one
``results/<campaign>/_calibration/``         a calibration derived from it, where there is one
``results/<campaign>/_report/``              the test report of its unit, where there is one
``results/index.html``                       the index, of this campaign alone, where it has a page
``results/_selftest/``                       published numbers as the software computes them, if it was asked
``software/``                                the package's source, its rules, the lock of its environment
============================================ ===========================================================
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from fogreduce.archive.names import faults_of_names, plain_files
from fogreduce.archive.software import source_files
from fogreduce.errors import BadInput, Fault
from fogreduce.metadata.patterns import NAME_PATTERN
from fogreduce.provenance.manifest_file import MANIFEST, OUTPUTS
from fogreduce.provenance.outputs import result_files
from fogreduce.provenance.records import HashedFile, Manifest, Outputs, read_manifest, read_outputs
from fogreduce.provenance.versions import kept_versions

#: Where the workflow keeps the captures that it made, in the folder of the results.
MADE = "_captures"
#: Folders beside a campaign's runs: its diagnosis, a calibration derived from it, its unit's test report.
OF_CAMPAIGN = ("_diagnosis", "_calibration", "_report")
#: Folder beside the campaigns: the software's own examination (`fogreduce selftest`).
SELFTEST = "_selftest"
#: The page of a campaign, beside its runs; and that over all campaigns, beside these.
PAGE = "index.html"


@dataclass(frozen=True)
class Item:
    """One file to be archived: its path in the archive, where it lies now, and the hash it must have."""

    path: str
    source: Path
    sha256: str | None = None


@dataclass(frozen=True)
class RunRecord:
    """A run in the archive: its newest manifest and checksums, and where its inputs lie there."""

    manifest: Manifest
    outputs: Outputs
    inputs: str  # folder in the archive

    @property
    def results(self) -> str:
        """Folder of its results in the archive."""
        return f"results/{self.manifest.campaign}/{self.manifest.run_id}"


@dataclass(frozen=True)
class Contents:
    """All that goes into one campaign's archive."""

    campaign: str
    items: list[Item]
    runs: list[RunRecord]
    left_out: Mapping[str, str] = field(default_factory=dict)  # run -> why its results are not there


def campaigns_in(results: Path) -> list[str]:
    """Names of the campaigns that a results folder holds, in order."""
    if not results.is_dir():
        raise BadInput.at(results, "", found="no such folder", expected="a folder of results")
    return sorted({path.parent.parent.name for path in results.glob(f"*/*/{MANIFEST}") if _is_run(path)})


def _is_run(manifest: Path) -> bool:
    return all(re.fullmatch(NAME_PATTERN.strip("^$"), part) for part in manifest.parts[-3:-1])


def contents(
    results: Path,
    campaign: str,
    campaigns: Path,
    calibrations: Path,
    source: Path,
    left_out: Mapping[str, str] | None = None,
) -> Contents:
    """The archive of one campaign, planned.

    Parameters
    ----------
    results : Path
        Folder of all results: ``<results>/<campaign>/<run>``.
    campaign : str
        Its name.
    campaigns, calibrations : Path
        Folders of the campaigns and of the calibration records.
    source : Path
        Folder of the package's source.
    left_out : mapping, optional
        Runs that failed or were taken out of the campaign, with the reason: their results stay out, what the
        campaign has of them goes in.

    Raises
    ------
    BadInput
        A file that the records name is not there, or another lies where none should.
    """
    left_out = {} if left_out is None else left_out
    folders = sorted(path.parent for path in (results / campaign).glob(f"*/{MANIFEST}") if _is_run(path))
    folders = [folder for folder in folders if folder.name not in left_out]
    if not folders:
        raise BadInput.at(results / campaign, "", found="no reduced run", expected="one folder a run")
    made = results / MADE / campaign
    items: dict[str, Item] = {}
    runs: list[RunRecord] = []
    faults: list[Fault] = []
    for folder in folders:
        try:
            record, found = _run(folder, campaign, campaigns / campaign, made, calibrations)
        except BadInput as error:
            faults += error.faults
            continue
        runs.append(record)
        items |= {item.path: item for item in found}
    if faults:
        raise BadInput(*faults)
    shared = [(campaigns / campaign, f"campaigns/{campaign}")]
    if any(run.inputs.startswith("captures/") for run in runs):
        shared.append((made, f"captures/{campaign}"))
    for run in runs:
        if run.inputs.startswith("captures/"):
            # The run.yaml that a made capture was made from: the workflow starts there.
            name = f"runs/{run.manifest.run_id}"
            shared.append((campaigns / campaign / name, f"campaigns/{campaign}/{name}"))
    for run_id in left_out:
        if (folder := campaigns / campaign / "runs" / run_id).is_dir():
            shared.append((folder, f"campaigns/{campaign}/runs/{run_id}"))
    for parent, place in shared:
        for path in plain_files(parent):
            items.setdefault(f"{place}/{path.name}", Item(f"{place}/{path.name}", path))
    for of_campaign in OF_CAMPAIGN:
        folder = results / campaign / of_campaign
        for name in result_files(folder) if folder.is_dir() else ():
            if not name.endswith(".log"):
                place = f"results/{campaign}/{of_campaign}/{name}"
                items[place] = Item(place, folder / name)
    examined = results / SELFTEST
    for name in result_files(examined) if examined.is_dir() else ():
        items[f"results/{SELFTEST}/{name}"] = Item(f"results/{SELFTEST}/{name}", examined / name)
    page = results / campaign / PAGE
    if page.is_file():
        items[f"results/{campaign}/{PAGE}"] = Item(f"results/{campaign}/{PAGE}", page)
    for name in source_files(source):
        items[f"software/{name}"] = Item(f"software/{name}", source / name)
    if faults := faults_of_names(item.source for item in items.values()):
        raise BadInput(*faults)
    return Contents(campaign, [items[path] for path in sorted(items)], runs, dict(sorted(left_out.items())))


def _run(
    folder: Path, campaign: str, given: Path, made: Path, calibrations: Path
) -> tuple[RunRecord, list[Item]]:
    manifest, outputs = read_manifest(folder), read_outputs(folder)
    if (manifest.campaign, manifest.run_id) != (campaign, folder.name):
        found = f"results of {manifest.campaign}/{manifest.run_id}"
        raise BadInput.at(folder / MANIFEST, "", found=found, expected=f"{campaign}/{folder.name}")
    _agree(folder, manifest, outputs)
    items = _result_items(folder, f"results/{campaign}/{folder.name}", outputs)
    for version in kept_versions(folder):
        kept = read_outputs(version.folder)
        if not kept.is_same(outputs):
            place = f"results/{campaign}/{folder.name}/versions/{version.folder.name}"
            items += _result_items(version.folder, place, kept)
    in_made = (made / "runs" / folder.name).is_dir()
    place = f"{'captures' if in_made else 'campaigns'}/{campaign}/runs/{folder.name}"
    at = (made if in_made else given) / "runs" / folder.name
    for entry in manifest.inputs:
        items.append(_item(f"{place}/{entry.name}", at / entry.name, entry))
    unit, _, version_name = manifest.calibration.id.partition("@")
    record = f"{unit}/{version_name}.yaml"
    path = calibrations / record
    if not path.is_file():
        raise BadInput.at(path, "", found="no such file", expected="the record that a run was reduced with")
    items.append(Item(f"calibrations/{record}", path, manifest.calibration.sha256))
    return RunRecord(manifest, outputs, place), items


def _agree(folder: Path, manifest: Manifest, outputs: Outputs) -> None:
    """BadInput where the results are not those whose checksums were taken."""
    if outputs.version_id != manifest.version_id:
        expected = f"{manifest.version_id}, as the manifest: `fogreduce checksums` comes after the last stage"
        raise BadInput.at(folder / OUTPUTS, "version_id", found=outputs.version_id, expected=expected)
    named = {file.name for file in outputs.files}
    if extra := sorted(set(result_files(folder)) - named):
        raise BadInput.at(
            folder / extra[0], "", found="a file without a checksum", expected=f"only what {OUTPUTS} lists"
        )


def _result_items(folder: Path, place: str, outputs: Outputs) -> list[Item]:
    items = [_item(f"{place}/{file.name}", folder / file.name, file) for file in outputs.files]
    return [*items, Item(f"{place}/{OUTPUTS}", folder / OUTPUTS)]


def _item(path: str, source: Path, entry: HashedFile) -> Item:
    if "/" + path != str(Path("/" + path)) or ".." in Path(path).parts:
        raise BadInput.at(source, "", found=f"the name {entry.name}", expected="a file in its folder")
    if not source.is_file():
        raise BadInput.at(source, "", found="no such file", expected="a file that the records name")
    if (size := source.stat().st_size) != entry.bytes:
        raise BadInput.at(source, "", found=f"{size} bytes", expected=f"{entry.bytes}, as recorded")
    return Item(path, source, entry.sha256)
