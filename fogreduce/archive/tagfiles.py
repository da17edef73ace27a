"""The tag files of a bag, read strictly: what this module lets pass, every BagIt tool reads alike."""

from __future__ import annotations

import re

from fogreduce.archive.bag import DECLARATION, encoded
from fogreduce.errors import Fault

_LINE = re.compile(r"([0-9a-f]{64})  (\S.*)")
_HEX = re.compile(r"[0-9a-fA-F]{64}\b.*")
_ESCAPE = re.compile(r"%(25|0A|0D)")

Hashes = dict[str, str]


def read_manifest_lines(raw: bytes, file: str, prefix: str) -> tuple[Hashes, list[Fault]]:
    """The hashes that a manifest lists, by path in the bag.

    Parameters
    ----------
    raw : bytes
        The manifest.
    file : str
        Its path, for faults.
    prefix : str
        What each path begins with (``data/``), or nothing.
    """
    hashes: Hashes = {}
    faults: list[Fault] = []
    expected = "64 hexadecimal digits in lower case, two spaces, a path"
    try:
        text = raw.decode()
    except UnicodeDecodeError as error:
        place = f"line {raw.count(bytes([10]), 0, error.start) + 1}"
        return {}, [Fault(file, place, "bytes that are not UTF-8", expected)]
    lines = text.split("\n")
    if lines.pop() != "":
        faults.append(Fault(file, f"line {len(lines) + 1}", "no end of line", expected))
    for number, line in enumerate(lines, 1):
        where = f"line {number}"
        if not (match := _LINE.fullmatch(line)):
            found = "digits in upper case, or no two spaces" if _HEX.fullmatch(line) else "something else"
            faults.append(Fault(file, where, found, expected))
            continue
        path = _ESCAPE.sub(lambda escape: chr(int(escape[1], 16)), match[2])
        if problem := _problem_of_path(path, match[2], prefix):
            faults.append(Fault(file, where, problem, f"a plain path below {prefix or 'the bag'}"))
        elif path in hashes:
            faults.append(Fault(file, where, f"{path} a second time", "each file once"))
        else:
            hashes[path] = match[1]
    return hashes, faults


def _problem_of_path(path: str, written: str, prefix: str) -> str:
    shown = repr(path)[1:-1]
    if not path.isprintable() or "\\" in path:
        return f"{shown}, a path with control characters or backslashes"
    if path.startswith(("/", "~")) or any(part in ("", ".", "..") for part in path.split("/")):
        return f"{shown}, a path that leaves the bag"
    if not path.startswith(prefix):
        return f"{shown}, not below {prefix}"
    if encoded(path) != written:
        return f"{shown}, a path that is not escaped as RFC 8493 has it"
    return ""


def declaration_fault(raw: bytes, file: str) -> list[Fault]:
    """Faults of bagit.txt."""
    if raw == DECLARATION.encode():
        return []
    return [Fault(file, "", "something else", " / ".join(DECLARATION.splitlines()))]


def read_info(raw: bytes, file: str) -> tuple[dict[str, str], list[Fault]]:
    """The fields of bag-info.txt: a line each, each once."""
    fields: dict[str, str] = {}
    expected = "lines of a name, a colon, a space and a value"
    try:
        lines = raw.decode().split("\n")
    except UnicodeDecodeError:
        return {}, [Fault(file, "", "bytes that are not UTF-8", expected)]
    if lines.pop() != "":
        return {}, [Fault(file, "", "no end of line", expected)]
    for number, line in enumerate(lines, 1):
        key, parted, value = line.partition(": ")
        if not parted or not re.fullmatch(r"[A-Za-z-]+", key) or not value.isprintable() or key in fields:
            return fields, [Fault(file, f"line {number}", "something else", expected)]
        fields[key] = value
    return fields, []
