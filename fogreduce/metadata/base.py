"""What all metadata models share: strictness, and the small types that they are built from."""

from __future__ import annotations

import os
from typing import Annotated, Self

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field, Strict, ValidationError

from fogreduce.errors import BadInput
from fogreduce.metadata.faults import faults_of, unexpected
from fogreduce.metadata.file_name import problem_of_file_name
from fogreduce.metadata.patterns import NAME_PATTERN
from fogreduce.metadata.yaml12 import load_yaml


class Model(BaseModel):
    """Frozen; refuses unknown keys, text for numbers, true for 1, NaN and infinity."""

    model_config = ConfigDict(
        frozen=True,
        strict=True,
        defer_build=True,  # a start-up pays only for the models that it validates with
        extra="forbid",
        allow_inf_nan=False,
        serialize_by_alias=True,
    )

    @classmethod
    def from_data(cls, data: object, file: str | os.PathLike[str]) -> Self:
        """Validate plain data read from `file`; BadInput with every fault."""
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            raise BadInput(*faults_of(error, file, cls)) from None

    @classmethod
    def from_yaml(cls, path: str | os.PathLike[str]) -> Self:
        """Read and validate a YAML file; BadInput with every fault."""
        return cls.from_data(load_yaml(path), path)


def _plain_file_name(text: str) -> str:
    if problem := problem_of_file_name(text):
        raise unexpected(problem)
    return text


def _sign(value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int | float) or value not in (1, -1):
        raise unexpected("1 or -1")
    return int(value)


Name = Annotated[str, Field(pattern=NAME_PATTERN)]
FileName = Annotated[
    str, AfterValidator(_plain_file_name), Field(json_schema_extra={"pattern": r"^[^/\\\x00-\x1f%{}]+$"})
]
Sign = Annotated[int, BeforeValidator(_sign), Field(json_schema_extra={"enum": [1, -1]})]
#: The bound is there so that squares stay finite; no quantity of ours comes near it.
NotNegative = Annotated[float, Field(ge=0, le=1e9)]

#: Lists become tuples, so that a frozen model is frozen all the way down.
Reals = Annotated[tuple[float, ...], Strict(False), Field(min_length=1)]
NotNegatives = Annotated[tuple[NotNegative, ...], Strict(False), Field(min_length=1)]
Triple = Annotated[tuple[float, float, float], Strict(False)]
