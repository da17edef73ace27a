"""Time stamps that are coarse, scatter, repeat, go back, or count from elsewhere."""

from __future__ import annotations

from collections.abc import Iterator

from fogreduce.plausibility.epoch import epoch_in_words
from fogreduce.plausibility.finding import Finding, Seen

#: Parts of an interval: a resolution that is coarse, a scatter (one standard deviation) that is large.
_COARSE, _SCATTER = 1.0, 0.25
#: A record that starts within a second, or two samples, starts with the profile.
_START_S, _START_SAMPLES = 1.0, 2.0
_LONGEST_LIST = 3


def coarse_or_scattered(seen: Seen) -> Iterator[Finding]:
    """Stamps that do not tell single samples apart."""
    clock = seen.report["clock"]
    if clock["rate_hz"] is None:
        return
    interval_s = 1 / clock["rate_hz"]
    resolution_s = clock["resolution_us"] / 1e6
    expected = f"one stamp a sample, every {interval_s:.6g} s; records are numbered in their order"
    if resolution_s > (1 + _COARSE) * interval_s:
        found = f"stamps in steps of {resolution_s:.6g} s, {clock['doubled_stamps']} equal to the one before"
        yield seen.warning("coarse_stamps", "time stamps", found, expected)
    elif clock["jitter_s"] > _SCATTER * interval_s:
        found = f"jitter of {clock['jitter_s']:.3g} s ({clock['jitter_s'] / interval_s:.2g} of an interval)"
        yield seen.warning("jitter", "time stamps", found, expected)
    elif clock["doubled_stamps"]:
        number = clock["doubled_stamps"]
        found = f"{number} record{'s' if number > 1 else ''} with the stamp of the one before"
        yield seen.warning("doubled_stamp", "time stamps", found, "a stamp of its own for each")


def steps_back(seen: Seen) -> Iterator[Finding]:
    """A clock that was set back, or wrapped."""
    steps = seen.report["clock"]["steps_back"]
    for number, step in enumerate(steps[:_LONGEST_LIST], start=1):
        found = f"a step back of {step['seconds']:.6g} s at record {step['record']}"
        if number == _LONGEST_LIST < len(steps):
            found += f", and at {len(steps) - _LONGEST_LIST} or more others"
        expected = "stamps that run on; it was taken out, the records are used"
        yield seen.warning("step_back", "time stamps", found, expected)


def disagreeing(seen: Seen) -> Iterator[Finding]:
    """Stamps that disagree with the pulse numbers."""
    bad = seen.report["flagged"]["bad_stamp"]
    if not bad:
        return
    place = seen.report["places"]["bad_stamp"][0]
    found = f"{bad} of {seen.records} stamps that disagree with the records' numbers"
    found += f", the first at record {place['record']}: {place['time_s']:.6g} s for number {place['pulse']}"
    yield seen.warning("bad_stamp", "time stamps", found, "stamps in step; these records are not used")


def start(seen: Seen) -> Iterator[Finding]:
    """A first stamp far from 0."""
    clock = seen.report["clock"]
    first_s = clock["first_s"]
    if abs(first_s) <= max(_START_S, _START_SAMPLES / clock["stated_rate_hz"]):
        return
    epoch = epoch_in_words(first_s, seen.facts.start_us)
    found = f"a first stamp of {first_s:.10g} s" + (f" ({epoch})" if epoch else "")
    key = "capture.time_zero takes an epoch away" if clock["numbered_by"] == "ingest" else "the run's start"
    yield seen.warning("start", "time stamps", found, f"about 0 s, where the profile begins; {key}")
