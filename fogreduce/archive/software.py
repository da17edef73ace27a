"""The source of the package, as a folder that pip installs and `make reduce` runs: an unpacked sdist."""

from __future__ import annotations

from pathlib import Path

import fogreduce
from fogreduce.errors import BadInput

#: Files of the source folder that an archive cannot do without.
NEEDED = ("Snakefile", "pyproject.toml", "requirements.lock")
_FILES = (*NEEDED, "CHANGELOG.md", "LICENSE", "Makefile", "README.md")
_FOLDERS = ("fogreduce", "profiles", "schemas", "withheld", "workflow")


def source_folder(given: Path | None) -> Path:
    """The folder of the source: `given`, or where the package that runs was imported from."""
    folder = Path(fogreduce.__file__).resolve().parents[1] if given is None else given
    missing = [name for name in NEEDED if not (folder / name).is_file()]
    if missing:
        place = folder if given is not None else "--source"
        raise BadInput.at(
            place, "", found=f"no {missing[0]}", expected="the folder of fogreduce's source, to be archived"
        )
    return folder


def source_files(folder: Path) -> list[str]:
    """Names of the files that belong to the source, in order; caches and hidden files do not."""
    names = [name for name in _FILES if (folder / name).is_file()]
    for part in _FOLDERS:
        for path in (folder / part).rglob("*"):
            name = path.relative_to(folder)
            if path.is_file() and not path.is_symlink() and not any(map(_is_aside, name.parts)):
                names.append(name.as_posix())
    return sorted(names)


def _is_aside(part: str) -> bool:
    return part.startswith(".") or part == "__pycache__" or part.endswith((".egg-info", ".pyc"))
