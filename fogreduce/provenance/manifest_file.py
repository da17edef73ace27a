"""A run's records as plain data: read; manifest.json with its version id checked against its content.

Quick to import, for the nodes of the workflow; `fogreduce.provenance.records` says what each key holds.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fogreduce.constants import MANIFEST_SCHEMA
from fogreduce.errors import BadInput
from fogreduce.provenance.digest import VERSION_ID_DIGITS, data_digest

#: What a run is reduced from, and what its results were when they were finished.
MANIFEST, OUTPUTS = "manifest.json", "outputs.json"

#: A record is small; what is larger is not one.
LARGEST_RECORD_BYTES = 64 << 20


def parse_json(raw: bytes, file: object, expected: str = "a JSON object") -> dict[str, Any]:
    """A JSON object out of a file's bytes; BadInput otherwise."""
    if len(raw) > LARGEST_RECORD_BYTES:
        raise BadInput.at(file, "", found=f"{len(raw)} bytes", expected=f"at most {LARGEST_RECORD_BYTES}")
    try:
        data = json.loads(raw, parse_constant=_not_a_number)
    except RecursionError:
        raise BadInput.at(file, "", found="nesting without end", expected=expected) from None
    except ValueError as error:
        raise BadInput.at(file, "", found=str(error), expected=expected) from None
    if not isinstance(data, dict):
        raise BadInput.at(file, "", found=type(data).__name__, expected=expected)
    return data


def _not_a_number(text: str) -> None:
    raise ValueError(f"{text}, which JSON does not have")


def read_record(path: Path, expected: str) -> dict[str, Any]:
    """A JSON object from a small file; BadInput where there is none."""
    try:
        if (size := path.stat().st_size) > LARGEST_RECORD_BYTES:
            raise BadInput.at(path, "", found=f"{size} bytes", expected=f"at most {LARGEST_RECORD_BYTES}")
        return parse_json(path.read_bytes(), path, expected)
    except FileNotFoundError:
        raise BadInput.at(path, "", found="no such file", expected=expected) from None
    except OSError as error:
        raise BadInput.at(path, "", found=error.strerror, expected=expected) from None


def check_version_id(manifest: Mapping[str, Any], file: object) -> None:
    """BadInput where a manifest's version id is not the one derived from what it says."""
    body = {key: value for key, value in manifest.items() if key != "version_id"}
    derived = data_digest(body)[:VERSION_ID_DIGITS]
    if (stated := manifest.get("version_id")) != derived:
        expected = f"{derived}, derived from what the manifest says"
        raise BadInput.at(file, "version_id", found=stated, expected=expected)


def read_outputs_data(folder: Path) -> dict[str, Any]:
    """The checksums of a run's results."""
    return read_record(folder / OUTPUTS, "checksums, as `fogreduce checksums` writes them")


def read_manifest_data(folder: Path) -> dict[str, Any]:
    """The manifest of a run's results; BadInput where it is none, or was changed."""
    path = folder / MANIFEST
    manifest = read_record(path, "the run's manifest")
    if (schema := manifest.get("schema")) != MANIFEST_SCHEMA:
        raise BadInput.at(path, "schema", found=schema, expected=MANIFEST_SCHEMA)
    check_version_id(manifest, path)
    return manifest
