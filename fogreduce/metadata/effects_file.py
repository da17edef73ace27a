"""An effects file (schema fogreduce/effects/1): what ``--effects`` reads and a diagnosis writes.

Only its shape is known here; which effects and parameters there are is for the table of effects to say.
"""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field, Strict

from fogreduce.metadata.base import Model

Texts = Annotated[tuple[Annotated[str, Field(min_length=1)], ...], Strict(False)]
Parameter = float | bool | str | Annotated[tuple[float, ...], Strict(False)]


class EffectEntry(Model):
    """One effect, where it acts and how strongly."""

    effect: str = Field(pattern=r"^[a-z][a-z0-9_]{0,63}$", description="the effect's name")
    channels: Texts = Field(
        default=("*",), min_length=1, description="the channels it acts on, such as gyro2 or table"
    )
    runs: Texts = Field(default=("*",), min_length=1, description="patterns of the run ids in which it acts")
    parameters: dict[str, Parameter] = Field(default={}, description="its parameters, by name")


class EffectsFile(Model):
    """A list of effects."""

    schema_id: Literal["fogreduce/effects/1"] = Field(alias="schema", description="format of this file")
    effects: Annotated[tuple[EffectEntry, ...], Strict(False)] = Field(description="the effects, in order")
