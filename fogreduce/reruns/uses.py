"""Which results used a calibration record: what manifests say, the newest and each kept one.

A record is immutable from its first use on: its name stands in results for its bytes. Where the file that now
bears the name has other bytes, nothing is reduced with it (`refuse_rewritten`).
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from fogreduce.errors import BadInput
from fogreduce.provenance.manifest_file import MANIFEST

#: In a folder of results: records whose file is no more what results were reduced with, with these results.
REWRITTEN = "_rewritten.json"
#: As `fogreduce.provenance.manifest` writes it; in free text its quotation marks would be escaped.
_USED = re.compile(rb'"calibration":\s*\{\s*"id":\s*"([^"\s]+)",\s*"sha256":\s*"([0-9a-f]{64})"')
_NAMED = 3  # results that a fault names; the rest are counted


@dataclass(frozen=True)
class Use:
    """A version of a run's results, and the record that it was reduced with.

    Attributes
    ----------
    results : str
        ``<campaign>/<run>``, or the name of the folder that a single run was reduced into.
    version : str
        Folder of a kept version, such as ``1-0f3a...``; empty for the newest.
    record_id, sha256 : str
        The record and its digest.
    """

    results: str
    version: str
    record_id: str
    sha256: str

    def __str__(self) -> str:
        return f"{self.results}, version {self.version}" if self.version else self.results


def uses_in(folders: Iterable[Path], below: Path) -> list[Use]:
    """Uses in folders of results of a run.

    Parameters
    ----------
    folders : iterable of Path
        Of one run each.
    below : Path
        Folder from which on they are named.
    """
    found: dict[Use, None] = {}
    for folder in folders:
        name = folder.relative_to(below).as_posix()
        for version, manifest in _manifests(folder):
            try:
                match = _USED.search(manifest.read_bytes())
            except OSError:
                continue
            if match:
                found[Use(name, version, match[1].decode(), match[2].decode())] = None
    return list(found)


def _manifests(folder: Path) -> list[tuple[str, Path]]:
    versions = folder / "versions"
    kept = sorted(path for path in versions.iterdir() if path.name[0] != ".") if versions.is_dir() else []
    return [("", folder / MANIFEST), *((path.name, path / MANIFEST) for path in kept)]


def uses_below(results: Path) -> list[Use]:
    """Every use in a folder of results, ``<results>/<campaign>/<run>``, in order of their names."""
    if not results.is_dir():
        raise BadInput.at(results, "", found="no such folder", expected="a folder of results")
    folders = sorted(path.parent for path in results.glob(f"*/*/{MANIFEST}") if path.parts[-3][0] not in "_.")
    return uses_in(folders, results)


def rewritten(uses: Iterable[Use], digests: Mapping[str, str]) -> dict[str, list[str]]:
    """Records that were used and whose files have other bytes now.

    Parameters
    ----------
    uses : iterable of Use
    digests : mapping
        Record id -> SHA-256 of the file that bears it now; a record that is not there is passed over.

    Returns
    -------
    dict
        Record id -> the results that were reduced with it, the newest version of each.
    """
    by_record: dict[str, list[Use]] = {}
    for use in uses:
        by_record.setdefault(use.record_id, []).append(use)
    return {
        record_id: list(dict.fromkeys(use.results for use in of_it))
        for record_id, of_it in by_record.items()
        if record_id in digests and all(use.sha256 != digests[record_id] for use in of_it)
    }


def refuse_rewritten(
    record_id: str, sha256: str, calibrations: Path, out: Path, *, neighbours: bool = False
) -> None:
    """BadInput where results were reduced with other bytes of a record than its file has now.

    Parameters
    ----------
    record_id, sha256 : str
        The record, and the digest of its file.
    calibrations : Path
        Folder of the records.
    out : Path
        Folder that a run is to be reduced into; what it holds is looked at, and what the workflow noted of
        all results.
    neighbours : bool
        Whether to look into the folders next to it as well.
    """
    folders = sorted(path.parent for path in out.parent.glob(f"*/{MANIFEST}")) if neighbours else [out]
    used = rewritten(uses_in(folders, out.parent), {record_id: sha256})
    users = _noted(out.parent.parent).get(record_id) or used.get(record_id)
    if users:
        were = "was" if len(users) == 1 else "were"
        raise BadInput.at(
            calibrations / f"{record_id.replace('@', '/')}.yaml",
            "",
            found=f"another content than {some_of(users)} {were} reduced with",
            expected=f"{record_id} as it was: a record that was used is never rewritten; a changed one needs "
            "a version of its own",
        )


def _noted(results: Path) -> dict[str, list[str]]:
    try:
        noted = json.loads((results / REWRITTEN).read_bytes())
    except (OSError, ValueError):
        return {}
    return noted if isinstance(noted, dict) else {}


def some_of(names: Sequence[str]) -> str:
    """Some names in words, and how many there are more."""
    if len(names) <= _NAMED + 1:
        return " and ".join(filter(None, (", ".join(names[:-1]), names[-1])))
    return f"{', '.join(names[:_NAMED])} and {len(names) - _NAMED} more"
