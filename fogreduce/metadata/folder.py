"""Campaign folders and calibration folders on disk: from names to validated metadata.

Whatever is wrong with an input is collected, and raised as one BadInput.
"""

from __future__ import annotations

import os
import re
import unicodedata
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TypeVar

from fogreduce.errors import BadInput, Fault
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.campaign import Campaign
from fogreduce.metadata.instant import instant_text
from fogreduce.metadata.patterns import CALIBRATION_PATTERN, NAME_IN_WORDS, NAME_PATTERN
from fogreduce.metadata.run import Run
from fogreduce.metadata.words import kind_of
from fogreduce.metadata.yaml12 import load_yaml
from fogreduce.physics.raw_quantity import RAW_UNITS, unit_in_use

T = TypeVar("T")


def is_name(text: str) -> bool:
    """Whether `text` may name a campaign, a run, a unit or a calibration version."""
    return re.fullmatch(NAME_PATTERN.strip("^$"), text) is not None


def load_campaign(campaign_dir: Path | str) -> Campaign:
    """campaign.yaml of a campaign folder; an empty Campaign where there is none."""
    path = Path(campaign_dir) / "campaign.yaml"
    return Campaign.from_yaml(path) if os.path.lexists(path) else Campaign()


def list_campaigns(campaigns_dir: Path | str) -> list[Path]:
    """Campaign folders (those that hold a folder ``runs``), in order of their names."""
    folders = [path for path in _folders_in(Path(campaigns_dir), "campaign") if (path / "runs").is_dir()]
    if wrong := _bad_names(folders):
        raise BadInput(*wrong)
    return folders


def list_runs(campaign_dir: Path | str) -> list[Path]:
    """Run folders of a campaign, in order of their names; hidden entries and plain files are passed over."""
    runs, faults = find_runs(campaign_dir)
    if faults:
        raise BadInput(*faults)
    return runs


def find_runs(campaign_dir: Path | str) -> tuple[list[Path], list[Fault]]:
    """Run folders whose names will do, and the faults of the rest: for who goes on with what is fine."""
    parent = Path(campaign_dir) / "runs"
    try:
        folders = _folders_in(parent, "run")
    except BadInput as error:
        return [], list(error.faults)
    if not folders:
        return [], [Fault(str(parent), "", "no run", "one folder a run")]
    return [path for path in folders if is_name(path.name)], _bad_names(folders)


def _folders_in(parent: Path, what: str) -> list[Path]:
    try:
        entries = sorted(path for path in parent.iterdir() if not path.name.startswith("."))
    except OSError as error:
        found = "no such folder" if not parent.exists() else f"unreadable ({error.strerror})"
        raise BadInput.at(parent, "", found=found, expected=f"a folder with one folder a {what}") from None
    return [path for path in entries if path.is_dir()]


def _bad_names(folders: list[Path]) -> list[Fault]:
    return [
        Fault(str(path), "", "this folder's name", NAME_IN_WORDS)
        for path in folders
        if not is_name(path.name)
    ]


def load_run(run_dir: Path | str, *, need_capture: bool = True) -> Run:
    """run.yaml of a run folder, held against the folder.

    Parameters
    ----------
    run_dir : path
        ``<campaign>/runs/<run_id>``.
    need_capture : bool
        False where only the metadata are wanted: the capture may then be absent.

    Raises
    ------
    BadInput
        With every fault of run.yaml, of the names and of the files that it names.
    """
    folder = Path(run_dir)
    if not folder.is_dir():
        raise BadInput.at(folder, "", found="no such folder", expected="a run's folder with a run.yaml")
    path = folder / "run.yaml"
    data = load_yaml(path)
    faults = _names_against_folder(data, folder, path) + _named_files(data, folder, path, need_capture)
    try:
        data = _with_default_calibration(data, folder)
    except BadInput as error:
        faults += error.faults
    try:
        run = Run.from_data(data, path)
    except BadInput as error:
        raise BadInput(*error.faults, *faults) from None
    if faults:
        raise BadInput(*faults)
    return run


