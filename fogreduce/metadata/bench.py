"""What a bench can do (schema fogreduce/bench/1): within it stays the run that a diagnosis proposes."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from fogreduce.metadata.base import Model

Positive = Annotated[float, Field(gt=0, le=1e6)]


class Table(Model):
    """The rate table."""

    largest_rate_deg_s: Positive | None = Field(
        default=None, description="no faster than this [deg/s]; without it, than the fastest run of today"
    )
    largest_acceleration_deg_s2: Positive | None = Field(
        default=None, description="spins up no faster than this [deg/s^2]; without it, at once"
    )


class Chamber(Model):
    """The climatic chamber about the unit."""

    highest_degC: float = Field(default=70.0, ge=-273.15, le=1000, description="no warmer than this [degC]")
    largest_slope_degC_per_min: Positive = Field(
        default=2.0, description="soaks no faster than this [degC/min]"
    )


class Bench(Model):
    """Limits of a bench."""

    schema_id: Literal["fogreduce/bench/1"] = Field(
        default="fogreduce/bench/1", alias="schema", description="format of this file"
    )
    table: Table = Field(default=Table(), description="the rate table")
    chamber: Chamber | None = Field(
        default=Chamber(), description="the climatic chamber; null where there is none"
    )
