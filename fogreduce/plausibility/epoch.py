"""Stamps that count from an epoch of their own and not from the run's start: which one it is."""

from __future__ import annotations

from fogreduce.constants import MICROSECONDS_PER_SECOND

#: Days that a clock's time may be off the run's start and still be it.
_NEAR_S = 2 * 86_400.0
#: GPS time began at 1980-01-06T00:00:00Z; it leaves out leap seconds (18 since 2017, fewer before).
_GPS_EPOCH_S = 315_964_800
_GPS_WEEK_S = 604_800.0
#: Smaller units in which an epoch's time is written.
_UNITS = {"seconds": 1.0, "milliseconds": 1e3, "microseconds": 1e6, "nanoseconds": 1e9}


def epoch_in_words(stamp_s: float, start_us: int) -> str:
    """What a stamp far from 0 seems to be, by the run's start; empty where nothing fits.

    Parameters
    ----------
    stamp_s : float
        The first stamp, read as seconds since the run's start.
    start_us : int
        The run's start, microseconds since 1970-01-01T00:00:00Z.
    """
    start_s = start_us / MICROSECONDS_PER_SECOND
    for unit, per_second in _UNITS.items():
        if abs(stamp_s / per_second - start_s) < _NEAR_S:
            return f"{unit} since 1970, Unix time"
        if abs(stamp_s / per_second - (start_s - _GPS_EPOCH_S)) < _NEAR_S:
            return f"{unit} since 1980-01-06, GPS time"
    of_week = (start_s - _GPS_EPOCH_S) % _GPS_WEEK_S
    if stamp_s > 1 and abs(stamp_s - of_week) < 60:
        return "seconds of the GPS week"
    if stamp_s > 1 and abs(stamp_s - start_s % 86_400) < 60:
        return "seconds of the day"
    for name, first_s in (("Unix", 0), ("GPS", _GPS_EPOCH_S)):
        for unit, per_second in _UNITS.items():
            since_1970 = stamp_s / per_second + first_s
            if 946_684_800 < since_1970 < 4_102_444_800:  # the years 2000 to 2100
                return f"as {unit} of {name} time, of another date than started_at"
    return ""
