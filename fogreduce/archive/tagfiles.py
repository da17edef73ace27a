"""The tag files of a bag (RFC 8493, 2), as any BagIt tool may write them.

What RFC 8493 leaves to the writer (the case of digests, the end of lines, folding) and what tools are known
to add (a byte-order mark, ``*`` before a name as md5sum has it, comments) is read, and noted as unusual.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass, field

from fogreduce.archive.bag import DECLARATION, encoded
from fogreduce.errors import Fault

VERSIONS = ("0.93", "0.94", "0.95", "0.96", "0.97", "1.0")
#: Character encodings of tag files, by name in lower case (RFC 8493, 2.1.1 and 5.1).
ENCODINGS = {
    "utf-8": "utf-8-sig",
    "us-ascii": "ascii",
    "iso-8859-1": "latin-1",
    "utf-16": "utf-16",
    "utf-32": "utf-32",
}
#: Hexadecimal digits of a digest, by the algorithm's name in a manifest's file name.
DIGITS = {"md5": 32, "sha1": 40, "sha224": 56, "sha256": 64, "sha384": 96, "sha512": 128}

_LINE = re.compile(r"[ \t]*([0-9a-fA-F]+)[ \t]+(\*?)((?:\./)*)(\S.*)")
_ESCAPE = re.compile(r"%(25|0A|0D)", re.IGNORECASE)
_END_OF_LINE = re.compile(r"\r\n|\r|\n")

Find = Callable[[str], str | None]


@dataclass
class ManifestRead:
    """What a manifest says.

    Attributes
    ----------
    hashes : dict
        Digest in lower case by path in the bag: as the disk spells the name where it is there.
    recorded : dict
        The manifest's spelling of a path, where the disk has another.
    unusual : set of str
        What is valid but not as most tools write it.
    faults : list of Fault
        What is not valid.
    """

    hashes: dict[str, str] = field(default_factory=dict)
    recorded: dict[str, str] = field(default_factory=dict)
    unusual: set[str] = field(default_factory=set)
    faults: list[Fault] = field(default_factory=list)


def read_manifest_lines(
    raw: bytes, file: str, prefix: str, find: Find, algorithm: str = "sha256", encoding: str = "utf-8"
) -> ManifestRead:
    """The digests that a manifest lists.

    Parameters
    ----------
    raw : bytes
        The manifest.
    file : str
        Its path, for faults.
    prefix : str
        What each path begins with (``data/``), or nothing.
    find : callable
        The path on the disk of a name, whatever its Unicode form; None where there is no such file.
    algorithm : str
        A key of `DIGITS`.
    encoding : str
        A key of `ENCODINGS`.
    """
    manifest = ManifestRead()
    expected = f"{DIGITS[algorithm]} hexadecimal digits, white space, a path"
    text, problem = _decoded(raw, encoding, manifest.unusual)
    if problem:
        manifest.faults.append(Fault(file, problem, f"bytes that are not {encoding.upper()}", expected))
        return manifest
    malformed: list[int] = []
    cases: dict[str, int] = {}
    for number, line in enumerate(_lines(text, manifest.unusual), 1):
        if not line.strip() or line.startswith("#"):
            manifest.unusual.add("blank lines or comments")
            continue
        match = _LINE.fullmatch(line)
        if match is None or len(match[1]) != DIGITS[algorithm]:
            malformed.append(number)
            continue
        digest, star, here, written = match.groups()
        if star:
            manifest.unusual.add("* before names")
        if here:
            manifest.unusual.add("./ before names")
        for case in {_case(digest)} - {""}:
            cases.setdefault(case, number)
        _add(manifest, f"line {number}", file, prefix, written, digest.lower(), find)
    if malformed:
        more = f" (and {len(malformed) - 1} lines more)" if len(malformed) > 1 else ""
        manifest.faults.append(Fault(file, f"line {malformed[0]}", f"something else{more}", expected))
    if len(cases) > 1 or "both" in cases:  # no tool mixes them: a changed byte
        where = f"line {max(cases.values())}"
        manifest.faults.append(Fault(file, where, "digits in upper and in lower case", "one of the two"))
    elif "upper" in cases:
        manifest.unusual.add("digests in upper case")
    return manifest


def _add(
    manifest: ManifestRead, where: str, file: str, prefix: str, written: str, digest: str, find: Find
) -> None:
    """Take in one line."""
    decoded = _ESCAPE.sub(lambda escape: chr(int(escape[1], 16)), written)
    path, recorded = decoded, decoded
    for spelling in (decoded, decoded.rstrip(" \t"), written, written.rstrip(" \t")):
        if (found := find(spelling)) is not None:
            path, recorded = found, spelling
            break
    if problem := _problem_of_path(recorded, prefix):
        manifest.faults.append(Fault(file, where, problem, f"a plain path below {prefix or 'the bag'}"))
        return
    if path in manifest.hashes:
        manifest.faults.append(Fault(file, where, f"{path} a second time", "each file once"))
        return
    manifest.hashes[path] = digest
    if recorded != path:
        manifest.recorded[path] = recorded
        manifest.unusual.add("names in another Unicode form than on the disk")
    if encoded(recorded) != written:
        manifest.unusual.add("% or white space at the end of a line, not escaped")


def _case(digest: str) -> str:
    if digest.isdigit():
        return ""
    return "lower" if digest == digest.lower() else "upper" if digest == digest.upper() else "both"


def _problem_of_path(path: str, prefix: str) -> str:
    shown = repr(path)[1:-1]
    if not path.isprintable() or "\\" in path:
        return f"{shown}, a path with control characters or backslashes"
    if path.startswith(("/", "~")) or any(part in ("", ".", "..") for part in path.split("/")):
        return f"{shown}, a path that leaves the bag"
    if not path.startswith(prefix):
        return f"{shown}, not below {prefix}"
    return ""


def _decoded(raw: bytes, encoding: str, unusual: set[str]) -> tuple[str, str]:
    """The text of a tag file, and where it is none."""
    if raw.startswith(b"\xef\xbb\xbf") and encoding == "utf-8":
        unusual.add("a byte-order mark")
    try:
        return raw.decode(ENCODINGS[encoding]), ""
    except UnicodeDecodeError as error:
        return "", f"line {raw.count(bytes([10]), 0, error.start) + 1}"


def _lines(text: str, unusual: set[str]) -> list[str]:
    if "\r" in text:
        unusual.add("lines that end in CR")
    lines = _END_OF_LINE.split(text)
    if lines[-1] != "":
        unusual.add("no end of the last line")
        return lines
    return lines[:-1]


def read_declaration(raw: bytes, file: str) -> tuple[str, str, list[Fault]]:
    """Version and encoding (a key of `ENCODINGS`) of a bag, as bagit.txt has them; its faults."""
    lines = _END_OF_LINE.split(raw.decode("utf-8", "replace").rstrip())
    fields = [re.fullmatch(r"([A-Za-z-]+):[ \t]*(\S+)[ \t]*", line) for line in lines]
    stated = {match[1]: match[2] for match in fields if match}
    if len(lines) != 2 or list(stated) != ["BagIt-Version", "Tag-File-Character-Encoding"]:
        expected = " / ".join(DECLARATION.splitlines())
        return VERSIONS[-1], "utf-8", [Fault(file, "", "something else", expected)]
    version, encoding = stated["BagIt-Version"], stated["Tag-File-Character-Encoding"].lower()
    faults = []
    if version not in VERSIONS:
        faults.append(Fault(file, "BagIt-Version", version, f"one of {', '.join(VERSIONS)}"))
    if encoding not in ENCODINGS:
        faults.append(Fault(file, "Tag-File-Character-Encoding", encoding, f"one of {', '.join(ENCODINGS)}"))
        encoding = "utf-8"
    return version, encoding, faults


def read_info(raw: bytes, file: str, encoding: str) -> tuple[dict[str, str], set[str], list[Fault]]:
    """The fields of bag-info.txt by label in lower case (of a repeated one the first).

    Returns the fields, what is unusual, and the faults.
    """
    entries: list[list[str]] = []
    unusual: set[str] = set()
    expected = "lines of a label, a colon, a space and a value"
    text, problem = _decoded(raw, encoding, unusual)
    faults = [Fault(file, problem, f"bytes that are not {encoding.upper()}", expected)] if problem else []
    for number, line in enumerate(_lines(text, unusual), 1):
        label, parted, value = line.partition(":")
        if not line.replace("\t", " ").isprintable():
            faults.append(Fault(file, f"line {number}", "control characters", expected))
        elif not line.strip():
            unusual.add("blank lines or comments")
        elif line[0] in " \t" and entries:
            entries[-1][1] += f" {line.strip()}"
            unusual.add("folded lines")
        elif not parted or not label.strip():
            faults.append(Fault(file, f"line {number}", "something else", expected))
        else:
            entries.append([label.strip().lower(), value.strip()])
    fields: dict[str, str] = {}
    for label, value in entries:
        if label in fields:
            unusual.add("labels that are repeated")
        fields.setdefault(label, value)
    return fields, unusual, faults[:1]


def read_fetch(raw: bytes, encoding: str, find: Find) -> set[str]:
    """The paths that fetch.txt lists (a URL, a length, a path a line), as the disk spells what is there."""
    text, _ = _decoded(raw, encoding, set())
    named = [line.split(None, 2)[2] for line in _lines(text, set()) if len(line.split(None, 2)) == 3]
    paths = [_ESCAPE.sub(lambda escape: chr(int(escape[1], 16)), name.rstrip()) for name in named]
    return {find(path) or path for path in paths}
