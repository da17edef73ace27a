"""outputs.json: size and SHA-256 of every file of a run's results, taken when they are finished."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from fogreduce.constants import OUTPUTS_SCHEMA
from fogreduce.datasets.atomic import write_text
from fogreduce.errors import BadInput
from fogreduce.progress import Progress, silent
from fogreduce.provenance.digest import file_digest
from fogreduce.provenance.machine import machine
from fogreduce.provenance.manifest_file import OUTPUTS, read_manifest_data
from fogreduce.provenance.version_ids import ids_of_result

#: Older versions of the results, beside the new.
VERSIONS = "versions"
#: What lies in a run's folder and is not a result: it differs each time.
_ASIDE = ("logs", "benchmarks", VERSIONS)


def result_files(folder: Path) -> Iterator[str]:
    """Names of the files of a run's results, in order; hidden ones, logs and benchmarks are no results."""
    for entry in sorted(folder.iterdir()):
        if entry.name.startswith(".") or entry.name in (*_ASIDE, OUTPUTS):
            continue
        yield from _files(entry, folder)


def _files(path: Path, folder: Path) -> Iterator[str]:
    if path.is_symlink():
        raise BadInput.at(path, "", found="a link", expected="a file of the results")
    if path.is_file():
        yield path.relative_to(folder).as_posix()
    elif path.is_dir():
        for entry in sorted(path.iterdir()):
            if not entry.name.startswith("."):
                yield from _files(entry, folder)
    else:
        raise BadInput.at(path, "", found="neither a file nor a folder", expected="a file of the results")


def checksums(folder: Path, progress: Progress = silent) -> dict[str, Any]:
    """The content of outputs.json for a run's results folder, as its files are now.

    `progress` hears how many bytes are read.
    """
    version_id = read_manifest_data(folder)["version_id"]
    _complete(folder, version_id)
    files, done = [], 0

    def read(count: int) -> None:
        nonlocal done
        done += count
        progress(done)

    for name in result_files(folder):
        path = folder / name
        files.append({"name": name, "bytes": path.stat().st_size, "sha256": file_digest(path, read)})
    return {
        "schema": OUTPUTS_SCHEMA,
        "version_id": version_id,
        "machine": machine(),
        "files": files,
    }


def _complete(folder: Path, version_id: str) -> None:
    """BadInput unless the last stage's table is there, and every file is of the manifest's version."""
    path = folder / "tables" / "drift.csv"
    if not path.is_file():
        raise BadInput.at(path, "", found="no such file", expected="the table of the last stage")
    for name in result_files(folder):
        for found in sorted(ids_of_result(folder, name) - {version_id}):
            expected = f"{version_id}, as the manifest has it"
            raise BadInput.at(folder / name, "version_id", found=found, expected=expected)


def results_bytes(folder: Path) -> int:
    """Size of a run's results; 0 where there is no such folder."""
    return sum((folder / name).stat().st_size for name in result_files(folder)) if folder.is_dir() else 0


def write_checksums(folder: Path, progress: Progress = silent) -> dict[str, Any]:
    """Write outputs.json; its content. `progress` hears how many of the `results_bytes` are read."""
    if not folder.is_dir():
        raise BadInput.at(folder, "", found="no such folder", expected="a run's results")
    data = checksums(folder, progress)
    write_text(folder / OUTPUTS, json.dumps(data, indent=1, allow_nan=False) + "\n")
    return data


def sync(path: Path) -> None:
    """Make sure that a file's or folder's bytes are on the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
