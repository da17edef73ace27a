"""Instants: an RFC 3339 time with a zone, kept as UTC, exact to the microsecond."""

from __future__ import annotations

import re
from datetime import UTC, datetime
from typing import Annotated

from pydantic import BeforeValidator, PlainSerializer, WithJsonSchema

from fogreduce.metadata.faults import unexpected

_EXPECTED = "a time with its zone, such as 2014-05-12T13:00:00Z (at most microseconds)"
_SHAPE = re.compile(r"\d{4}-\d{2}-\d{2}[Tt ]\d{2}:\d{2}:\d{2}(\.\d{1,6})?([Zz]|[+-]\d{2}:\d{2})", re.ASCII)


def parse_instant(value: object) -> datetime:
    """A time with its zone, as UTC."""
    if isinstance(value, str) and _SHAPE.fullmatch(value):
        try:
            value = datetime.fromisoformat(value.upper())
        except ValueError:
            raise unexpected(_EXPECTED) from None
    if not isinstance(value, datetime) or value.tzinfo is None:
        raise unexpected(_EXPECTED)
    try:
        return value.astimezone(UTC)
    except OverflowError:
        raise unexpected(_EXPECTED) from None


def instant_text(instant: datetime) -> str:
    """The way we write an instant: ``2014-05-12T13:00:00Z``, with a fraction only where there is one."""
    return instant.astimezone(UTC).replace(tzinfo=None).isoformat() + "Z"


Instant = Annotated[
    datetime,
    BeforeValidator(parse_instant),
    PlainSerializer(instant_text, when_used="json"),
    WithJsonSchema({"type": "string", "format": "date-time", "description": _EXPECTED}),
]
