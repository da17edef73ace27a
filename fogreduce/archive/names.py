"""Are the names of files such that an archive of them is valid to every BagIt tool?"""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable
from pathlib import Path

from fogreduce.errors import Fault
from fogreduce.metadata.file_name import problem_of_file_name


def plain_files(folder: Path) -> list[Path]:
    """The files directly in a folder that are archived with it: neither links nor hidden ones."""
    if not folder.is_dir():
        return []
    return sorted(
        path
        for path in folder.iterdir()
        if path.is_file() and not path.is_symlink() and not path.name.startswith(".")
    )


def faults_of_names(paths: Iterable[Path]) -> list[Fault]:
    """The names that will not do, and those that differ from another one in Unicode's form alone."""
    faults = []
    seen: dict[str, Path] = {}
    for path in paths:
        if problem := problem_of_file_name(path.name):
            faults.append(Fault(str(path), "", "a name that cannot be archived", problem))
        other = seen.setdefault(unicodedata.normalize("NFC", str(path)), path)
        if other != path:
            found = "the name of another file, in another Unicode form"
            faults.append(Fault(str(path), "", found, "names that differ"))
    return faults
