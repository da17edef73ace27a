"""The sample rate that the stamps show, against the one stated."""

from __future__ import annotations

from collections.abc import Iterator

from fogreduce.plausibility.finding import Finding, Seen

#: From so much on a rate is said to be off [ppm]: twice what an undisciplined clock of a computer may be.
_OFF_PPM = 1000.0
#: Ratio of the rates from which on it is no clock but a mistake.
_GROSS = 1.5


def rate(seen: Seen) -> Iterator[Finding]:
    """A stated rate off by more than 0.1 %, and by more than the stamps' scatter leaves open."""
    clock = seen.report["clock"]
    if clock["rate_hz"] is None or clock["last_s"] <= clock["first_s"]:
        return
    open_ppm = 1e6 * clock["largest_jitter_s"] / (clock["last_s"] - clock["first_s"])
    if abs(clock["rate_ppm"]) <= max(_OFF_PPM, 2 * open_ppm):
        return
    ratio = clock["rate_hz"] / clock["stated_rate_hz"]
    gross = ratio >= _GROSS or ratio <= 1 / _GROSS
    found = f"{clock['stated_rate_hz']:.10g}"
    expected = f"{clock['rate_hz']:.7g} Hz, which the stamps show ({100 * (ratio - 1):+.3g} %)"
    severity = "error" if gross else "warning"
    yield Finding(severity, "rate", "run.yaml", "capture.sample_rate_hz", found, expected)