def named_calibration(run_dir: Path | str) -> str | None:
    """The record that a run names, though its run.yaml have other faults; None where it cannot be told."""
    folder = Path(run_dir)
    try:
        named = _with_default_calibration(load_yaml(folder / "run.yaml"), folder).get("calibration")
    except BadInput:
        return None
    return named if isinstance(named, str) and re.fullmatch(CALIBRATION_PATTERN.strip("^$"), named) else None


def load_calibration(calibrations_dir: Path | str, record_id: str) -> tuple[CalibrationRecord, Path]:
    """The record ``<unit>@<version>``, from ``<calibrations_dir>/<unit>/<version>.yaml``, and its path."""
    if not re.fullmatch(CALIBRATION_PATTERN.strip("^$"), record_id):
        raise BadInput.at(calibrations_dir, "", found=kind_of(record_id), expected="<unit>@<version>")
    unit, version = record_id.split("@")
    path = Path(calibrations_dir) / unit / f"{version}.yaml"
    if not os.path.lexists(path):
        raise BadInput.at(path, "", found="no such file", expected=f"the calibration record {record_id}")
    return read_calibration(path), path


def read_calibration(path: Path | str) -> CalibrationRecord:
    """A calibration record whose unit and version agree with its path ``.../<unit>/<version>.yaml``."""
    file = Path(path)
    data = load_yaml(file)
    faults = [
        Fault(str(file), key, kind_of(data[key]), f"{name}, the {of}'s name")
        for key, name, of in (("unit", file.absolute().parent.name, "folder"), ("version", file.stem, "file"))
        if isinstance(data.get(key), str) and data[key] != name
    ]
    try:
        record = CalibrationRecord.from_data(data, file)
    except BadInput as error:
        raise BadInput(*error.faults, *faults) from None
    if faults:
        raise BadInput(*faults)
    return record


def cross_check(run: Run, record: CalibrationRecord, file: Path | str = "run.yaml") -> None:
    """Hold a run against its calibration record: unit, id, validity at the start, number of gyros, raw unit.

    Parameters
    ----------
    run : Run
        The run, and
    record : CalibrationRecord
        the record that it names.
    file : path
        The run.yaml to name in a fault.
    """
    wrong = []
    if run.calibration != record.record_id:
        wrong.append(("calibration", run.calibration, f"{record.record_id}, the record in use"))
    if run.unit != record.unit:
        wrong.append(("unit", run.unit, f"{record.unit}, the unit of calibration {record.record_id}"))
    if not record.is_valid_at(run.started_at):
        until = f" until {instant_text(record.valid_until)}" if record.valid_until else " on"
        validity = (
            f"an instant from {instant_text(record.valid_from)}{until}, when {record.record_id} is valid"
        )
        wrong.append(("started_at", instant_text(run.started_at), validity))
    if (given := len(run.capture.polarity)) != record.n:
        wrong.append(("capture.polarity", f"{given} signs", f"{record.n}, one a gyro of {record.record_id}"))
    captured_in, stated_in = run.capture.raw_unit, record.raw_unit.name
    if unit_in_use(captured_in).name != stated_in:
        fitting = " or ".join(name for name in RAW_UNITS if unit_in_use(name).name == stated_in)
        wrong.append(("capture.raw_unit", captured_in, f"{fitting}, as {record.record_id} is in {stated_in}"))
    if wrong:
        raise BadInput(*(Fault(str(file), *parts) for parts in wrong))


