"""Is a bag what it was? Fixity of every byte, completeness, validity of its records, and that they agree."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from fogreduce.archive.bag import PAYLOAD_MANIFEST, TAG_MANIFEST
from fogreduce.archive.consistency import inconsistencies
from fogreduce.archive.facts import Facts
from fogreduce.archive.fixity import hash_files
from fogreduce.archive.tagfiles import declaration_fault, read_info, read_manifest_lines
from fogreduce.archive.walk import Listing, walk
from fogreduce.errors import BadInput, Fault

_INFO, _DECLARATION = "bag-info.txt", "bagit.txt"
_TAGS = (_INFO, _DECLARATION, PAYLOAD_MANIFEST)
_LARGEST_TAG_BYTES = 1 << 28


@dataclass(frozen=True)
class Verified:
    """What was found: nothing is wrong where `faults` is empty."""

    digest: str
    files: int
    bytes: int
    campaign: str
    faults: tuple[Fault, ...]


def verify(
    bag: Path, expect: str | None = None, progress: Callable[[int], None] = lambda done: None
) -> Verified:
    """Verify a bag.

    Parameters
    ----------
    bag : Path
        The bag's folder.
    expect : str, optional
        SHA-256 that the tag manifest must have, as `fogreduce archive` printed it.
    progress : callable
        Told how many bytes are read.

    Raises
    ------
    BadInput
        It is no bag, or holds what no bag of ours can hold (links, say): then nothing of it is read.
    """
    listing = listed(bag)
    tags = {name: _read(bag / name) for name in (*_TAGS, TAG_MANIFEST)}
    digest = sha256(tags[TAG_MANIFEST]).hexdigest()
    faults: list[Fault] = []
    if expect is not None and digest != expect:
        faults.append(Fault(str(bag / TAG_MANIFEST), "", f"SHA-256 {digest}", f"{expect}, as asked for"))
    stated, found = read_manifest_lines(tags[TAG_MANIFEST], str(bag / TAG_MANIFEST), "")
    faults += found
    faults += _tags_against(bag, stated, tags, listing)
    faults += declaration_fault(tags[_DECLARATION], str(bag / _DECLARATION))
    payload, found = read_manifest_lines(tags[PAYLOAD_MANIFEST], str(bag / PAYLOAD_MANIFEST), "data/")
    faults += found
    info, found = read_info(tags[_INFO], str(bag / _INFO))
    faults += found
    present = {path: size for path, size in listing.sizes.items() if path.startswith("data/")}
    faults += _completeness(bag, payload, present)
    oxum = f"{sum(present.values())}.{len(present)}"
    if info.get("Payload-Oxum") != oxum:
        faults.append(Fault(str(bag / _INFO), "Payload-Oxum", str(info.get("Payload-Oxum")), oxum))

    facts = Facts(bag / "data")
    hashes: dict[str, str] = {}
    faults += hash_files(
        bag,
        sorted(present),
        hashes,
        lambda path: facts.wants(path.removeprefix("data/")),
        lambda path, raw: facts.add(path.removeprefix("data/"), raw),
        progress,
    )
    for path, expected in payload.items():
        if path in hashes and hashes[path] != expected:
            faults.append(
                Fault(str(bag / path), "", f"SHA-256 {hashes[path]}", f"{expected}, as its manifest")
            )
    files = {path.removeprefix("data/"): (digest_, present[path]) for path, digest_ in hashes.items()}
    named = {fault.file for fault in faults}
    further = [*facts.faults, *inconsistencies(facts, files, info.get("External-Identifier", ""))]
    # One fault a file is enough where its bytes are not those that were archived.
    faults += [fault for fault in further if fault.file not in named]
    campaign = info.get("External-Identifier", "")
    return Verified(digest, len(present), sum(present.values()), campaign, tuple(faults))


def listed(bag: Path) -> Listing:
    """The files of a bag; BadInput where it is none, or holds what must not even be opened."""
    if not bag.is_dir():
        found = "a file" if bag.exists() else "no such folder"
        raise BadInput.at(bag, "", found=found, expected="a bag, as `fogreduce archive` writes it")
    listing = walk(bag)
    if listing.faults:
        raise BadInput(*listing.faults)
    for name in (TAG_MANIFEST, *_TAGS):
        size = listing.sizes.get(name)
        if size is None:
            raise BadInput.at(bag / name, "", found="no such file", expected="one in every bag")
        if size > _LARGEST_TAG_BYTES:
            raise BadInput.at(bag / name, "", found=f"{size} bytes", expected=f"at most {_LARGEST_TAG_BYTES}")
    return listing


def _read(path: Path) -> bytes:
    return path.read_bytes()


def _tags_against(bag: Path, stated: dict[str, str], tags: dict[str, bytes], listing: Listing) -> list[Fault]:
    faults = []
    for name in _TAGS:
        found = sha256(tags[name]).hexdigest()
        if name not in stated:
            faults.append(Fault(str(bag / TAG_MANIFEST), "", f"no line of {name}", "one"))
        elif stated[name] != found:
            expected = f"{stated[name]}, as {bag / TAG_MANIFEST} has it"
            faults.append(Fault(str(bag / name), "", f"SHA-256 {found}", expected))
    for name in sorted(set(stated) - set(_TAGS)):
        faults.append(Fault(str(bag / TAG_MANIFEST), "", f"a line of {name}", "none"))
    for path in sorted(listing.sizes):
        if not path.startswith("data/") and path not in tags:
            faults.append(Fault(str(bag / path), "", "a file that is not listed", "no such file"))
    return faults


def _completeness(bag: Path, payload: dict[str, str], present: dict[str, int]) -> list[Fault]:
    faults = []
    for path in sorted(set(payload) - set(present)):
        faults.append(Fault(str(bag / path), "", "no such file", "one, as its manifest lists it"))
    for path in sorted(set(present) - set(payload)):
        faults.append(Fault(str(bag / path), "", "a file that is not listed", "no such file"))
    return faults
