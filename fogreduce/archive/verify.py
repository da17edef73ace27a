"""Is a bag what it was? Fixity of every byte, completeness, validity of its records, and that they agree."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import sha256
from pathlib import Path

from fogreduce.archive.bag import PAYLOAD_MANIFEST, TAG_MANIFEST
from fogreduce.archive.consistency import inconsistencies
from fogreduce.archive.facts import Facts
from fogreduce.archive.fixity import hash_files
from fogreduce.archive.manifests import PAYLOAD, TAGS, Manifests, read_manifests, read_tag_file
from fogreduce.archive.tagfiles import read_declaration, read_fetch, read_info
from fogreduce.archive.walk import Listing, walk
from fogreduce.archive.write import AGENT, RECORD
from fogreduce.errors import BadInput, Fault
from fogreduce.progress import Progress, silent

_INFO, _DECLARATION, _FETCH = "bag-info.txt", "bagit.txt", "fetch.txt"


@dataclass(frozen=True)
class Verified:
    """What was found: nothing is wrong where `faults` is empty.

    Attributes
    ----------
    digest : str
        SHA-256 of the tag manifest; empty where there is none of SHA-256.
    files, bytes : int
        Of the payload.
    campaign : str
        What is archived.
    ours : bool
        Whether `fogreduce archive` wrote it. Of another bag only the bytes were held against its manifests.
    payload : mapping
        SHA-256 of each payload file by its path in the bag, and
    recorded : mapping
        the path that the bag's maker gave it, where the disk spells it otherwise.
    unusual : tuple of str
        What is valid but not as most tools write it.
    faults : tuple of Fault
        What is not valid.
    """

    digest: str
    files: int
    bytes: int
    campaign: str
    ours: bool = True
    payload: Mapping[str, str] = field(default_factory=dict)
    recorded: Mapping[str, str] = field(default_factory=dict)
    unusual: tuple[str, ...] = ()
    faults: tuple[Fault, ...] = ()


def verify(bag: Path, expect: str | None = None, progress: Progress = silent) -> Verified:
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
        It is no bag, or holds what is not even opened (links, say): then nothing of it is read.
    """
    listing = listed(bag)
    raw = read_tag_file(bag, listing, _DECLARATION)
    version, encoding, faults = read_declaration(raw, str(bag / _DECLARATION))
    tags = read_manifests(bag, listing, TAGS, encoding)
    payload = read_manifests(bag, listing, PAYLOAD, encoding)
    info, unusual, found = _info(bag, listing, encoding)
    faults += [*tags.faults, *payload.faults, *found]
    unusual = [*tags.unusual, *payload.unusual, *unusual]
    ours = f"data/{RECORD}" in {*payload.paths, *listing.sizes}
    ours = ours or info.get("bag-software-agent", "").startswith(AGENT)
    digest = ""
    if TAG_MANIFEST in listing.sizes:
        digest = sha256(read_tag_file(bag, listing, TAG_MANIFEST)).hexdigest()
    if expect is not None and digest != expect:
        stated = f"SHA-256 {digest}" if digest else "no such file"
        faults.append(Fault(str(bag / TAG_MANIFEST), "", stated, f"{expect}, as asked for"))
    aside = _not_listed(bag, listing, tags)
    faults += aside if ours else []
    unusual += [] if ours else [f"{fault.found} ({Path(fault.file).relative_to(bag)})" for fault in aside]
    present = {path: size for path, size in listing.sizes.items() if path.startswith("data/")}
    fetch = _fetch(bag, listing, encoding)
    faults += _completeness(bag, tags, set(listing.sizes), fetch)
    faults += _completeness(bag, payload, set(present), fetch)
    faults += _unlisted_payload(bag, payload, set(present), version)
    faults += _oxum(bag, info.get("payload-oxum"), present, required=ours)

    hashes: dict[str, dict[str, str]] = {}
    facts = Facts(bag / "data")
    spelt = {path: payload.recorded.get(path, path).removeprefix("data/") for path in present}
    faults += hash_files(
        bag,
        sorted({*present, *(tags.paths & set(listing.sizes))}),
        {"sha256", *tags.hashes, *payload.hashes},
        hashes,
        lambda path: ours and path in spelt and facts.wants(spelt[path]),
        lambda path, kept: facts.add(spelt[path], kept),
        progress,
    )
    faults += [*tags.against(bag, hashes), *payload.against(bag, hashes)]
    campaign = info.get("external-identifier", "")
    sha256s = {path: hashes[path]["sha256"] for path in present if path in hashes}
    if ours:
        files = {spelt[path]: (found, present[path]) for path, found in sha256s.items()}
        named = {fault.file for fault in faults}
        further = [*facts.faults, *inconsistencies(facts, files, campaign)]
        # One fault a file is enough where its bytes are not those that were archived.
        faults += [fault for fault in further if fault.file not in named]
    return Verified(
        digest,
        len(present),
        sum(present.values()),
        campaign,
        ours,
        sha256s,
        payload.recorded,
        tuple(unusual),
        tuple(faults),
    )


