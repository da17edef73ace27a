"""Logs beside the capture: whether they are of this run, and cover it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fogreduce.estimate.encoder import compare_with_command
from fogreduce.plausibility.epoch import epoch_in_words
from fogreduce.plausibility.finding import Finding, Seen

#: Part of the run that a log may leave out at either end, and seconds that it may at least.
_LEFT_OUT, _LEFT_OUT_S = 0.05, 5.0
#: A log that goes on for so many times the run is of another.
_LONGER, _LONGER_S = 2.0, 600.0
#: What electronics of the military range are made for (MIL-STD-883) [degC].
_COLDEST_DEGC, _HOTTEST_DEGC = -55.0, 125.0
#: A table's rate off the command by so much of it, or so many deg/s, is none of this profile.
_RATE, _RATE_DEG_S = 0.01, 0.01
_GUARD_S = 0.5


def coverage(seen: Seen) -> Iterator[Finding]:
    """Logs that cover a part of the run, or another one."""
    logs = (("temperature", seen.temperature), ("table_log", seen.table))
    end_s = seen.facts.profile.end_s
    slack_s = max(_LEFT_OUT * end_s, _LEFT_OUT_S)
    for key, log in logs:
        if log is None:
            continue
        first_s, last_s = float(log.time_s[0]), float(log.time_s[-1])
        found = f"rows from {first_s:.10g} to {last_s:.10g} s"
        if first_s >= end_s or last_s <= 0:
            epoch = epoch_in_words(first_s, seen.facts.start_us)
            found += f" ({epoch})" if epoch else ", none within the run: the log of another run?"
        elif first_s > slack_s or last_s < end_s - slack_s:
            found += ", a part of the run"
        elif last_s - first_s > max(_LONGER * end_s, end_s + _LONGER_S) or first_s < -_LONGER_S:
            found += ", far more than the run: the log of another run?"
        else:
            continue
        expected = f"0 to {end_s:.10g} s, the run's profile"
        yield seen.warning(f"{key}_coverage", key, found, expected, file=seen.run.get(key))


def temperatures(seen: Seen) -> Iterator[Finding]:
    """Temperatures that no unit works at: of a log in kelvin or degrees Fahrenheit, say."""
    log = seen.temperature
    if log is None:
        return
    for name, values in (("electronics", log.electronics_degC), ("sensor", log.sensor_degC)):
        if values is None:
            continue
        middle = float(np.median(values))
        if not _COLDEST_DEGC <= middle <= _HOTTEST_DEGC:
            found = f"a median {name} temperature of {middle:.6g} degC"
            expected = f"{_COLDEST_DEGC:g} to {_HOTTEST_DEGC:g} degC: is the log in another unit, as K?"
            yield seen.warning(
                "temperatures", "temperature", found, expected, file=seen.run.get("temperature")
            )


def encoder_rate(seen: Seen) -> Iterator[Finding]:
    """An encoder's log whose rates are not those of the profile."""
    if seen.table is None:
        return
    profile = seen.facts.profile
    for segment in compare_with_command(seen.table.time_s, seen.table.angle_deg, profile, _GUARD_S):
        off = segment.rate_deg_s - segment.commanded_deg_s
        if abs(off) <= max(_RATE * abs(segment.commanded_deg_s), _RATE_DEG_S, 5 * segment.rate_err_deg_s):
            continue
        found = f"{segment.rate_deg_s:.7g} deg/s in segment {segment.number}"
        expected = f"{segment.commanded_deg_s:.7g} deg/s, as table.profile says"
        yield seen.warning("encoder_rate", "table_log", found, expected, file=seen.run.get("table_log"))
