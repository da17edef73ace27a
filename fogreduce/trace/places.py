"""Where a run's results, inputs and code lie: in a bag, in a folder of results, or in a run's own folder."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from fogreduce.archive.contents import MADE, campaigns_in
from fogreduce.archive.schema import ArchiveRecord
from fogreduce.archive.verify import listed
from fogreduce.archive.write import RECORD
from fogreduce.errors import BadInput
from fogreduce.provenance.manifest_file import MANIFEST, read_record
from fogreduce.provenance.records import Manifest, read_manifest


@dataclass(frozen=True)
class RunPlace:
    """A run and where what belongs to it lies.

    Attributes
    ----------
    results, inputs, calibrations : Path
        Folders of its results, of its run.yaml and capture, and of the calibration records.
    package : Path or None
        The source of the package that is archived with it; None outside a bag.
    code_parts : tuple of str
        Sources of the archived package that the hash of the code is over.
    """

    manifest: Manifest
    results: Path
    inputs: Path
    calibrations: Path
    package: Path | None
    code_parts: tuple[str, ...] = ()

    @property
    def name(self) -> str:
        """``<campaign>/<run_id>``."""
        return f"{self.manifest.campaign}/{self.manifest.run_id}"


def is_bag(place: Path) -> bool:
    """Whether a folder is meant to be a bag."""
    return (place / "bagit.txt").is_file()


def run_places(place: Path, campaigns: Path, calibrations: Path) -> list[RunPlace]:
    """The runs of a bag, of a folder of results, of a campaign's or of one run's.

    Parameters
    ----------
    place : Path
        The folder.
    campaigns, calibrations : Path
        Where the inputs of results lie that are not in a bag.
    """
    if is_bag(place):
        return _in_bag(place)
    if not place.is_dir():
        raise BadInput.at(place, "", found="no such folder", expected="a bag, or results")
    if (place / MANIFEST).is_file():
        return [_in_results(place, place.parent.parent, campaigns, calibrations)]
    folders = sorted(path.parent for path in place.glob(f"*/{MANIFEST}"))
    if folders:
        return [_in_results(folder, place.parent, campaigns, calibrations) for folder in folders]
    found = [
        _in_results(path.parent, place, campaigns, calibrations)
        for name in campaigns_in(place)
        for path in sorted((place / name).glob(f"*/{MANIFEST}"))
    ]
    if not found:
        raise BadInput.at(place, "", found="no reduced run", expected="a bag, or results")
    return found


def _in_bag(bag: Path) -> list[RunPlace]:
    listed(bag)  # a link in it is refused before a path is followed
    data = bag / "data"
    path = data / RECORD
    record = ArchiveRecord.from_data(read_record(path, "the archive's record"), path)
    return [
        RunPlace(
            read_manifest(data / entry.results),
            data / entry.results,
            data / entry.inputs,
            data / "calibrations",
            data / "software" / "fogreduce",
            tuple(record.code_parts),
        )
        for entry in record.runs
    ]


def _in_results(folder: Path, results: Path, campaigns: Path, calibrations: Path) -> RunPlace:
    manifest = read_manifest(folder)
    run = Path(manifest.campaign) / "runs" / manifest.run_id
    made = results / MADE / run
    return RunPlace(manifest, folder, made if made.is_dir() else campaigns / run, calibrations, None)


def one_run(places: list[RunPlace], name: str | None, place: Path, how: str) -> RunPlace:
    """The run of that name (``run`` or ``campaign/run``), or the only one; `how` one is named."""
    fitting = [item for item in places if name in (None, item.name, item.manifest.run_id)]
    if len(fitting) == 1:
        return fitting[0]
    places_in_words = ", ".join(item.name for item in places[:8]) + (", ..." if len(places) > 8 else "")
    found = f"{len(fitting)} runs" if name is None else f"{len(fitting)} runs named {name}"
    raise BadInput.at(place, "", found=found, expected=f"one to be named, {how}, of {places_in_words}")
