"""What stands at the top of a page: red flags of rates.csv, warnings of ingest, records lost or flagged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from fogreduce.pages.numbers import minus_signs
from fogreduce.pages.rate_flags import flag_text, odd_rows
from fogreduce.stages.read_table import Row

RED_FLAG, WARNING = "red flag", "warning"
#: A kind of record lost or flagged more often than this is said at the top.
_SHARE = 0.01
#: So many of a kind stand at the top; the tables have all.
_MOST = 6


@dataclass(frozen=True)
class RunsToSee:
    """Runs with something at the top of their pages.

    Attributes
    ----------
    shown : list of dict
        ``run``, ``href`` (None: no page), ``kind``, ``text`` (the first), ``more`` (how many more).
    more : int
        Runs that are not shown.
    """

    shown: list[dict[str, Any]]
    more: int


def attention(
    rates: Sequence[Row], warnings: Sequence[Row], flagged: Mapping[str, int], expected: int
) -> list[dict[str, str]]:
    """What a reader should see first: ``kind`` and ``text`` of each, red flags before warnings.

    Parameters
    ----------
    rates, warnings : sequence of rows
        Of rates.csv and warnings.csv.
    flagged : mapping
        Kind -> records lost or flagged.
    expected : int
        Records that a whole capture holds.
    """
    said = [(RED_FLAG, flag_text(row)) for row in odd_rows(rates)]
    said += [(row["severity"] or WARNING, f"{row['where']}: {row['what']}: {found(row)}") for row in warnings]
    said += [
        (WARNING, f"{kind.replace('_', ' ')}: {value} of {expected} records, {100 * value / expected:.2g} %")
        for kind, value in flagged.items()
        if kind not in ("torn_bytes", "unstable_intervals", *(row["what"] for row in warnings))
        and value > _SHARE * expected
    ]
    return [{"kind": kind, "text": text} for kind, text in said]


def found(row: Row) -> str:
    """What a row of warnings.csv found and expected."""
    return minus_signs(f"found {row['found']}; expected {row['expected']}")


def first_of_each(said: Sequence[Mapping[str, str]]) -> tuple[list[Mapping[str, str]], int]:
    """The first few of each kind, and how many more there are."""
    shown = []
    for kind in dict.fromkeys(entry["kind"] for entry in said):
        shown += [entry for entry in said if entry["kind"] == kind][:_MOST]
    return shown, len(said) - len(shown)


def runs_to_see(
    runs: Sequence[tuple[str, str | None, Sequence[Mapping[str, str]]]], most: int = 10
) -> RunsToSee:
    """Of runs as (name, page, why they are flagged) those with a reason, red flags first, then warnings."""
    listed = [
        {
            "run": name,
            "href": href,
            "kind": reasons[0]["kind"],
            "text": reasons[0]["text"],
            "more": len(reasons) - 1,
        }
        for name, href, reasons in runs
        if reasons
    ]
    order = (RED_FLAG, WARNING)
    listed.sort(key=lambda entry: order.index(entry["kind"]) if entry["kind"] in order else len(order))
    return RunsToSee(listed[:most], max(0, len(listed) - most))


def names_of(kind: str, overviews: Sequence[Mapping[str, Any]]) -> list[str]:
    """Axes, or gyros of units without axes, that have a quantity in some run: x, y, z before gyros."""
    return sorted(
        {name for overview in overviews for name in overview[kind]}, key=lambda name: (len(name), name)
    )