def listed(bag: Path) -> Listing:
    """The files of a bag; BadInput where it is none, or holds what must not even be opened."""
    if not bag.is_dir():
        found = "a file" if bag.exists() else "no such folder"
        raise BadInput.at(bag, "", found=found, expected="a bag, as `fogreduce archive` writes it")
    listing = walk(bag)
    if listing.faults:
        raise BadInput(*listing.faults)
    if _DECLARATION not in listing.sizes:
        raise BadInput.at(bag / _DECLARATION, "", found="no such file", expected="one in every bag")
    if not any(name.startswith(f"{PAYLOAD}-") for name in listing.sizes):
        raise BadInput.at(bag / PAYLOAD_MANIFEST, "", found="no such file", expected="a payload manifest")
    return listing


def _info(bag: Path, listing: Listing, encoding: str) -> tuple[dict[str, str], list[str], list[Fault]]:
    """Fields of bag-info.txt, which a bag may be without."""
    if _INFO not in listing.sizes:
        return {}, [], []
    fields, unusual, faults = read_info(read_tag_file(bag, listing, _INFO), str(bag / _INFO), encoding)
    return fields, [f"{what} ({_INFO})" for what in sorted(unusual)], faults


def _fetch(bag: Path, listing: Listing, encoding: str) -> set[str]:
    """The payload files that are to be fetched from elsewhere where they are not here."""
    if _FETCH not in listing.sizes:
        return set()
    return read_fetch(read_tag_file(bag, listing, _FETCH), encoding, listing.find)


def _not_listed(bag: Path, listing: Listing, tags: Manifests) -> list[Fault]:
    """What no manifest vouches for: `fogreduce archive` leaves no such thing, other tools may."""
    faults = [Fault(str(bag / folder), "", "an empty folder", "files in it") for folder in listing.empty]
    if not tags.hashes:
        return [*faults, Fault(str(bag / TAG_MANIFEST), "", "no such file", "a manifest of the tag files")]
    expected = f"one that {tags.shown(bag)} lists"
    for path in sorted(listing.sizes):
        if not path.startswith(("data/", f"{TAGS}-")) and path not in tags.paths:
            faults.append(Fault(str(bag / path), "", "a file that is not listed", expected))
    return faults


def _completeness(bag: Path, manifests: Manifests, present: set[str], fetch: set[str]) -> list[Fault]:
    """Files that are listed and not there."""
    missing = manifests.paths - present
    expected = f"one, as {manifests.shown(bag)} lists it"
    faults = [Fault(str(bag / path), "", "no such file", expected) for path in sorted(missing - fetch)]
    if away := sorted(missing & fetch):
        found = f"{len(away)} files that are still to be fetched, the first {away[0]}"
        faults.append(Fault(str(bag / _FETCH), "", found, "a bag with all its files"))
    return faults


def _unlisted_payload(bag: Path, payload: Manifests, present: set[str], version: str) -> list[Fault]:
    """Payload files that are there and not listed."""
    # Before version 1.0 a file had to be in one of the manifests, since then in each (RFC 8493, 2.1.3).
    lists = payload.hashes.values() if version == "1.0" else [payload.paths]
    unlisted = set().union(*(present - set(paths) for paths in lists))
    expected = f"one that {payload.shown(bag)} lists"
    return [Fault(str(bag / path), "", "a file that is not listed", expected) for path in sorted(unlisted)]


def _oxum(bag: Path, stated: str | None, present: dict[str, int], *, required: bool) -> list[Fault]:
    """Payload-Oxum against the payload: bytes, a point, files."""
    oxum = f"{sum(present.values())}.{len(present)}"
    if stated == oxum or (stated is None and not required):
        return []
    return [Fault(str(bag / _INFO), "Payload-Oxum", stated or "nothing", f"{oxum}, bytes and files of data/")]
