"""What names and ids look like: as a pattern, for schemas, and in words, for people."""

from __future__ import annotations

#: Names of campaigns, runs, units and calibration versions.
NAME_PATTERN = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,63}$"
NAME_IN_WORDS = "a name of 1 to 64 letters, digits, '.', '_', '-' that begins with a letter or digit"
#: Id of a calibration record, ``<unit>@<version>``.
CALIBRATION_PATTERN = r"^[A-Za-z0-9][A-Za-z0-9._-]{0,63}@[A-Za-z0-9][A-Za-z0-9._-]{0,63}$"
#: Name of a format of captures.
FORMAT_PATTERN = r"^[a-z0-9][a-z0-9.-]{0,31}$"
EFFECT_PATTERN = r"^[a-z][a-z0-9_]{0,63}$"
SHA256_PATTERN = r"^[0-9a-f]{64}$"
#: Id of a version of a run's results.
VERSION_PATTERN = r"^[0-9a-f]{16}$"
#: Folder in an archive.
PLACE_PATTERN = r"^(campaigns|captures|results)(/[A-Za-z0-9][A-Za-z0-9._-]{0,63}){2,3}$"

IN_WORDS = {
    NAME_PATTERN: NAME_IN_WORDS,
    CALIBRATION_PATTERN: "a unit and a version of its record, as in TETRA-01@2012a",
    FORMAT_PATTERN: "a format's name, of 1 to 32 small letters, digits, '.', '-'",
    EFFECT_PATTERN: "an effect's name, of 1 to 64 small letters, digits, '_'",
    SHA256_PATTERN: "a SHA-256: 64 digits 0 to 9, a to f",
    VERSION_PATTERN: "a version's id: 16 digits 0 to 9, a to f",
    PLACE_PATTERN: "a folder below campaigns, captures or results",
}
