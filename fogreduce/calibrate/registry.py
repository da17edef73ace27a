"""The calibration records of a folder as one registry: which there are, what follows which, what is wrong."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from fogreduce.errors import BadInput, Fault
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.folder import is_name, read_calibration
from fogreduce.metadata.instant import instant_text
from fogreduce.provenance.digest import file_digest

#: A standard deviation in the record and the root of the covariance's diagonal agree to this [relative].
_AGREE = 1e-6


@dataclass(frozen=True)
class Entry:
    """A record with its file and the file's SHA-256."""

    record: CalibrationRecord
    path: Path
    sha256: str

    @property
    def record_id(self) -> str:
        """``<unit>@<version>``."""
        return self.record.record_id


def read_registry(calibrations: Path, unit: str | None = None) -> tuple[list[Entry], list[Fault]]:
    """Every record of a folder, by unit and validity; and the faults of those that cannot be read.

    Raises
    ------
    BadInput
        No such folder, or no record of the unit asked for.
    """
    if not calibrations.is_dir():
        raise BadInput.at(calibrations, "", found="no such folder", expected="a folder of records")
    if unit is not None and not (is_name(unit) and (calibrations / unit).is_dir()):
        units = sorted(path.parent.name for path in calibrations.glob("*/*.yaml"))
        expected = "a unit with records: " + (", ".join(dict.fromkeys(units)) or "there is none")
        raise BadInput.at(calibrations, "", found=f"no unit {unit}", expected=expected)
    entries: list[Entry] = []
    faults: list[Fault] = []
    for path in sorted(calibrations.glob(f"{unit or '*'}/*.yaml")):
        try:
            entries.append(Entry(read_calibration(path), path, file_digest(path)))
        except BadInput as error:
            faults += error.faults
    entries.sort(key=lambda entry: (entry.record.unit, entry.record.valid_from, entry.record.version))
    return entries, faults


def history(entries: Sequence[Entry], record_id: str) -> list[Entry]:
    """A record and those that it supersedes one after the other, newest first, as far as they are there."""
    by_id = {entry.record_id: entry for entry in entries}
    found: list[Entry] = []
    at: str | None = record_id
    while at is not None and at in by_id and by_id[at] not in found:
        found.append(by_id[at])
        at = by_id[at].record.supersedes
    return found


def superseded_by(entries: Sequence[Entry], record_id: str) -> list[str]:
    """The records that say they take the place of one."""
    return [entry.record_id for entry in entries if entry.record.supersedes == record_id]


def faults_between(entries: Sequence[Entry]) -> list[Fault]:
    """What is wrong with records seen together, and with covariances."""
    by_id = {entry.record_id: entry for entry in entries}
    faults = []
    for entry in entries:
        record, earlier = entry.record, entry.record.supersedes
        if earlier is not None:
            faults += _faults_of_succession(entry, by_id.get(earlier), earlier)
            if history(entries, entry.record_id)[-1].record.supersedes in by_id:
                expected = "records that follow one another, none of them twice"
                faults.append(Fault(str(entry.path), "supersedes", "a ring", expected))
        if record.covariance is not None:
            faults += _faults_of_covariance(entry)
    return faults


def _faults_of_succession(entry: Entry, earlier: Entry | None, named: str) -> list[Fault]:
    file, record = str(entry.path), entry.record
    if named.partition("@")[0] != record.unit:
        return [Fault(file, "supersedes", named, f"a record of {record.unit}")]
    if earlier is None:
        return [Fault(file, "supersedes", f"{named}, which is not there", "a record of this folder")]
    if record.valid_from < earlier.record.valid_from:
        expected = (
            f"an instant from {instant_text(earlier.record.valid_from)} on, when {named} begins to hold"
        )
        return [Fault(file, "valid_from", instant_text(record.valid_from), expected)]
    if record.n != earlier.record.n:
        return [
            Fault(file, "supersedes", f"{named}, of {earlier.record.n} gyros", f"one of {record.n} gyros")
        ]
    return []


def _faults_of_covariance(entry: Entry) -> list[Fault]:
    record = entry.record
    assert record.covariance is not None
    matrix = np.array(record.covariance.matrix)
    file, key = str(entry.path), "covariance.matrix"
    if not np.allclose(matrix, matrix.T, rtol=_AGREE, atol=0):
        return [Fault(file, key, "a matrix that is not symmetric", "a covariance")]
    errors = np.sqrt(np.abs(np.diag(matrix)))
    scaled = matrix / np.where(errors > 0, np.outer(errors, errors), 1.0)
    if np.linalg.eigvalsh(scaled)[0] < -_AGREE or (np.diag(matrix) < 0).any():
        return [Fault(file, key, "a matrix with a negative eigenvalue", "a covariance")]
    names = {name: error for name, error in zip(record.covariance.parameters, errors, strict=True)}
    faults = []
    for i, stated in enumerate(record.stated_uncertainty.scale_factor_rel):
        error = names.get(f"gyro{i + 1}.scale_factor_rel")
        if error is not None and abs(error - stated) > _AGREE * max(error, stated):
            where = f"uncertainty.scale_factor_rel[{i}]"
            faults.append(Fault(file, where, f"{stated:.6g}", f"{error:.6g}, as the covariance has it"))
    return faults
