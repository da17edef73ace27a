"""Readings that no live gyro gives: none at all, one constant value, or steps coarser than the noise."""

from __future__ import annotations

from collections.abc import Iterator

from fogreduce.plausibility.finding import Finding, Seen

#: Share of readings that repeat the one before, from which on the least step exceeds twice the noise:
#: two readings of sigma = step / 2 are equal in 52 % of all pairs.
_COARSE = 0.52


def absent(seen: Seen) -> Iterator[Finding]:
    """A gyro that never answered."""
    for k in range(seen.facts.n_gyros):
        if seen.report["flagged"][f"missing_gyro{k + 1}"] == seen.records:
            found = "no reading in the whole run"
            yield seen.warning("absent_gyro", f"gyro{k + 1}", found, "readings; without them no x, y, z")


def dead(seen: Seen) -> Iterator[Finding]:
    """A gyro whose reading never changes."""
    for k, share in enumerate(seen.report["repeated_readings"]):
        answered = seen.report["flagged"][f"missing_gyro{k + 1}"] < seen.records
        if share == 1.0 and answered and seen.records > 2:
            found = "one constant reading in the whole run: a dead gyro, or noise and signal below one step"
            yield seen.warning("dead_gyro", f"gyro{k + 1}", found, "readings that scatter")


def constant(seen: Seen) -> Iterator[Finding]:
    """Stretches in which a gyro's reading stays the same for longer than chance."""
    for k in range(seen.facts.n_gyros):
        kind = f"constant_gyro{k + 1}"
        if count := seen.report["flagged"].get(kind, 0):
            place = seen.report["places"][kind][0]
            found = (
                f"{count} readings that stay the same for longer than chance, from {place['time_s']:.6g} s"
            )
            found += f" (record {place['record']}): a rail, or a gyro that is frozen"
            yield seen.warning("constant", f"gyro{k + 1}", found, "readings that scatter; these are not used")


def coarse(seen: Seen) -> Iterator[Finding]:
    """Counts coarser than the noise: no average brings back what lies between two steps."""
    for k, share in enumerate(seen.report["repeated_readings"]):
        if share is None or not _COARSE < share < 1.0:
            continue
        if seen.report["flagged"].get(f"constant_gyro{k + 1}", 0) > 0.1 * seen.records:
            continue
        found = f"{100 * share:.3g} % of readings equal to the one before: steps coarser than the noise"
        found += f" (one is {seen.facts.least_count:.6g} {seen.facts.raw_unit.name})"
        expected = "noise of half a step and more; errors in the tables may be too small"
        yield seen.warning("coarse_counts", f"gyro{k + 1}", found, expected)
