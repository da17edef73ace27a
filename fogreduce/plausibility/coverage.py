"""How much of the commanded profile the capture covers, and what of it is not used."""

from __future__ import annotations

from collections.abc import Iterator

from fogreduce.plausibility.finding import Finding, Seen

#: Part of the records above which lost or flagged ones are said.
_MUCH = 0.01
#: A single hole is said from so many seconds and pulses on.
_HOLE_S, _HOLE_PULSES = 1.0, 8
_LONGEST_LIST = 3
#: Said by a finding of their own.
_SAID_ELSEWHERE = ("bad_stamp", "beyond_profile", "accelerating")


def lost(seen: Seen) -> Iterator[Finding]:
    """Records lost: more than 1 % of them."""
    lost_records, expected = int(seen.report["lost"]), int(seen.report["expected"])
    if lost_records - seen.report["flagged"]["bad_stamp"] <= _MUCH * expected:
        return  # a record with a wrong stamp is lost to estimates, and said elsewhere
    clock, end_s = seen.report["clock"], seen.facts.profile.end_s
    found = f"{seen.records} records, {lost_records} lost ({100 * lost_records / expected:.3g} %)"
    if clock["last_s"] < (1 - _MUCH) * end_s:
        found += f"; the last stamp is {clock['last_s']:.6g} s"
    wanted = f"{expected} records in {end_s:.10g} s, as table.profile says"
    yield seen.warning("lost", "records", found, wanted)


def holes(seen: Seen) -> Iterator[Finding]:
    """Single holes of a second and more within the record."""
    rate_hz = seen.facts.sample_rate_hz
    last = [hole["first_pulse"] + hole["pulses"] for hole in seen.report["lost_places"]]
    long = [
        hole
        for hole, stop in zip(seen.report["lost_places"], last, strict=True)
        if hole["pulses"] >= max(_HOLE_S * rate_hz, _HOLE_PULSES) and stop < seen.report["expected"]
    ]
    for hole in long[:_LONGEST_LIST]:
        first, pulses = hole["first_pulse"], hole["pulses"]
        found = f"a hole of {pulses / rate_hz:.6g} s ({pulses} records) at {first / rate_hz:.6g} s"
        yield seen.warning("hole", f"pulse {first}", found, "records without a hole")


def longer_than_profile(seen: Seen) -> Iterator[Finding]:
    """A record that goes on after the profile's end, or begins before its start."""
    outside = int(seen.report["flagged"]["beyond_profile"])
    if outside <= _MUCH * seen.records:
        return
    clock = seen.report["clock"]
    found = f"{outside} of {seen.records} records outside the profile"
    found += f" (stamps {clock['first_s']:.6g} to {clock['last_s']:.6g} s)"
    expected = f"0 to {seen.facts.profile.end_s:.10g} s, as table.profile says; the others are not used"
    yield seen.warning("beyond_profile", "table.profile", found, expected)


def flagged(seen: Seen) -> Iterator[Finding]:
    """Kinds of flags that more than 1 % of the records have."""
    for kind, count in seen.report["flagged"].items():
        if kind in _SAID_ELSEWHERE or kind.startswith("constant") or count <= _MUCH * seen.records:
            continue
        if kind.startswith("missing") and count == seen.records:
            continue  # an absent gyro
        found = f"{count} of {seen.records} records flagged {kind} ({100 * count / seen.records:.3g} %)"
        yield seen.warning(kind, "records", found, "less than 1 %")


def accelerating(seen: Seen) -> Iterator[Finding]:
    """A table that took its time to reach a commanded rate."""
    for segment, seconds in list(seen.report["settling_s"].items())[:_LONGEST_LIST]:
        rate = seen.facts.profile.rate_deg_s[int(segment) - 1]
        found = f"{seconds:.3g} s until the table turned at {rate:g} deg/s"
        expected = "the rate from the segment's start; these records are not used"
        yield seen.warning("accelerating", f"table.profile[{int(segment) - 1}]", found, expected)
