"""The list of all that is looked for, and the look."""

from __future__ import annotations

from collections.abc import Callable, Iterator

from fogreduce.plausibility import coverage, logs, rate, readings, stamps
from fogreduce.plausibility.finding import Finding, Seen

#: In the order in which findings are shown.
LOOKS: tuple[Callable[[Seen], Iterator[Finding]], ...] = (
    rate.rate,
    stamps.start,
    stamps.disagreeing,
    stamps.steps_back,
    stamps.coarse_or_scattered,
    coverage.lost,
    coverage.holes,
    coverage.longer_than_profile,
    coverage.flagged,
    coverage.accelerating,
    readings.absent,
    readings.dead,
    readings.constant,
    readings.coarse,
    logs.coverage,
    logs.temperatures,
    logs.encoder_rate,
)


def findings(seen: Seen) -> list[Finding]:
    """Everything about a run that does not fit, errors first."""
    found = [finding for look in LOOKS for finding in look(seen)]
    return sorted(found, key=lambda finding: finding.severity != "error")
