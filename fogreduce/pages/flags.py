"""Kinds of records out of the ordinary, in words."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping

from fogreduce.pages.numbers import count

#: Kind of what is flagged -> in words. Kinds of one gyro end in ``_gyro<k>``.
FLAGS = {
    "lost": "records lost (holes in the pulse numbers)",
    "torn_bytes": "octets of a torn last record",
    "repeated": "records whose pulse number occurred before",
    "out_of_order": "records that came after a later pulse",
    "bad_stamp": "records whose stamp and pulse number disagree",
    "beyond_profile": "records before the commanded profile's start or after its end",
    "accelerating": "records in which the table had not yet reached the commanded rate",
    "constant": "readings that stay the same for longer than chance",
    "missing": "answers missing",
    "spurious": "spurious counts",
    "unstable_intervals": "unstable intervals",
}


def flag(kind: str) -> str:
    """What was flagged in words."""
    what, _, gyro = kind.rpartition("_gyro")
    if what in FLAGS:
        return f"gyro {gyro}: {FLAGS[what]}"
    return FLAGS.get(kind, kind.replace("_", " "))


def flags_text(flagged: Mapping[str, int]) -> str:
    """What was flagged, the gyros taken together."""
    sums: Counter[str] = Counter()
    for kind, value in flagged.items():
        what, _, _ = kind.rpartition("_gyro")
        sums[what if what in FLAGS else kind] += value
    return ", ".join(f"{count(value)} {kind.replace('_', ' ')}" for kind, value in sums.items())
