"""The manifests of a bag taken together: one for each algorithm, of the payload or of the tag files."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

from fogreduce.archive.tagfiles import DIGITS, read_manifest_lines
from fogreduce.archive.walk import Listing
from fogreduce.errors import BadInput, Fault

LARGEST_TAG_BYTES = 1 << 28
#: Payload manifests, and manifests of tag files.
PAYLOAD, TAGS = "manifest", "tagmanifest"


@dataclass
class Manifests:
    """The manifests of one kind.

    Attributes
    ----------
    hashes : dict
        By algorithm, the digest of each file by its path as the disk spells it; and
    names : dict
        the manifest's name.
    recorded : dict
        The manifests' spelling of a path, where the disk has another.
    unusual : list of str
        What is valid but not as most tools write it, with the file's name.
    faults : list of Fault
        What is not valid.
    """

    hashes: dict[str, dict[str, str]] = field(default_factory=dict)
    names: dict[str, str] = field(default_factory=dict)
    recorded: dict[str, str] = field(default_factory=dict)
    unusual: list[str] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)

    @property
    def paths(self) -> set[str]:
        """All files that any of them lists."""
        return set().union(*self.hashes.values())

    def shown(self, bag: Path) -> str:
        """The manifests by name."""
        return " and ".join(str(bag / name) for name in self.names.values())

    def against(self, bag: Path, found: dict[str, dict[str, str]]) -> list[Fault]:
        """Faults of the files whose digests are others; `found` has them by path and algorithm."""
        faults = []
        for algorithm, hashes in self.hashes.items():
            for path, expected in hashes.items():
                digest = found[path][algorithm] if path in found else expected
                if digest != expected:
                    name = f"SHA-{algorithm[3:]}" if algorithm.startswith("sha") else algorithm.upper()
                    as_stated = f"{expected}, as {bag / self.names[algorithm]} has it"
                    faults.append(Fault(str(bag / path), "", f"{name} {digest}", as_stated))
        return faults


def read_manifests(bag: Path, listing: Listing, kind: str, encoding: str) -> Manifests:
    """Read all manifests of a kind, `PAYLOAD` or `TAGS`."""
    manifests = Manifests()
    for name in sorted(listing.sizes):
        match = re.fullmatch(rf"{kind}-([A-Za-z0-9-]+)\.txt", name)
        if match is None:
            continue
        algorithm = match[1].lower()
        if algorithm not in DIGITS:
            manifests.unusual.append(f"an algorithm that is not checked ({name})")
            continue
        prefix = "data/" if kind == PAYLOAD else ""
        raw = read_tag_file(bag, listing, name)
        found = read_manifest_lines(raw, str(bag / name), prefix, listing.find, algorithm, encoding)
        manifests.hashes[algorithm], manifests.names[algorithm] = found.hashes, name
        manifests.recorded |= found.recorded
        manifests.unusual += [f"{what} ({name})" for what in sorted(found.unusual)]
        manifests.faults += found.faults
    return manifests


def read_tag_file(bag: Path, listing: Listing, name: str) -> bytes:
    """The bytes of a tag file of at most `LARGEST_TAG_BYTES`."""
    if (size := listing.sizes[name]) > LARGEST_TAG_BYTES:
        raise BadInput.at(bag / name, "", found=f"{size} bytes", expected=f"at most {LARGEST_TAG_BYTES}")
    return (bag / name).read_bytes()