def runs_of_one_record(
    campaign: Path,
    calibrations: Path,
    only: Sequence[str],
    make: Callable[[Path, Run, CalibrationRecord], T],
    *,
    need_capture: bool = True,
) -> list[T]:
    """What `make` makes of each run of a campaign, folder and metadata given, all of one calibration record.

    Parameters
    ----------
    campaign, calibrations : Path
    only : run ids
        Empty: all.
    make : callable
        Its bad input is collected with that of the metadata.
    need_capture : bool
        As `load_run` takes it.

    Raises
    ------
    BadInput
        With every fault of the runs; for runs of several records.
    """
    folders = list_runs(campaign)
    names = [folder.name for folder in folders]
    for name in only:
        if name not in names:
            raise BadInput.at("--only-runs", "", found=name, expected="one of " + ", ".join(names))
    faults: list[Fault] = []
    found: list[T] = []
    of_record: dict[str, list[str]] = {}
    for folder in folders:
        if only and folder.name not in only:
            continue
        try:
            run = load_run(folder, need_capture=need_capture)
            record, _ = load_calibration(calibrations, run.calibration)
            cross_check(run, record, folder / "run.yaml")
            found.append(make(folder, run, record))
            of_record.setdefault(run.calibration, []).append(folder.name)
        except BadInput as error:
            faults += error.faults
    if faults:
        raise BadInput(*dict.fromkeys(faults))
    if len(of_record) > 1:
        raise several_records(campaign, of_record)
    return found


def several_records(campaign: Path, of_record: Mapping[str, Sequence[str]]) -> BadInput:
    """That a campaign's runs name several calibration records where one is needed.

    `of_record` has the ids of the runs that name each.
    """
    each = (f"{record} ({','.join(runs)})" for record, runs in sorted(of_record.items()))
    expected = "runs of one calibration record (choose with --only-runs)"
    return BadInput.at(campaign, "calibration", found="runs of " + " and of ".join(each), expected=expected)


def _with_default_calibration(data: dict[str, object], run_dir: Path) -> dict[str, object]:
    """run.yaml's data, with campaign.yaml's calibration where it names none."""
    if "calibration" in data:
        return data
    default = load_campaign(_spelled_out(run_dir).parent.parent).calibration
    return {**data, "calibration": default} if default else data


def _spelled_out(run_dir: Path) -> Path:
    """`run_dir` as it stands, or in full where it does not tell its own and its parent's name (``.``)."""
    return run_dir if len(run_dir.parts) > 1 and ".." not in run_dir.parts else run_dir.resolve()


def _names_against_folder(data: dict[str, object], folder: Path, path: Path) -> list[Fault]:
    name = _spelled_out(folder).name
    run_id = data.get("run_id")
    if isinstance(run_id, str) and run_id != name:
        return [Fault(str(path), "run_id", kind_of(run_id), f"{name}, the folder's name")]
    return []


def _named_files(data: dict[str, object], folder: Path, path: Path, need_capture: bool) -> list[Fault]:
    """Faults of the files that run.yaml names; names that are not plain are the model's to refuse."""
    capture = data.get("capture")
    named = {
        "capture.file": capture.get("file") if isinstance(capture, dict) else None,
        "temperature": data.get("temperature"),
        "table_log": data.get("table_log"),
    }
    faults = []
    for key, name in named.items():
        if not isinstance(name, str) or "/" in name or "\0" in name or name in ("", ".", ".."):
            continue
        optional = key == "capture.file" and not need_capture
        if problem := _problem_of_file(folder, name, optional):
            faults.append(Fault(str(path), key, problem, "a file in the run's own folder"))
    return faults


def _in_another_form(folder: Path, name: str) -> str:
    """What to say where a file looks the same and is spelt otherwise: a Mac's disk takes letters apart."""
    same = unicodedata.normalize("NFC", name)
    if any(unicodedata.normalize("NFC", path.name) == same for path in folder.iterdir()):
        return " (one of that name in another Unicode form is: rename it)"
    return ""


def _problem_of_file(folder: Path, name: str, optional: bool) -> str:
    """What is wrong with the file `name` of `folder`, in plain words; empty when nothing is."""
    file = folder / name
    try:
        if not os.path.lexists(file):
            return "" if optional else f"{name}, which is not there{_in_another_form(folder, name)}"
        if not file.resolve().is_relative_to(folder.resolve()):
            return f"{name}, a link that leaves the folder"
        if not file.is_file():
            return f"{name}, which is " + ("a folder" if file.is_dir() else "not a file")
    except (OSError, RuntimeError) as error:  # RuntimeError: a loop of links
        return f"{name}, which cannot be read ({error})"
    return "" if os.access(file, os.R_OK) else f"{name}, which may not be read"
