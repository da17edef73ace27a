"""A bag made into a working folder again: `make reduce` there redoes its campaign from the archived bytes.

============================ ======================================================================
``Snakefile``, ``fogreduce`` the software, as archived; ``make reduce`` installs it and runs
``campaigns, calibrations``  the inputs
``results/_captures``        captures that the workflow made, so that it does not make them again
``archived/<campaign>``      the archived results, to be compared with
============================ ======================================================================
"""

from __future__ import annotations

import os
import shutil
from hashlib import sha256
from pathlib import Path

from fogreduce.archive.contents import MADE
from fogreduce.archive.verify import Verified, verify
from fogreduce.archive.write import RECORD
from fogreduce.datasets.atomic import write_text
from fogreduce.errors import BadInput
from fogreduce.metadata.yaml12 import dump_yaml, load_yaml
from fogreduce.progress import Progress, silent
from fogreduce.provenance.manifest_file import MANIFEST
from fogreduce.provenance.records import read_manifest

ARCHIVED = "archived"
_CHUNK = 1 << 20
#: Places in the archive -> places in the folder that is restored.
_PLACES = {
    "software/": "",
    "campaigns/": "campaigns/",
    "calibrations/": "calibrations/",
    "captures/": f"results/{MADE}/",
    "results/": f"{ARCHIVED}/",
}


def restore(
    bag: Path,
    target: Path,
    expect: str | None = None,
    progress: Progress = silent,
) -> tuple[Verified, str | None]:
    """Verify a bag, then lay out a working folder; the folder appears whole or not at all.

    Parameters
    ----------
    bag, target : Path
        The bag; the folder, which must not exist.
    expect : str, optional
        SHA-256 that the bag's tag manifest must have.
    progress : callable
        Told how many bytes are read: each once to verify, once to restore.

    Returns
    -------
    Verified
        What the bag holds.
    str or None
        What does not fit into one configuration of the workflow.

    Raises
    ------
    BadInput
        The bag has faults, or is none of ours, or `target` is there.
    """
    if os.path.lexists(target):
        raise BadInput.at(target, "", found="something there already", expected="a new folder")
    found = verify(bag, expect, progress)
    if found.faults:
        raise BadInput(*found.faults)
    if not found.ours:
        record = bag / "data" / RECORD
        raise BadInput.at(record, "", found="no such file", expected="the record of `fogreduce archive`")
    at = target.with_name(f".{target.name}.{os.getpid()}.tmp")
    shutil.rmtree(at, ignore_errors=True)
    try:
        done = found.bytes
        for path, digest in sorted(found.payload.items()):
            place = restored_path(found.recorded.get(path, path).removeprefix("data/"))
            if place is not None:
                done += _copy(bag / path, at / place, digest)
                progress(done)
        note = _set_parameters(at)
        _make_older(at)
        at.rename(target)
    finally:
        shutil.rmtree(at, ignore_errors=True)
    return found, note


def _set_parameters(folder: Path) -> str | None:
    """Write the parameters of the archived runs into the workflow's configuration, where it has others.

    Returns what is to be said where the runs have different ones: the configuration then has the first run's.
    """
    manifests = [read_manifest(path.parent) for path in sorted((folder / ARCHIVED).glob(f"*/*/{MANIFEST}"))]
    first = manifests[0]
    config = folder / "workflow" / "config.yaml"
    settings = load_yaml(config)
    if settings.get("reduction") != first.parameters:
        write_text(config, dump_yaml({**settings, "reduction": first.parameters}))
    others = [manifest.run_id for manifest in manifests if manifest.parameters != first.parameters]
    if others:
        return f"reduced with other parameters than {first.run_id}, which workflow/config.yaml has: {others}"
    return None


def restored_path(path: str) -> str | None:
    """Where a file of the archive lies in the restored folder; None for the archive's own records."""
    for prefix, place in _PLACES.items():
        if path.startswith(prefix):
            return place + path.removeprefix(prefix)
    return None


def _copy(source: Path, target: Path, expected: str) -> int:
    """Copy a file, hashing what is copied: it may have changed since it was verified."""
    target.parent.mkdir(parents=True, exist_ok=True)
    digest, size = sha256(), 0
    descriptor = os.open(source, os.O_RDONLY | os.O_NOFOLLOW)
    with os.fdopen(descriptor, "rb", buffering=0) as file, target.open("xb") as copy:
        while chunk := file.read(_CHUNK):
            digest.update(chunk)
            copy.write(chunk)
            size += len(chunk)
    if (found := digest.hexdigest()) != expected:
        raise BadInput.at(source, "", found=f"SHA-256 {found}", expected=f"{expected}, as a moment ago")
    return size


def _make_older(folder: Path) -> None:
    """Make inputs older than made captures, so that the workflow takes these for what they are: done."""
    made = folder / "results" / MADE
    newest = folder.stat().st_mtime
    for path in folder.rglob("*"):
        if path.is_file() and not path.is_relative_to(made):
            os.utime(path, (newest - 3600, newest - 3600))
