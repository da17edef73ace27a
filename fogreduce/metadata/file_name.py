"""Names of files that every tool on the way reads alike: file systems, YAML, CSV and BagIt's manifests."""

from __future__ import annotations

#: Longest name that file systems take [bytes].
LONGEST_BYTES = 255


def problem_of_file_name(name: str) -> str:
    """Why a plain file's name will not do, in plain words; empty where it will.

    Spaces and letters of any script will do, in any of Unicode's normal forms. A name with ``%`` will not:
    in a manifest RFC 8493 (2.1.3) writes ``%25`` for it and bagit.py does not, so that no bag with such a
    name is valid to both. White space at the end of a name is lost in a manifest.
    """
    if name in ("", ".", "..") or "/" in name or "\\" in name:
        return "a plain file name in the same folder (no path)"
    if not name.isprintable():
        return "a plain file name without control characters, no-break spaces or bytes that are not UTF-8"
    if "{" in name or "}" in name:
        return "a plain file name without { and }, which the workflow takes for wildcards"
    if "%" in name:
        return "a plain file name without %, which BagIt tools read in different ways"
    if name != name.rstrip():
        return "a plain file name without white space at its end"
    if len(name.encode()) > LONGEST_BYTES:
        return f"a plain file name of at most {LONGEST_BYTES} bytes"
    return ""
