"""archive.json: which runs an archive holds, where, and of which code."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Field, field_validator

from fogreduce.metadata.base import Model, Name
from fogreduce.metadata.faults import unexpected
from fogreduce.metadata.patterns import PLACE_PATTERN
from fogreduce.provenance.records import VersionId

Folder = Annotated[str, Field(pattern=PLACE_PATTERN)]


class RunEntry(Model):
    """A run in an archive."""

    run_id: Name
    version_id: VersionId
    inputs: Folder = Field(description="folder of its run.yaml and capture")
    results: Folder = Field(description="folder of its results")


class LeftOut(Model):
    """A run of the campaign whose results are not in its archive."""

    run_id: Name
    reason: str


class ArchiveRecord(Model):
    """archive.json."""

    schema_id: Literal["fogreduce/archive/1"] = Field(alias="schema")
    campaign: Name
    software: dict[str, Any] = Field(description="version of fogreduce and hash of its code")
    code_parts: list[str] = Field(min_length=1, description="sources of the package that the hash is over")
    runs: list[RunEntry] = Field(min_length=1)
    left_out: list[LeftOut] = Field(default=[], description="runs that failed or were taken out since")

    @field_validator("software")
    @classmethod
    def _names_its_code(cls, software: dict[str, Any]) -> dict[str, Any]:
        if not isinstance(software.get("code_sha256"), str):
            raise unexpected("fogreduce and code_sha256")
        return software
