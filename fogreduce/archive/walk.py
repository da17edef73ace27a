"""The files of a bag, listed without following or opening anything: a bag is treated as hostile."""

from __future__ import annotations

import os
import stat
import unicodedata
from dataclasses import dataclass, field
from pathlib import Path

from fogreduce.errors import Fault

LARGEST_FILE_BYTES = 1 << 40
MOST_FILES = 1_000_000
DEEPEST = 16


@dataclass
class Listing:
    """What lies in a bag.

    Attributes
    ----------
    sizes : dict
        Bytes of each plain file by its path in the bag, parted by /.
    faults : list of Fault
        What is not even opened: links, devices, names that are not plain, absurd sizes.
    empty : list of str
        Folders with nothing in them, which no manifest can list.
    """

    sizes: dict[str, int] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)
    empty: list[str] = field(default_factory=list)
    _spellings: dict[str, str] = field(default_factory=dict)

    def find(self, name: str) -> str | None:
        """The path of a file as the disk spells it; a Mac's disk changes names' Unicode form."""
        return name if name in self.sizes else self._spellings.get(unicodedata.normalize("NFC", name))

    def add(self, path: str, size: int) -> str:
        """Take in a file; the path that it cannot be told from, where there is one."""
        self.sizes[path] = size
        return self._spellings.setdefault(unicodedata.normalize("NFC", path), path)


def walk(bag: Path) -> Listing:
    """List a bag."""
    listing = Listing()
    todo = [""]
    while todo:
        folder = todo.pop()
        entries = sorted(os.scandir(bag / folder), key=lambda entry: entry.name)
        if not entries and folder:
            listing.empty.append(folder)
        for entry in entries:
            path = f"{folder}/{entry.name}" if folder else entry.name
            if problem := _problem(entry, path):
                shown = (bag / path).as_posix().encode("utf-8", "backslashreplace").decode()
                listing.faults.append(Fault(shown.encode("unicode_escape").decode(), "", *problem))
            elif entry.is_dir(follow_symlinks=False):
                todo.append(path)
            else:
                other = listing.add(path, entry.stat(follow_symlinks=False).st_size)
                if other != path:
                    found = "the name of another file, in another Unicode form"
                    listing.faults.append(Fault(str(bag / path), "", found, "names that differ"))
        if len(listing.sizes) + len(todo) > MOST_FILES:
            listing.faults.append(Fault(str(bag), "", "files without end", f"at most {MOST_FILES}"))
            break
    return listing


def _problem(entry: os.DirEntry[str], path: str) -> tuple[str, str] | None:
    """(found, expected) where an entry is none that a bag may hold."""
    try:
        entry.name.encode()
    except UnicodeEncodeError:
        return "a name that is not UTF-8", "a name in UTF-8"
    if not entry.name.isprintable() or "\\" in entry.name:
        return "a name with control characters or backslashes", "a plain name"
    status = entry.stat(follow_symlinks=False)
    if stat.S_ISLNK(status.st_mode):
        return "a link", "a plain file"
    if stat.S_ISDIR(status.st_mode):
        return ("folders nested without end", "a few") if path.count("/") >= DEEPEST else None
    if not stat.S_ISREG(status.st_mode):
        return "neither a file nor a folder", "a plain file"
    if status.st_size > LARGEST_FILE_BYTES:
        return f"{status.st_size} bytes", f"at most {LARGEST_FILE_BYTES}"
    return None
