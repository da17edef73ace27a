"""What a calibration certificate says beside numbers: who calibrated, for whom, with which table."""

from __future__ import annotations

import re
from typing import Annotated

from pydantic import AfterValidator, Field

from fogreduce.metadata.base import Model
from fogreduce.metadata.faults import unexpected


def _like(pattern: str, in_words: str) -> AfterValidator:
    """Text of a pattern, which a fault says in words."""

    def check(text: str) -> str:
        if not re.fullmatch(pattern, text):
            raise unexpected(in_words)
        return text

    return AfterValidator(check)


_TEXT, _COUNTRY, _DIGEST = r"\S(.{0,198}\S)?", "[A-Z]{2}", "[0-9a-f]{64}"
Text = Annotated[
    str,
    _like(_TEXT, "at most 200 characters on one line, no space at either end"),
    Field(json_schema_extra={"pattern": f"^{_TEXT}$"}),
]
Country = Annotated[
    str,
    _like(_COUNTRY, "two capital letters (ISO 3166-1), such as DE"),
    Field(json_schema_extra={"pattern": f"^{_COUNTRY}$"}),
]
Digest = Annotated[
    str,
    _like(_DIGEST, "64 hexadecimal digits, lower case"),
    Field(json_schema_extra={"pattern": f"^{_DIGEST}$"}),
]


class Party(Model):
    """A laboratory or a customer."""

    name: Text = Field(description="its name")
    street: Text | None = Field(default=None, description="street and number")
    city: Text | None = Field(default=None, description="city")
    country: Country | None = Field(default=None, description="ISO 3166-1, two letters")


class Table(Model):
    """The rate table, to whose certificate the scale factors are traceable."""

    name: Text = Field(description="what it is, with maker and model")
    serial_number: Text | None = Field(default=None, description="its serial number")
    certificate: Text = Field(description="number of its calibration certificate")
    certificate_sha256: Digest = Field(description="SHA-256 of that certificate's file")


class Certificate(Model):
    """`certificate` of campaign.yaml; what is left out stands as "not stated"."""

    laboratory: Party | None = Field(default=None, description="who calibrates")
    responsible: Text | None = Field(default=None, description="who answers for it, and signs")
    customer: Party | None = Field(default=None, description="for whom")
    table: Table | None = Field(default=None, description="the rate table")
