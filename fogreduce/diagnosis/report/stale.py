"""Where a diagnosis says that the calibration record is stale: the way to a record from the same runs."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import Any

from fogreduce.effects.table import EFFECTS

#: So many gyros off in the same campaign are no fault of one of them.
_FEWEST_GYROS = 2
#: A stated uncertainty that the runs move by more of its standard deviations is in doubt.
_DOUBT_SIGMA = 3.0


def is_stale(document: Mapping[str, Any]) -> bool:
    """Whether two gyros or more are off, in all runs, in what the record holds: as causes, or in tension.

    A run with a mistake in it pulls at all of them and says nothing of the record.
    """
    if document.get("mistakes"):
        return False
    off = [cause for cause in document["causes"] if cause["probability"] > 0.5]
    off += [t for t in document["tension"] if abs(t["sigma"]) > _DOUBT_SIGMA]
    gyros = {
        channel
        for one in off
        if EFFECTS[one["effect"]].of_record and one["runs"] == ["*"]
        for channel in one["channels"]
    }
    return len(gyros) >= _FEWEST_GYROS


def way_out(document: Mapping[str, Any]) -> str:
    """A paragraph that points to `derive-calibration`; empty where the record holds."""
    if not is_stale(document):
        return ""
    command = f"fogreduce derive-calibration {escape(document['campaign'])} --calibrations DIR --out DIR"
    return (
        "<p>The calibration record is stale: what it holds of several gyros is off in all runs. "
        f"<code>{command}</code>, with the campaign's folder, derives a candidate record from these runs, "
        "with its errors; no result uses it until a run or a campaign names it.</p>"
    )
