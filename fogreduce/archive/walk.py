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
        What no bag of ours holds: links, devices, names that are not plain, absurd sizes, empty folders.
    """

    sizes: dict[str, int] = field(default_factory=dict)
    faults: list[Fault] = field(default_factory=list)


def walk(bag: Path) -> Listing:
    """List a bag."""
    listing = Listing()
    todo = [""]
    while todo:
        folder = todo.pop()
        entries = sorted(os.scandir(bag / folder), key=lambda entry: entry.name)
        if not entries and folder:
            listing.faults.append(Fault(f"{bag / folder}", "", "an empty folder", "files in every folder"))
        for entry in entries:
            path = f"{folder}/{entry.name}" if folder else entry.name
            if problem := _problem(entry, path):
                shown = (bag / path).as_posix().encode("utf-8", "backslashreplace").decode()
                listing.faults.append(Fault(shown.encode("unicode_escape").decode(), "", *problem))
            elif entry.is_dir(follow_symlinks=False):
                todo.append(path)
            else:
                listing.sizes[path] = entry.stat(follow_symlinks=False).st_size
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
    if unicodedata.normalize("NFC", entry.name) != entry.name:
        return "a name that is not in Unicode's normal form C", "one that is"
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
