"""An effects file (schema fogreduce/effects/1): what ``--effects`` reads and a diagnosis writes.

Only its shape is known here; which effects and parameters there are is for the table of effects to say.
"""

from __future__ import annotations

import math
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, Strict

from fogreduce.metadata.base import Model
from fogreduce.metadata.faults import unexpected
from fogreduce.metadata.patterns import EFFECT_PATTERN
from fogreduce.metadata.words import kind_of

Texts = Annotated[tuple[Annotated[str, Field(min_length=1)], ...], Strict(False)]


def _parameter(value: object) -> object:
    """One fault in plain words, where a union of types would name each of them."""
    numbers = value if isinstance(value, list | tuple) else [value] if not isinstance(value, str) else []
    for number in numbers:
        if not isinstance(number, int | float):
            raise unexpected("a number, true or false, text, or a list of numbers", found=kind_of(number))
        if not math.isfinite(number):
            raise unexpected("a finite number", found=kind_of(number))
    return value


Parameter = Annotated[
    float | bool | str | Annotated[tuple[float, ...], Strict(False)], BeforeValidator(_parameter)
]


class EffectEntry(Model):
    """One effect, where it acts and how strongly."""

    effect: str = Field(pattern=EFFECT_PATTERN, description="the effect's name")
    channels: Texts = Field(
        default=("*",), min_length=1, description="the channels it acts on, such as gyro2 or table"
    )
    runs: Texts = Field(default=("*",), min_length=1, description="patterns of the run ids in which it acts")
    parameters: dict[str, Parameter] = Field(default={}, description="its parameters, by name")


class EffectsFile(Model):
    """A list of effects."""

    schema_id: Literal["fogreduce/effects/1"] = Field(alias="schema", description="format of this file")
    effects: Annotated[tuple[EffectEntry, ...], Strict(False)] = Field(description="the effects, in order")
