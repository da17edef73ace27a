"""Which captures of a folder an earlier simulation wrote: those, and no others, may be written over.

``<out>.injected.yaml`` lists each with its size and the SHA-256 of its first MiB: enough to tell it from a
measured one, and as quick for a capture of a day as for one of a minute.
"""

from __future__ import annotations

import fcntl
import hashlib
import os
from collections.abc import Container, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

from fogreduce.errors import BadInput, Fault
from fogreduce.metadata.yaml12 import load_yaml

_HEAD_BYTES = 1 << 20

Marks = list[dict[str, object]]


def mark_of(run_id: str, capture: Path) -> dict[str, object]:
    """An entry of the list ``captures``."""
    with capture.open("rb") as file:
        head = hashlib.sha256(file.read(_HEAD_BYTES)).hexdigest()
    return {"run": run_id, "bytes": capture.stat().st_size, "head_sha256": head}


def earlier_captures(captures: Mapping[str, Path], record: Path, overwrite: bool = True) -> Marks:
    """What an earlier simulation listed of captures that stand where these are to be written.

    Parameters
    ----------
    captures : mapping
        Run -> where its capture is to be written.
    record : Path
        ``<out>.injected.yaml``, which need not be there.
    overwrite : bool
        Whether those of an earlier simulation may be written over.

    Raises
    ------
    BadInput
        A capture stands there that no simulation wrote, or one that is not to be written over.
    """
    listed = _listed(record)
    there = {run_id: path for run_id, path in captures.items() if path.exists()}
    marks = {run_id: mark_of(run_id, path) for run_id, path in there.items()}
    faults = [
        Fault(
            str(there[run_id]),
            "",
            "a capture that no `fogreduce simulate` wrote",
            f"another folder, or one that {record.name} lists",
        )
        for run_id, mark in marks.items()
        if mark not in listed
    ]
    if faults:
        raise BadInput(faults[0])
    if there and not overwrite:
        found = f"{len(there)} captures of an earlier simulation" if len(there) > 1 else "a simulated capture"
        raise BadInput.at(
            next(iter(there.values())), "", found=found, expected="another --out, or --overwrite"
        )
    return list(marks.values())


def listed_of_others(runs: Container[str], record: Path) -> Marks:
    """What ``<out>.injected.yaml`` lists of runs other than these."""
    return [entry for entry in _listed(record) if entry.get("run") not in runs]


@contextmanager
def sole_simulation_in(folder: Path) -> Iterator[None]:
    """No other process that asks for the same is at work on the folder meanwhile."""
    folder.mkdir(parents=True, exist_ok=True)
    handle = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        os.close(handle)


def _listed(record: Path) -> Marks:
    try:
        listed = load_yaml(record).get("captures")
    except BadInput:
        return []
    return [entry for entry in listed if isinstance(entry, dict)] if isinstance(listed, list) else []
