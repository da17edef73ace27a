"""Append-only: each finished version of a run's results stays, in ``versions/``, beside the newest.

``versions/<n>-<version_id>/`` holds what the results folder held when its checksums were taken: small files
copied, large ones as hard links, which cost nothing until the newest version is written anew (a new
file under the same name; the link keeps the old one).
"""

from __future__ import annotations

import os
import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from fogreduce.datasets.atomic import sweep
from fogreduce.provenance.manifest_file import OUTPUTS, read_outputs_data
from fogreduce.provenance.outputs import VERSIONS

_NAME = re.compile(r"([1-9][0-9]{0,5})-([0-9a-f]{16})")
_SMALL_BYTES = 1 << 20


@dataclass(frozen=True)
class Version:
    """One finished version of a run's results."""

    number: int
    version_id: str
    folder: Path


def kept_versions(results: Path) -> list[Version]:
    """The versions that are kept beside a run's results, the oldest first."""
    folder = results / VERSIONS
    if not folder.is_dir():
        return []
    found = []
    for path in folder.iterdir():
        if (match := _NAME.fullmatch(path.name)) and path.is_dir() and not path.is_symlink():
            found.append(Version(int(match[1]), match[2], path))
    return sorted(found, key=lambda version: version.number)


def keep(results: Path, data: Mapping[str, Any]) -> Version:
    """Keep the results whose checksums are `data`; where they are kept already, that version."""
    kept = kept_versions(results)
    for version in kept:
        earlier = read_outputs_data(version.folder)
        if all(earlier.get(key) == data[key] for key in ("version_id", "files")):
            return version
    number = kept[-1].number + 1 if kept else 1
    target = results / VERSIONS / f"{number}-{data['version_id']}"
    sweep(target)
    temporary = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    shutil.rmtree(temporary, ignore_errors=True)
    try:
        for name in [file["name"] for file in data["files"]] + [OUTPUTS]:
            _keep_file(results / name, temporary / name)
        temporary.rename(target)
    finally:
        shutil.rmtree(temporary, ignore_errors=True)
    return Version(number, data["version_id"], target)


def _keep_file(source: Path, target: Path) -> None:
    target.parent.mkdir(parents=True, exist_ok=True)
    if source.stat().st_size > _SMALL_BYTES:
        try:
            os.link(source, target)
            return
        except OSError:
            pass  # a file system without hard links: copy
    shutil.copyfile(source, target)
