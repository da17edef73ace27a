"""The records of a run's results as they are read back: manifest.json and outputs.json, validated."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, ConfigDict, Field

from fogreduce.constants import MANIFEST_SCHEMA
from fogreduce.errors import BadInput
from fogreduce.metadata.base import Model, Name
from fogreduce.metadata.faults import unexpected
from fogreduce.metadata.patterns import CALIBRATION_PATTERN, SHA256_PATTERN, VERSION_PATTERN
from fogreduce.provenance.digest import VERSION_ID_DIGITS, data_digest

MANIFEST = "manifest.json"
OUTPUTS = "outputs.json"
OUTPUTS_SCHEMA = "fogreduce/outputs/1"

#: A record is small; what is larger is not one.
LARGEST_RECORD_BYTES = 64 << 20

Sha256 = Annotated[str, Field(pattern=SHA256_PATTERN)]
VersionId = Annotated[str, Field(pattern=VERSION_PATTERN)]


def _inside(name: str) -> str:
    if any(part in ("", ".", "..") for part in name.split("/")) or not name.isprintable():
        raise unexpected("a path in the same folder")
    return name


class HashedFile(Model):
    """A file by name, with its size and hash."""

    name: Annotated[str, AfterValidator(_inside)] = Field(
        max_length=1024, description="path in its folder, parted by /"
    )
    bytes: int = Field(ge=0, description="size")
    sha256: Sha256 = Field(description="SHA-256 of its bytes, lower case")


class Outputs(Model):
    """outputs.json: what a run's results were when they were finished."""

    schema_id: Literal["fogreduce/outputs/1"] = Field(alias="schema", description="format of this file")
    version_id: VersionId = Field(description="the manifest's")
    machine: dict[str, Any] = Field(description="libraries, CPU features; see fogreduce.provenance.machine")
    files: Annotated[list[HashedFile], Field(strict=False)] = Field(description="every file of the results")


class _Open(Model):
    """A part of the manifest: what a later version adds is let pass."""

    model_config = ConfigDict(extra="ignore")


class CalibrationUsed(_Open):
    """The calibration record that a run was reduced with."""

    id: str = Field(pattern=CALIBRATION_PATTERN)
    sha256: Sha256


class AssumedValue(_Open):
    """A value that nobody stated; see `fogreduce.metadata.assumed`."""

    file: str
    key: str
    value: float
    said: str


class Manifest(_Open):
    """manifest.json, as far as the archive relies on it."""

    schema_id: Literal["fogreduce/manifest/1"] = Field(alias="schema")
    version_id: VersionId
    inputs: list[HashedFile] = Field(min_length=1)
    software: dict[str, Any]
    campaign: Name
    run_id: Name
    calibration: CalibrationUsed
    parameters: dict[str, Any]
    run: dict[str, Any]
    calibration_record: dict[str, Any]
    assumed: Annotated[list[AssumedValue], Field(strict=False)] = Field(default_factory=list)


def parse_json(raw: bytes, file: object) -> dict[str, Any]:
    """A JSON object out of a file's bytes; BadInput otherwise."""
    expected = "a JSON object"
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
        return parse_json(path.read_bytes(), path)
    except FileNotFoundError:
        raise BadInput.at(path, "", found="no such file", expected=expected) from None
    except OSError as error:
        raise BadInput.at(path, "", found=error.strerror, expected=expected) from None


def manifest_of(data: dict[str, Any], file: object) -> Manifest:
    """The manifest, its version id held against its content."""
    manifest = Manifest.from_data(data, str(file))
    body = {key: value for key, value in data.items() if key != "version_id"}
    derived = data_digest(body)[:VERSION_ID_DIGITS]
    if manifest.version_id != derived:
        raise BadInput.at(
            file, "version_id", found=manifest.version_id, expected=f"{derived}, derived from what it says"
        )
    return manifest


def read_manifest(folder: Path) -> Manifest:
    """The manifest of a run's results."""
    path = folder / MANIFEST
    return manifest_of(read_record(path, f"the run's manifest ({MANIFEST_SCHEMA})"), path)


def read_outputs(folder: Path) -> Outputs:
    """The checksums of a run's results."""
    path = folder / OUTPUTS
    return Outputs.from_data(read_record(path, "checksums, as `fogreduce checksums` writes them"), path)
