"""A BagIt bag (RFC 8493, version 1.0): written beside its name, and renamed when it is whole.

The package `bagit` reads these bags (the tests hold them against it) but does not write them: it writes
version 0.97, lists the tag files in the order in which the disk gives them, changes the process's working
folder, and reads every byte a second time. A bag of ours is the same bytes for the same content: no date, no
order that varies. Its last file, written when all others are on the disk, is tagmanifest-sha256.txt; the
SHA-256 of that file stands for every byte of the bag.
"""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable, Mapping
from hashlib import sha256
from pathlib import Path
from types import TracebackType

from fogreduce.archive.contents import Item
from fogreduce.datasets.atomic import sweep
from fogreduce.errors import BadInput
from fogreduce.progress import Progress, silent
from fogreduce.provenance.outputs import sync

DECLARATION = "BagIt-Version: 1.0\nTag-File-Character-Encoding: UTF-8\n"
PAYLOAD_MANIFEST = "manifest-sha256.txt"
TAG_MANIFEST = "tagmanifest-sha256.txt"
#: How much of its digest a bag's name has, where it has any.
NAME_DIGITS = 12
_CHUNK = 1 << 20


class BagWriter:
    """Writes one bag; to be used in a ``with`` block, at whose end `target` appears, or nothing.

    Parameters
    ----------
    target : Path
        The bag's folder, which must not exist.
    progress : callable
        Told how many bytes are written.
    by_digest : bool
        Add a dash and the first twelve digits of the tag manifest's SHA-256 to the folder's name. Such a
        bag may be there already: then it is these bytes, and it stays.
    """

    def __init__(self, target: Path, progress: Progress = silent, *, by_digest: bool = False) -> None:
        self.target = target
        self._by_digest = by_digest
        self.hashes: dict[str, str] = {}
        self.sizes: dict[str, int] = {}
        self._progress = progress
        self._done = 0
        self._at = target.with_name(f".{target.name}.{os.getpid()}.tmp")

    def __enter__(self) -> BagWriter:
        if not self._by_digest:
            self._must_be_new()
        self.target.parent.mkdir(parents=True, exist_ok=True)
        sweep(self.target)
        (self._at / "data").mkdir(parents=True)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, value: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is not None:
            shutil.rmtree(self._at, ignore_errors=True)

    def add(self, items: Iterable[Item]) -> None:
        """Copy files into the payload, hashing what is read; a hash other than recorded is refused."""
        buffer = memoryview(bytearray(_CHUNK))
        for item in items:
            target = self._place(item.path)
            digest, size = sha256(), 0
            with item.source.open("rb", buffering=0) as source, target.open("xb", buffering=0) as copy:
                while count := source.readinto(buffer):
                    digest.update(buffer[:count])
                    written = 0
                    while written < count:
                        written += copy.write(buffer[written:count])
                    size += count
                    self._done += count
                    self._progress(self._done)
                os.fsync(copy.fileno())
            found = digest.hexdigest()
            if item.sha256 is not None and found != item.sha256:
                raise BadInput.at(
                    item.source, "", found=f"SHA-256 {found}", expected=f"{item.sha256}, as recorded"
                )
            self.hashes[item.path], self.sizes[item.path] = found, size

    def add_text(self, path: str, text: str) -> None:
        """Write a payload file that is made here."""
        raw = text.encode()
        write_synced(self._place(path), raw)
        self.hashes[path], self.sizes[path] = sha256(raw).hexdigest(), len(raw)

    def finish(self, info: Mapping[str, str]) -> str:
        """Write the tag files and rename; returns the SHA-256 of the tag manifest."""
        oxum = f"{sum(self.sizes.values())}.{len(self.sizes)}"
        lines = [f"{key}: {value}\n" for key, value in sorted({**info, "Payload-Oxum": oxum}.items())]
        tags = {
            "bag-info.txt": "".join(lines),
            "bagit.txt": DECLARATION,
            PAYLOAD_MANIFEST: "".join(
                f"{self.hashes[path]}  data/{encoded(path)}\n" for path in sorted(self.hashes)
            ),
        }
        for name, text in tags.items():
            write_synced(self._at / name, text.encode())
        for folder, _, _ in os.walk(self._at):
            sync(Path(folder))
        last = "".join(f"{sha256(tags[name].encode()).hexdigest()}  {name}\n" for name in sorted(tags))
        write_synced(self._at / TAG_MANIFEST, last.encode())
        sync(self._at)
        digest = sha256(last.encode()).hexdigest()
        if self._by_digest:
            self.target = self.target.with_name(f"{self.target.name}-{digest[:NAME_DIGITS]}")
            if (self.target / TAG_MANIFEST).is_file() and (self.target / TAG_MANIFEST).read_text() == last:
                shutil.rmtree(self._at)
                return digest
            self._must_be_new()
        self._at.rename(self.target)
        sync(self.target.parent)
        return digest

    def _must_be_new(self) -> None:
        if os.path.lexists(self.target):
            raise BadInput.at(self.target, "", found="something there already", expected="a new name")

    def _place(self, path: str) -> Path:
        target = self._at / "data" / path
        target.parent.mkdir(parents=True, exist_ok=True)
        return target


def write_synced(path: Path, content: bytes) -> None:
    """Write a new file, and have it on the disk."""
    with path.open("xb") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())


def encoded(path: str) -> str:
    """A path as a manifest has it (RFC 8493, 2.1.3): CR, LF and % are escaped."""
    return path.replace("%", "%25").replace("\n", "%0A").replace("\r", "%0D")
