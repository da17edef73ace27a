"""Results that are no longer what they were when their checksums were taken: edited by hand, or spoilt.

Quick enough for every call of the workflow: a file is read only where its size differs or it was written
after its checksums were.  `fogreduce verify` reads every byte.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fogreduce.provenance.digest import VERSION_ID_DIGITS, data_digest, file_digest
from fogreduce.provenance.manifest_file import MANIFEST, OUTPUTS
from fogreduce.provenance.stages import STAGES

_GONE = "gone"
#: What no stage writes; the rest lies in a folder of its rule's name.
_OTHERS = {
    MANIFEST: "manifest",
    "index.html": "run_page",
    "reports/overview.json": "run_page",
    OUTPUTS: "checksums",
}


def edited(folder: Path) -> dict[str, str]:
    """The files of a run's results that changed since their checksums were taken.

    Returns
    -------
    dict
        SHA-256 of what is found, or ``gone``, by the file's name; empty where nothing changed, where no
        checksums were taken, and where the run is being reduced anew (its manifest is already another one).
    """
    record = folder / OUTPUTS
    try:
        taken_ns = record.stat().st_mtime_ns
        entries = [
            (str(entry["name"]), int(entry["bytes"]), str(entry["sha256"]))
            for entry in json.loads(record.read_bytes())["files"]
        ]
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, KeyError, TypeError):
        return {OUTPUTS: _GONE}
    found = {}
    for name, size, sha256 in entries:
        now = _changed(folder / name, size, sha256, taken_ns)
        if now is not None:
            found[name] = now
    if MANIFEST in found and _is_whole(folder / MANIFEST):
        return {}
    return found


def _changed(path: Path, size: int, sha256: str, taken_ns: int) -> str | None:
    """What a file is now, None where it is what it was."""
    try:
        now = path.stat()
        if now.st_size == size and now.st_mtime_ns <= taken_ns:
            return None
        digest = file_digest(path)
    except OSError:
        return _GONE
    return None if digest == sha256 else digest


def _is_whole(manifest: Path) -> bool:
    """Whether a manifest agrees with its own version id: the workflow's, then, and not a hand's."""
    try:
        data: dict[str, Any] = json.loads(manifest.read_bytes())
        stated = data.pop("version_id")
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return False
    return bool(data_digest(data)[:VERSION_ID_DIGITS] == stated)


def rule_of(name: str) -> str:
    """The rule of the workflow that makes a file of the results."""
    for stage, facts in STAGES.items():
        if name in facts.writes:
            return stage
    return _OTHERS.get(name, name.split("/")[0])


def notes_of(before: Mapping[str, Mapping[str, str]], run: str, files: Mapping[str, str]) -> dict[str, str]:
    """What the workflow remembers of a run: by rule, a digest of all that was found edited of its outputs.

    It is a parameter of the rule.  It stays as it is after the output is made anew, so that it is made once.
    """
    notes = dict(before.get(run, {}))
    by_rule: dict[str, dict[str, str]] = {}
    for name, found in files.items():
        by_rule.setdefault(rule_of(name), {})[name] = found
    for rule, names in by_rule.items():
        notes[rule] = data_digest([notes.get(rule, ""), names])[:VERSION_ID_DIGITS]
    return notes
