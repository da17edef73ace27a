"""The workflow's configuration: what ``workflow/config.yaml`` and ``snakemake --config`` may set.

Snakemake hands nested values of ``--config`` on as text (``figures={enabled: false}``), so these models,
unlike those of a laboratory's files, read a number or a truth value from its text too.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import ConfigDict, Field, model_validator

from fogreduce.metadata.base import Model, Name
from fogreduce.metadata.faults import unexpected


class ConfigModel(Model):
    """Reads numbers and truth values from text too; still refuses unknown keys, NaN and infinity."""

    model_config = ConfigDict(strict=False)


class FiguresConfig(ConfigModel):
    """Figures of each run."""

    enabled: bool = Field(default=True, description="whether figures are drawn")
    formats: tuple[Literal["png", "svg"], ...] = Field(
        default=("png", "svg"), min_length=1, description="png, svg or both"
    )


class PagesConfig(ConfigModel):
    """Pages of runs and campaigns."""

    enabled: bool = Field(default=True, description="whether pages are written")


class AllanConfig(ConfigModel):
    """Allan deviation of each run, of every sample."""

    enabled: bool = Field(
        default=False, description="whether each run gets its Allan deviation, noise coefficients and density"
    )


class StorageConfig(ConfigModel):
    """How datasets are laid out in their HDF5 files."""

    chunk_records: int = Field(default=0, ge=0, description="records in a chunk; 0 = contiguous, not chunked")
    compression: Literal["none", "gzip"] = Field(default="none", description="none or gzip (needs chunks)")
    compression_level: int = Field(default=1, ge=0, le=9, description="gzip's level, 0 to 9")

    @model_validator(mode="after")
    def _chunked_if_compressed(self) -> Self:
        if self.compression != "none" and self.chunk_records == 0:
            raise unexpected(
                "a number of records, since compression needs chunks", key="chunk_records", found="0"
            )
        return self


class OutliersConfig(ConfigModel):
    """The search for spurious counts."""

    threshold_sigma: float = Field(
        default=8.0, gt=0, description="how many robust standard deviations make a count spurious"
    )


class UnstableConfig(ConfigModel):
    """The search for intervals in which a gyro is unstable."""

    threshold: float = Field(
        default=1.25, gt=1, description="a gyro's noise relative to its median, above which it is unstable"
    )
    min_duration_s: float = Field(default=10.0, gt=0, description="shortest interval that counts [s]")


class ReductionConfig(ConfigModel):
    """Parameters of the reduction; every one of them is part of a result's version."""

    block_records: int = Field(default=65536, ge=256, le=2**26, description="records worked on at a time")
    storage: StorageConfig = Field(default=StorageConfig(), description="layout of the datasets")
    outliers: OutliersConfig = Field(default=OutliersConfig(), description="the search for spurious counts")
    unstable: UnstableConfig = Field(
        default=UnstableConfig(), description="the search for unstable intervals"
    )
    edge_guard_s: float = Field(
        default=0.5,
        ge=0,
        description="left out of fits on both sides of an edge between two commanded rates [s]",
    )
    alpha_source: Literal["command", "encoder"] = Field(
        default="command",
        description="where the table's angle comes from: the commanded profile or the encoder's log",
    )
    complete_records: bool = Field(
        default=True,
        description="whether x, y, z take only records in which every gyro answered (the paper's way); "
        "false: those of three gyros or more too",
    )


Folder = Annotated[str, Field(min_length=1)]


class WorkflowConfig(ConfigModel):
    """Configuration of the workflow."""

    campaigns_dir: Folder = Field(default="campaigns", description="folder of the campaigns")
    calibrations_dir: Folder = Field(default="calibrations", description="folder of the calibration records")
    results_dir: Folder = Field(default="results", description="folder that results are written to")
    campaigns: tuple[Name, ...] = Field(
        default=(), description="names of the campaigns to reduce; empty = all"
    )
    figures: FiguresConfig = Field(default=FiguresConfig(), description="figures of each run")
    pages: PagesConfig = Field(default=PagesConfig(), description="pages of each run and campaign")
    allan: AllanConfig = Field(default=AllanConfig(), description="Allan deviation of each run")
    reduction: ReductionConfig = Field(default=ReductionConfig(), description="parameters of the reduction")
    warm_server: bool = Field(
        default=True, description="whether one process that has imported everything serves the jobs"
    )
    withheld: dict[str, Any] = Field(
        default={}, description="settings of the withheld-runs rules, handed on as they are"
    )

    @model_validator(mode="after")
    def _results_apart(self) -> Self:
        """Results among the raw data would be taken for them, and archived with them."""
        for key in ("campaigns_dir", "calibrations_dir"):
            raw = Path(getattr(self, key)).resolve()
            if Path(self.results_dir).resolve().is_relative_to(raw):
                raise unexpected(
                    f"a folder of its own, apart from {key}", key="results_dir", found=self.results_dir
                )
        return self
