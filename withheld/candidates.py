"""Diagnosers that know nothing, to prove the scorer: each has one habit, and its score must show that habit.

They write what the contract asks of `diagnosis.json`, from the campaign's metadata alone.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from withheld.atomic import read_json, write_json
from withheld.chain.campaign import Campaign, read_campaign
from withheld.effects.catalogue import IN_ONE_RUN, NAMES, block
from withheld.errors import BadInput
from withheld.streams import stream

Candidate = Callable[[Campaign, tuple[str, ...]], dict[str, Any]]


def document_of(campaign: Campaign, names: tuple[str, ...], verdict: str, gap: float) -> dict[str, Any]:
    """A diagnosis.json of a verdict and its probability of a gap, without places and causes."""
    closure = {
        "measure": "none: nothing was measured", "held_out": "nothing was fitted",
        "before": 2.0, "after": 2.0,
        "expected_if_closed": 1.0, "fraction": 0.0, "std": 1.0, "interval_95": [-1.96, 1.96],
    }  # fmt: skip
    return {
        "schema": "fogreduce/diagnosis/1", "campaign": campaign.name,
        "runs": [run.run_id for run in campaign.runs], "catalogue": list(names), "verdict": verdict,
        "gap_probability": gap, "where": [], "causes": [], "unknown_probability": 0.0,
        "closure": None if verdict == "no_gap" else closure,
        "remainder": {"significant": verdict == "unexplained", "p_value": 0.5, "where": []},
        "next_run": None,
    }  # fmt: skip


def place_of(stage: str, channels: list[str], runs: list[str]) -> dict[str, Any]:
    """One entry of `where` in a diagnosis.json."""
    return {"stage": stage, "channels": channels, "runs": runs, "feature": "mean", "sigma": 5.0, "share": 1.0}


def no_gap(campaign: Campaign, names: tuple[str, ...]) -> dict[str, Any]:
    """Always content."""
    return document_of(campaign, names, "no_gap", 0.01)


def unexplained(campaign: Campaign, names: tuple[str, ...]) -> dict[str, Any]:
    """Always alarmed, at every gyro, and never with a cause."""
    gyros = [f"gyro{i + 1}" for i in range(campaign.unit.n)]
    places = [place_of("gyro", gyros, [run.run_id for run in campaign.runs])]
    return document_of(campaign, names, "unexplained", 0.99) | {"where": places, "unknown_probability": 0.99}


def _members(campaign: Campaign, names: tuple[str, ...]) -> list[dict[str, Any]]:
    """Every effect at every place that it could have."""
    gyros = [f"gyro{i + 1}" for i in range(campaign.unit.n)]
    members = []
    for effect in names:
        seats = [["table"]] if block(effect) == "table" else [[gyro] for gyro in gyros]
        if effect == "clock_error":
            seats = [["clock"]]
        elif effect == "common_noise":
            seats = [gyros]
        runs = [[run.run_id] for run in campaign.runs] if effect in IN_ONE_RUN else [["*"]]
        members += [{"effect": effect, "channels": c, "runs": r} for c in seats for r in runs]
    return members


def one_group(campaign: Campaign, names: tuple[str, ...]) -> dict[str, Any]:
    """Always explained, by everything at once: one group that holds the whole catalogue."""
    members = _members(campaign, names)
    group = [{**member, "probability": 1.0 / len(members)} for member in members]
    cause = {**group[0], "group_probability": 0.99, "group": group, "parameters": {}}
    places = [place_of("gyro", ["gyro1"], [run.run_id for run in campaign.runs])]
    return document_of(campaign, names, "explained", 0.99) | {"where": places, "causes": [cause]}


def guess(campaign: Campaign, names: tuple[str, ...]) -> dict[str, Any]:
    """A coin for the gap, a die for the cause; the same campaign gets the same guess."""
    rng: np.random.Generator = stream(0, "guess", campaign.name)
    if rng.random() < 0.5:
        return document_of(campaign, names, "no_gap", 0.3)
    members = _members(campaign, names)
    member = members[rng.integers(len(members))]
    alone = [{**member, "probability": 0.5}]
    cause = {**alone[0], "group_probability": 0.5, "group": alone, "parameters": {}}
    places = [place_of(block(member["effect"]), member["channels"], member["runs"])]
    return document_of(campaign, names, "explained", 0.7) | {"where": places, "causes": [cause]}


CANDIDATES: dict[str, Candidate] = {
    "no_gap": no_gap,
    "one_group": one_group,
    "unexplained": unexplained,
    "guess": guess,
}


def diagnose(name: str, folder: Path, calibrations: Path, out: Path, without: tuple[str, ...] = ()) -> None:
    """Write `out/diagnosis.json` for one campaign."""
    if name not in CANDIDATES:
        raise BadInput(f"candidate {name}: expected one of {', '.join(CANDIDATES)}")
    names = tuple(effect for effect in NAMES if effect not in without)
    write_json(out / "diagnosis.json", CANDIDATES[name](read_campaign(folder, calibrations), names))


def diagnose_batch(name: str, batch: Path, out: Path) -> None:
    """The same for every campaign of a batch."""
    for case, public in sorted(read_json(batch / "public.json").items()):
        folder = batch / "campaigns" / case
        diagnose(name, folder, batch / "calibrations", out / case, tuple(public["without"]))
