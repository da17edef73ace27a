"""Conversions between the units of files and those of arithmetic."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

_EPOCH = datetime(1970, 1, 1, tzinfo=UTC)


def microseconds_since_1970(instant: datetime) -> int:
    """Whole microseconds since 1970-01-01T00:00:00Z; exact."""
    return (instant - _EPOCH) // timedelta(microseconds=1)


def instant_of(microseconds: int) -> datetime:
    """The inverse of `microseconds_since_1970`, in UTC."""
    return _EPOCH + timedelta(microseconds=microseconds)
