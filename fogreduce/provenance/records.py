"""The records of a run's results as they are read back: manifest.json and outputs.json, validated."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, ConfigDict, Field

from fogreduce.constants import MANIFEST_SCHEMA
from fogreduce.metadata.base import Model, Name
from fogreduce.metadata.faults import unexpected
from fogreduce.metadata.patterns import CALIBRATION_PATTERN, SHA256_PATTERN, VERSION_PATTERN
from fogreduce.provenance.manifest_file import (
    MANIFEST,
    OUTPUTS,
    check_version_id,
    read_outputs_data,
    read_record,
)

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

    def is_same(self, other: Outputs) -> bool:
        """Whether both are of the same results, to the byte."""
        return self.version_id == other.version_id and self.files == other.files


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


def manifest_of(data: dict[str, Any], file: object) -> Manifest:
    """The manifest, its version id held against its content."""
    manifest = Manifest.from_data(data, str(file))
    check_version_id(data, file)
    return manifest


def read_manifest(folder: Path) -> Manifest:
    """The manifest of a run's results."""
    path = folder / MANIFEST
    return manifest_of(read_record(path, f"the run's manifest ({MANIFEST_SCHEMA})"), path)


def read_outputs(folder: Path) -> Outputs:
    """The checksums of a run's results."""
    return Outputs.from_data(read_outputs_data(folder), folder / OUTPUTS)
