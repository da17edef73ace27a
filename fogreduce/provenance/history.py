"""The versions of a run's results, and what changed from one to the next: value, uncertainty, cause."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

from fogreduce.errors import BadInput
from fogreduce.provenance.cell import error_columns, read_table, row_names, standard_uncertainty
from fogreduce.provenance.compare import distance_of, manifest_differences
from fogreduce.provenance.digest import file_digest
from fogreduce.provenance.machine import differences
from fogreduce.provenance.manifest_file import MANIFEST
from fogreduce.provenance.records import Outputs, read_manifest, read_outputs
from fogreduce.provenance.versions import Version, kept_versions

_IDENTITY = "version_id"


def versions_of(results: Path) -> tuple[list[Version], Version]:
    """All versions of a run's results, the oldest first, and which of them the results are now."""
    outputs = read_outputs(results)
    kept = kept_versions(results)
    for version in kept:
        if outputs.is_same(read_outputs(version.folder)):
            return kept, version
    now = Version(kept[-1].number + 1 if kept else 1, outputs.version_id, results)
    return [*kept, now], now


def history(results: Path) -> dict[str, Any]:
    """The history of one run.

    Parameters
    ----------
    results : Path
        The run's results folder, with the older versions in its folder ``versions``.

    Returns
    -------
    dict
        Plain data: ``run``, ``now`` (the number of the version that the results are), ``versions`` (number,
        version id, folder) and ``changes`` (from, to, causes, cells, table, unchanged).

    Raises
    ------
    BadInput
        A kept version is not what it was.
    """
    versions, now = versions_of(results)
    for version in versions:
        _check(version)
    manifest = read_manifest(results)
    return {
        "run": f"{manifest.campaign}/{manifest.run_id}",
        "now": now.number,
        "versions": [
            {"number": item.number, "version_id": item.version_id, "folder": str(item.folder)}
            for item in versions
        ],
        "changes": [change(before, after) for before, after in pairwise(versions)],
    }


def _check(version: Version) -> None:
    """BadInput unless a version's manifest and tables are what their checksums say."""
    for entry in read_outputs(version.folder).files:
        if entry.name == MANIFEST or entry.name.startswith("tables/"):
            path = version.folder / entry.name
            if not path.is_file():
                raise BadInput.at(path, "", found="no such file", expected="one, as its checksums list it")
            if (found := file_digest(path)) != entry.sha256:
                raise BadInput.at(path, "", found=f"SHA-256 {found}", expected=f"{entry.sha256}, as recorded")


def change(before: Version, after: Version) -> dict[str, Any]:
    """What changed between two versions, and why."""
    one, other = read_outputs(before.folder), read_outputs(after.folder)
    causes = manifest_differences(read_manifest(before.folder), read_manifest(after.folder))
    causes += [f"machine: {line}" for line in differences(one.machine, other.machine)]
    cells, unchanged = _cells(before.folder, after.folder, _tables(one), _tables(other))
    cells.sort(key=lambda cell: -cell["sigma"] if cell["sigma"] is not None else 0.0)
    return {
        "from": before.number,
        "to": after.number,
        "causes": causes,
        "tables": _only_in_one(_tables(one), _tables(other)),
        "cells": cells,
        "unchanged": unchanged,
    }


def _tables(outputs: Outputs) -> list[str]:
    return [entry.name for entry in outputs.files if entry.name.startswith("tables/")]


def _only_in_one(old: list[str], new: list[str]) -> list[str]:
    return [f"{name}: gone" for name in old if name not in new] + [
        f"{name}: new" for name in new if name not in old
    ]


def _cells(
    before: Path, after: Path, old_tables: list[str], new_tables: list[str]
) -> tuple[list[dict[str, Any]], int]:
    """The cells that changed, and how many did not; a cell that only one version has changed too."""
    changed, unchanged = [], 0
    for name in sorted(set(old_tables) & set(new_tables)):
        old, new = dict(_values(before / name)), dict(_values(after / name))
        for key in [*old, *(key for key in new if key not in old)]:
            was, now = old.get(key), new.get(key)
            if was is not None and now is not None and was[0] == now[0]:
                unchanged += 1
                continue
            sigma = None
            if was is not None and now is not None:
                distance = distance_of(was[0], now[0], was[2])
                sigma = distance if was[2] is not None and distance < float("inf") else None
            changed.append(
                {
                    "cell": f"{name.removeprefix('tables/')}:{key}",
                    "old": was[0] if was else None,
                    "new": now[0] if now else None,
                    "old_uncertainty": was[1] if was else {},
                    "new_uncertainty": now[1] if now else {},
                    "sigma": sigma,
                }
            )
    return changed, unchanged


def _values(table: Path) -> Iterator[tuple[str, tuple[str, dict[str, str], float | None]]]:
    """``row:column`` -> value, its errors, its standard uncertainty, for every cell but the version id."""
    header, rows = read_table(table)
    for row, name in zip(rows, row_names(header, rows), strict=True):
        fields = dict(zip(header, row, strict=True))
        for column, value in fields.items():
            if column != _IDENTITY:
                errors = {item: fields[item] for item in error_columns(column, header)}
                yield f"{name}:{column}", (value, errors, standard_uncertainty(column, fields))
