"""campaign.yaml: what the runs of a campaign share (optional file, every key optional)."""

from __future__ import annotations

from typing import Literal, Self

from pydantic import Field, model_validator

from fogreduce.metadata.base import FileName, Model
from fogreduce.metadata.certificate import Certificate
from fogreduce.metadata.faults import unexpected
from fogreduce.metadata.patterns import CALIBRATION_PATTERN


class Simulate(Model):
    """Captures made from the runs' metadata by the forward physics."""

    seed: int = Field(default=0, ge=0, description="seed of the noise")


class CapturesFrom(Model):
    """How the captures of a campaign are made where they are not kept: one of two ways."""

    simulate: Simulate | None = Field(default=None, description="by the forward physics from each run.yaml")
    curves: FileName | None = Field(
        default=None, description="from the mean curves in this file of the campaign's folder"
    )

    @model_validator(mode="after")
    def _one_way(self) -> Self:
        given = [key for key in ("simulate", "curves") if getattr(self, key) is not None]
        if len(given) != 1:
            raise unexpected("exactly one of simulate, curves", found=" and ".join(given) or "neither")
        return self


class Campaign(Model):
    """A campaign (campaign.yaml)."""

    schema_id: Literal["fogreduce/campaign/1"] = Field(
        default="fogreduce/campaign/1", alias="schema", description="format of this file"
    )
    title: str | None = Field(default=None, description="what the campaign is about")
    operator: str | None = Field(default=None, description="who ran it")
    notes: str | None = Field(default=None, description="free text")
    calibration: str | None = Field(
        default=None,
        pattern=CALIBRATION_PATTERN,
        description="calibration record, <unit>@<version>, of the runs whose run.yaml names none",
    )
    captures_from: CapturesFrom | None = Field(
        default=None, description="how captures are made where they are not kept"
    )
    label: str | None = Field(
        default=None,
        min_length=1,
        max_length=200,
        description="text that every page and figure of the campaign carries",
    )
    diagnose: bool = Field(
        default=False, description="whether the workflow diagnoses the gap between its runs and the simulator"
    )
    report: bool = Field(default=False, description="whether the workflow writes the unit's test report")
    certificate: Certificate | None = Field(
        default=None, description="what the certificate of a derived calibration record says beside numbers"
    )
    derive: bool = Field(
        default=False,
        description="whether the workflow derives a candidate calibration record, which no result uses until "
        "a person names it",
    )
