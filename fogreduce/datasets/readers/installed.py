"""Readers that a laboratory installs as a package of its own: entry points of the group `fogreduce.readers`.

An entry point's name is the format's; its value the reader, ``module:Class``. The package is part of what a
result comes from: its name, its version and its code are recorded in the manifest.
"""

from __future__ import annotations

import importlib.util
from dataclasses import dataclass
from hashlib import sha256
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

from fogreduce.errors import BadInput

GROUP = "fogreduce.readers"
_LARGEST_BYTES = 1 << 24  # of a file of a package; what is larger is data, and goes by its size


@dataclass(frozen=True)
class InstalledReader:
    """A reader from another package.

    Attributes
    ----------
    format : str
        Name of the format, as `capture.format` of run.yaml has it.
    module, name : str
        Where the reader is: module, and the class in it.
    distribution, version : str
        The package that installs it.
    """

    format: str
    module: str
    name: str
    distribution: str
    version: str

    @classmethod
    def of(cls, point: EntryPoint) -> InstalledReader:
        """From an entry point."""
        package = point.dist
        name, version = (package.name, package.version) if package else ("a package without a name", "")
        return cls(point.name, point.module, point.attr, name, version)

    def load(self) -> object:
        """The reader's class; BadInput where its package does not import."""
        try:
            found: object = getattr(importlib.import_module(self.module), self.name)
        except Exception as error:  # whatever a stranger's module raises as it is imported
            raise BadInput.at(
                f"package {self.distribution}",
                f"entry point {self.format}",
                found=f"{type(error).__name__}: {error}",
                expected=f"a reader, {self.name} of {self.module}",
            ) from None
        return found

    def code_sha256(self) -> str:
        """SHA-256 of the files of the package, or of the module, that holds the reader."""
        digest = sha256()
        for name, path in _files_of(self.module.partition(".")[0]):
            digest.update(name.encode("utf-8", "surrogateescape") + b"\0")
            size = path.stat().st_size
            said = path.read_bytes() if size <= _LARGEST_BYTES else b"%d bytes" % size
            digest.update(sha256(said).digest())
        return digest.hexdigest()


def installed_readers() -> dict[str, InstalledReader]:
    """The readers of all installed packages, by format.

    Raises
    ------
    BadInput
        Two packages have a reader for one format: which of them is meant, nobody can tell.
    """
    found: dict[str, InstalledReader] = {}
    for point in entry_points(group=GROUP):
        reader = InstalledReader.of(point)
        other = found.setdefault(reader.format, reader)
        if other != reader:
            raise BadInput.at(
                f"entry points {GROUP}",
                reader.format,
                found=" and ".join(sorted((other.distribution, reader.distribution))),
                expected="one package with a reader of that format",
            )
    return dict(sorted(found.items()))


def software_of(format_name: str) -> dict[str, str]:
    """What a manifest says of an installed reader; nothing of a format that none reads."""
    reader = installed_readers().get(format_name)
    if reader is None:
        return {}
    return {
        "reader": f"{reader.distribution} {reader.version}",
        "reader_code_sha256": reader.code_sha256(),
    }


def _files_of(top: str) -> list[tuple[str, Path]]:
    """Files of a top-level package or module, by their names in it, in order; compiled Python left out."""
    spec = importlib.util.find_spec(top)
    if spec is None:
        return []
    if not spec.submodule_search_locations:
        return [(Path(spec.origin).name, Path(spec.origin))] if spec.origin else []
    files = [
        (path.relative_to(folder).as_posix(), path)
        for folder in map(Path, spec.submodule_search_locations)
        for path in folder.rglob("*")
        if path.is_file() and path.suffix != ".pyc"
    ]
    return sorted(files)
