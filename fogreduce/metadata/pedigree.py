"""Where a derived calibration record comes from, and the covariance of what it states."""

from __future__ import annotations

from typing import Annotated, Self

from pydantic import Field, Strict, model_validator

from fogreduce.metadata.base import Model, Name
from fogreduce.metadata.faults import unexpected
from fogreduce.metadata.patterns import SHA256_PATTERN

Digest = Annotated[str, Field(pattern=SHA256_PATTERN)]


class SourceRun(Model):
    """A run that a record is derived from: its name and the SHA-256 of run.yaml and capture."""

    run_id: Name = Field(description="the run")
    run_yaml_sha256: Digest = Field(description="SHA-256 of its run.yaml")
    capture_sha256: Digest = Field(description="SHA-256 of its capture")


class Pedigree(Model):
    """What a record is derived from, and by which code."""

    campaign: Name = Field(description="the campaign")
    runs: Annotated[tuple[SourceRun, ...], Strict(False)] = Field(min_length=1, description="its runs")
    started_from: str = Field(description="record that served as starting point, <unit>@<version>")
    fogreduce: str = Field(description="version of the software")
    code_sha256: Digest = Field(description="SHA-256 of its code")
    chi2: float = Field(ge=0, description="chi-square of the solution")
    degrees_of_freedom: float = Field(description="its degrees of freedom")


class Covariance(Model):
    """Covariance of bias, scale factor and axis of all gyros."""

    parameters: Annotated[tuple[str, ...], Strict(False)] = Field(
        min_length=1,
        description="names with units: gyro1.bias_deg_h, gyro1.scale_factor_rel, gyro1.axis1_rad",
    )
    axis_directions: Annotated[tuple[Annotated[tuple[float, ...], Strict(False)], ...], Strict(False)] = (
        Field(
            description="unit vectors, two a gyro, along which axis1 and axis2 are counted, in the unit frame"
        )
    )
    matrix: Annotated[tuple[Annotated[tuple[float, ...], Strict(False)], ...], Strict(False)] = Field(
        description="rows of the covariance matrix"
    )

    @model_validator(mode="after")
    def _square(self) -> Self:
        k = len(self.parameters)
        if len(self.matrix) != k or any(len(row) != k for row in self.matrix):
            raise unexpected(f"a matrix of {k} x {k}, as many as parameters", found="another shape")
        return self
