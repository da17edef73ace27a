"""Results held against archived ones: equal to the byte, or how far apart, and what differs underneath."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fogreduce.errors import BadInput, Fault
from fogreduce.provenance.cell import read_table, row_names, standard_uncertainty
from fogreduce.provenance.digest import file_digest
from fogreduce.provenance.machine import differences, machine
from fogreduce.provenance.manifest_file import MANIFEST, OUTPUTS
from fogreduce.provenance.records import Manifest, read_manifest, read_outputs

#: How far a number may lie from the archived one, in units of its standard uncertainty.
TOLERANCE = 1e-6
#: Without an uncertainty of its own, how far apart relative to the larger.
_RELATIVE = 1e-9
#: Columns that differ wherever library versions do.
_IDENTITY = ("version_id",)


@dataclass(frozen=True)
class Compared:
    """One run, compared.

    Attributes
    ----------
    run : str
        ``<campaign>/<run_id>``.
    tables : int
        How many there are.
    differing : tuple of str
        Tables that are not equal to the byte.
    worst : float
        The largest difference of a cell, in units of its standard uncertainty.
    datasets : str
        ``equal``, or what differs.
    causes : tuple of str
        What differs between the machines, the code, the parameters.
    faults : tuple of Fault
        Cells beyond the tolerance, tables or rows that only one side has.
    """

    run: str
    tables: int
    differing: tuple[str, ...]
    worst: float
    datasets: str
    causes: tuple[str, ...]
    faults: tuple[Fault, ...]


def compare_run(archived: Path, new: Path) -> Compared:
    """Compare a run's results with the archived ones; both are results folders."""
    before, after = read_manifest(archived), read_manifest(new)
    names = {path.name for folder in (archived, new) for path in (folder / "tables").glob("*.csv")}
    faults: list[Fault] = []
    differing: list[str] = []
    worst = 0.0
    for name in sorted(names):
        one, other = archived / "tables" / name, new / "tables" / name
        if not (one.is_file() and other.is_file()):
            there = one if one.is_file() else other
            missing = other if one.is_file() else one
            faults.append(Fault(str(missing), "", "no such table", f"one, as {there}"))
            continue
        if one.read_bytes() == other.read_bytes():
            continue
        differing.append(name)
        for fault, distance in _cells(one, other):
            worst = max(worst, distance)
            if fault is not None:
                faults.append(fault)
    return Compared(
        f"{before.campaign}/{before.run_id}",
        len(names),
        tuple(differing),
        worst,
        _datasets(archived, new),
        tuple(_causes(archived, new, before, after)),
        tuple(faults),
    )


def _cells(one: Path, other: Path) -> Iterator[tuple[Fault | None, float]]:
    """Each cell that differs: a fault where it does so beyond the tolerance, and how far."""
    header, rows = read_table(one)
    new_header, new_rows = read_table(other)
    if header != new_header or row_names(header, rows) != row_names(new_header, new_rows):
        yield Fault(str(other), "", "other rows or columns", f"those of {one}"), math.inf
        return
    for row, new_row, name in zip(rows, new_rows, row_names(header, rows), strict=True):
        fields = dict(zip(header, row, strict=True))
        for column, old, new in zip(header, row, new_row, strict=True):
            if old == new or column in _IDENTITY:
                continue
            distance = distance_of(old, new, standard_uncertainty(column, fields))
            fault = None
            if not distance <= TOLERANCE:
                expected = f"{old} within {TOLERANCE:g} of its standard uncertainty"
                fault = Fault(str(other), f"{name}:{column}", new or "nothing", expected)
            yield fault, distance


def distance_of(old: str, new: str, sigma: float | None) -> float:
    """How far two fields lie apart, in units of their standard uncertainty; inf: not numbers."""
    try:
        before, after = float(old), float(new)
    except ValueError:
        return math.inf
    if sigma is None:
        sigma = max(abs(before), abs(after)) * _RELATIVE / TOLERANCE
    return abs(after - before) / sigma if sigma > 0.0 else math.inf


