"""Whether a command answered a spoilt file as it must."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

from attempt import Outcome

_LINE = re.compile(r"\S.*: found .+; expected .+")
_LONGEST_LINE = 1500


def beside_flags(err: str) -> list[str]:
    """What standard error says beside red flags and warnings, which go with a good end."""
    return [line for line in err.splitlines() if not line.startswith(("red flag: ", "warning: "))]


def faults_of(outcome: Outcome, forbidden: list[str], known: list[Path], after: list[Path]) -> list[str]:
    """What is wrong with an answer; empty where nothing is.

    Parameters
    ----------
    outcome : Outcome
    forbidden : list of str
        What the contract forbids in the file.
    known, after : list of Path
        Files before and after.
    """
    wrong = []
    if "Traceback" in outcome.err:
        return ["traceback: " + outcome.err.strip().splitlines()[-1][:150]]
    if outcome.status not in (0, 2):
        return [f"status {outcome.status}: {outcome.err.strip()[:150]}"]
    if outcome.status == 0:
        if said := beside_flags(outcome.err):
            wrong.append("a good end, and yet it says: " + said[0][:150])
        if forbidden:
            wrong.append(f"accepted what is forbidden: {forbidden[0][:100]}")
    else:
        lines = outcome.err.removesuffix("\n").split("\n")
        odd = [line for line in lines if not _LINE.fullmatch(line) or len(line) > _LONGEST_LINE]
        if odd:
            wrong.append(f"an error without file, found and expected: {odd[0][:150]!r}")
        if not outcome.err.removesuffix("\n").replace("\n", "").isprintable():
            wrong.append("an error that holds control characters")
        if outcome.out:
            wrong.append("an error, and yet it says on standard output: " + outcome.out[:100])
        if more := [path for path in after if path not in known]:
            wrong.append(f"an error, and yet it left {more[0].name}")
    if left := [path for path in after if path.name.endswith(".tmp")]:
        wrong.append(f"left {left[0].name}")
    return wrong


def faults_of_tables(out: Path) -> list[str]:
    """Numbers in results that are not finite: a table or a report says nothing (empty, null) instead."""
    wrong = []
    for path in sorted(out.glob("tables/*.csv")):
        with path.open(newline="") as file:
            for row in csv.reader(file):
                if any(cell.lower().lstrip("-") in ("nan", "inf") for cell in row):
                    wrong.append(f"{path.name} holds {row[:6]}")
    for path in sorted(out.glob("reports/*.json")):
        json.loads(
            path.read_text(), parse_constant=lambda word, name=path.name: wrong.append(f"{name}: {word}")
        )
    return wrong


def quality(out: Path) -> dict[str, int]:
    """The counts of quality.csv."""
    with (out / "tables" / "quality.csv").open(newline="") as file:
        return {row["what"]: int(row["count"]) for row in csv.DictReader(file)}
