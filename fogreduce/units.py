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


#: 1980-01-06T00:00:00Z, from which GPS time counts seconds without leap seconds.
GPS_EPOCH_US = microseconds_since_1970(datetime(1980, 1, 6, tzinfo=UTC))

#: Dates (UTC) from which GPS time is one second more ahead of UTC, the first of them 1 s (IERS Bulletin C).
_LEAP_DATES = (
    *("1981-07-01", "1982-07-01", "1983-07-01", "1985-07-01", "1988-01-01", "1990-01-01", "1991-01-01"),
    *("1992-07-01", "1993-07-01", "1994-07-01", "1996-01-01", "1997-07-01", "1999-01-01", "2006-01-01"),
    *("2009-01-01", "2012-07-01", "2015-07-01", "2017-01-01"),
)


def gps_leap_seconds(start_us: int) -> int:
    """How many seconds GPS time is ahead of UTC at an instant, microseconds since 1970."""
    at = [microseconds_since_1970(datetime.fromisoformat(date).replace(tzinfo=UTC)) for date in _LEAP_DATES]
    return sum(leap <= start_us for leap in at)