def _datasets(archived: Path, new: Path) -> str:
    """Whether the datasets are equal: to the byte, or in every value."""
    names = sorted({path.name for folder in (archived, new) for path in (folder / "datasets").glob("*.nc")})
    unequal = []
    for name in names:
        one, other = archived / "datasets" / name, new / "datasets" / name
        if not (one.is_file() and other.is_file()):
            unequal.append(f"{name} is missing")
        elif file_digest(one) != file_digest(other) and (problem := _unequal_values(one, other)):
            unequal.append(f"{name}: {problem}")
    return "; ".join(unequal) or "equal"


def _unequal_values(one: Path, other: Path) -> str:
    import h5py
    import numpy as np

    with h5py.File(one, "r") as old, h5py.File(other, "r") as new:
        if set(old) != set(new):
            return "other variables"
        for name in old:
            if old[name].shape != new[name].shape or old[name].dtype != new[name].dtype:
                return f"{name} has another shape or type"
            axis = int(np.argmax(old[name].shape)) if old[name].shape else 0
            length = old[name].shape[axis] if old[name].shape else 1
            for start in range(0, length, 1 << 16):
                part = (slice(None),) * axis + (slice(start, start + (1 << 16)),) if old[name].shape else ()
                if not np.array_equal(
                    old[name][part], new[name][part], equal_nan=old[name].dtype.kind == "f"
                ):
                    return f"values of {name} differ"
    return ""


def _causes(archived: Path, new: Path, before: Manifest, after: Manifest) -> Iterator[str]:
    """What differs between what the archived results and the new ones were made with."""
    yield from manifest_differences(before, after)
    yield from differences(_machine(archived), _machine(new))


def _machine(results: Path) -> dict[str, Any]:
    """The machine that results were made on: as their checksums say, else this one."""
    return read_outputs(results).machine if (results / OUTPUTS).is_file() else machine()


def manifest_differences(before: Manifest, after: Manifest) -> list[str]:
    """What two manifests differ in, a line each: inputs, record, code, libraries, parameters."""
    old = {entry.name: entry.sha256 for entry in before.inputs}
    new = {entry.name: entry.sha256 for entry in after.inputs}
    lines = [f"input {name}: other bytes" for name in sorted(old) if name in new and old[name] != new[name]]
    lines += [f"input {name}: only in one" for name in sorted(set(old) ^ set(new))]
    if before.calibration != after.calibration:
        old_id, new_id = before.calibration.id, after.calibration.id
        lines.append(f"calibration: {old_id}" + (f" -> {new_id}" if old_id != new_id else ", other bytes"))
        lines += [
            f"calibration: {line}"
            for line in differences(before.calibration_record, after.calibration_record)
        ]
    codes = [str(manifest.software.get("code_sha256")) for manifest in (before, after)]
    if codes[0] != codes[1]:
        lines.append(f"code: {codes[0][:16]} -> {codes[1][:16]}")
    drop = {"code_sha256"}
    lines += differences(
        {key: value for key, value in before.software.items() if key not in drop},
        {key: value for key, value in after.software.items() if key not in drop},
    )
    lines += [f"parameters: {line}" for line in differences(before.parameters, after.parameters)]
    lines += [f"run.yaml: {line}" for line in differences(before.run, after.run)]
    return lines


def runs_to_compare(archived: Path, new: Path) -> list[tuple[Path, Path]]:
    """Pairs of results folders, by campaign and run; BadInput where a run of the archive is missing."""
    pairs = []
    for path in sorted(archived.glob(f"*/*/{MANIFEST}")):
        folder = new / path.parent.relative_to(archived)
        if not (folder / MANIFEST).is_file():
            raise BadInput.at(folder, "", found="no such results", expected="those of every archived run")
        pairs.append((path.parent, folder))
    if not pairs:
        raise BadInput.at(archived, "", found="no results", expected="archived results")
    return pairs
