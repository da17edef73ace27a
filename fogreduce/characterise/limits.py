"""Pass or fail against limits, guard-banded by the uncertainty (ISO 14253-1, JCGM 106).

The acceptance interval is the tolerance interval less a guard band of `guard` times the expanded uncertainty
on each side; a value beyond the tolerance by as much fails. In between neither is proven.
"""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import Field, model_validator
from scipy.special import ndtr

from fogreduce.characterise.definitions import DEFINITIONS
from fogreduce.characterise.quantity import K95, Quantity
from fogreduce.metadata.base import Model
from fogreduce.metadata.faults import unexpected

PASS, FAIL, OPEN = "pass", "fail", "not proven"


class Limit(Model):
    """Tolerance of a quantity, in its unit in the report; `absolute` holds its size against the limits."""

    min: float | None = Field(default=None, description="least value")
    max: float | None = Field(default=None, description="largest value")
    absolute: bool = Field(default=False, description="whether the value's size counts, not its sign")

    @model_validator(mode="after")
    def _one_at_least(self) -> Self:
        if self.min is None and self.max is None:
            raise unexpected("min, max or both", found="neither")
        if self.min is not None and self.max is not None and self.min >= self.max:
            raise unexpected("a min below max", found=f"{self.min} and {self.max}")
        return self


class Limits(Model):
    """A limits file (schema fogreduce/limits/1)."""

    schema_id: Literal["fogreduce/limits/1"] = Field(alias="schema", description="format of this file")
    guard: Annotated[float, Field(ge=0, le=10)] = Field(
        default=1.0, description="guard band over the expanded uncertainty (95 %)"
    )
    limits: dict[str, Limit] = Field(description="by quantity")

    @model_validator(mode="after")
    def _known(self) -> Self:
        for name in self.limits:
            if name not in DEFINITIONS:
                raise unexpected("one of " + ", ".join(DEFINITIONS), key="limits", found=name)
        return self


def read_limits(path: Path | None) -> Limits | None:
    """The limits file, where there is one."""
    return None if path is None else Limits.from_yaml(path)


def verdict(quantity: Quantity, limits: Limits) -> tuple[str, float | None] | None:
    """Verdict and probability of conformance; None where no limit is set, or nothing is determined.

    A lower bound passes where it lies at a least value or above, and has no probability.
    """
    limit = limits.limits.get(quantity.name)
    if limit is None or quantity.value is None or quantity.low is None:
        return None
    if quantity.high is None:
        return _of_bound(quantity.low, limit), None
    value, low, high = quantity.value, quantity.low, quantity.high
    if limit.absolute and value < 0:
        value, low, high = -value, -high, -low
    below, above = limits.guard * (value - low), limits.guard * (high - value)
    least = float("-inf") if limit.min is None else limit.min
    most = float("inf") if limit.max is None else limit.max
    under, over = max((value - low) / K95, 1e-300), max((high - value) / K95, 1e-300)
    probability = float(ndtr((most - value) / over) - ndtr((least - value) / under))
    if value - below >= least and value + above <= most:
        return PASS, probability
    if value + above < least or value - below > most:
        return FAIL, probability
    return OPEN, probability


def _of_bound(bound: float, limit: Limit) -> str:
    """The verdict on a quantity of which a lower bound is known."""
    if limit.max is not None:
        return FAIL if bound > limit.max else OPEN
    return PASS if limit.min is not None and bound >= limit.min else OPEN
