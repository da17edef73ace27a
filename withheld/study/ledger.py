"""The book of studies that were scored: none is scored twice, and a page says how many came before."""

import fcntl
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from withheld.atomic import read_json, write_json
from withheld.errors import BadInput
from withheld.study.protocol import Protocol


def _read(path: Path) -> list[dict[str, Any]]:
    return list(read_json(path)) if path.exists() else []


@contextmanager
def _alone(path: Path) -> Iterator[None]:
    """One writer at a time, among processes too."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def enter(path: Path, protocol: Protocol, candidate: str, labels: str, diagnoses: str) -> dict[str, int]:
    """Enter a scoring, and say what stands before it.

    Parameters
    ----------
    path : Path
        The book.
    protocol : Protocol
        The study.
    candidate : str
        Its name.
    labels, diagnoses : str
        Hashes of the two seals.

    Returns
    -------
    dict
        `before`: earlier studies that count (`once`) of this candidate; `tries`: earlier scorings of studies
        that only try the path.

    Raises
    ------
    BadInput
        Where the study counts, and was scored before for this candidate with other diagnoses.
    """
    with _alone(path):
        return _enter(path, protocol, candidate, labels, diagnoses)


def _enter(path: Path, protocol: Protocol, candidate: str, labels: str, diagnoses: str) -> dict[str, int]:
    entries = _read(path)
    own = [e for e in entries if e["candidate"] == candidate]
    for number, entry in enumerate(own):
        if entry["labels"] != labels:
            continue
        if entry["diagnoses"] == diagnoses:
            return _before(own[:number])
        if protocol.once:
            raise BadInput(
                f"{path}: {candidate} was scored on this study before, with other diagnoses; take a new seed"
            )
    entries.append(
        {
            "study": protocol.name, "seed": protocol.seed, "cases": protocol.cases, "once": protocol.once,
            "candidate": candidate, "labels": labels, "diagnoses": diagnoses,
        }
    )  # fmt: skip
    write_json(path, entries)
    return _before(own)


def _before(entries: list[dict[str, Any]]) -> dict[str, int]:
    counting = sum(bool(e["once"]) for e in entries)
    return {"before": counting, "tries": len(entries) - counting}
