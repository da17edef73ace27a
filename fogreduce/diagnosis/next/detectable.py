"""What a planned campaign would show: the smallest amplitude of each effect that would be seen, before any
capture exists, and which effects it could not tell apart.

An effect is seen where the odds for a gap are even or better: its evidence (`inference/evidence`) times its
prior. What the evidence would be is worked out at the expected data; noise then moves the square root of
twice the gain in ln likelihood by one standard deviation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from fogreduce.diagnosis.next.detectable_fast import fast_rows
from fogreduce.diagnosis.next.detectable_row import Row
from fogreduce.diagnosis.next.detectable_slow import slow_rows
from fogreduce.diagnosis.observe.capture import read_inputs
from fogreduce.effects.table import EFFECTS, catalogue
from fogreduce.errors import BadInput
from fogreduce.metadata.part import Part

SCHEMA = "fogreduce/detectable/1"
#: What is said of effects of a temperature that is not logged (`which/catalogue/unlogged`).
UNLOGGED = "without a temperature log in every run it shows as a smooth random drift, which has no amplitude"


def detectable(
    campaign: Path,
    calibrations: Path,
    probability: float = 0.95,
    snr: float = 10.0,
    without: Sequence[str] = (),
    only: Sequence[str] = (),
    part: Part | None = None,
) -> dict[str, Any]:
    """What a campaign would show, from its run.yaml files alone, as detectable.json has it.

    Parameters
    ----------
    campaign, calibrations : Path
    probability : float
        With which an amplitude is to be seen.
    snr : float
        Signal-to-noise ratio of an effect that is to be told from others.
    without : names of effects
        Left out of the catalogue.
    only : run ids
        Empty: all.
    part : Part or None
        A data sheet: it fills in what the record does not state.
    """
    if not 0.5 <= probability < 1.0:
        raise BadInput.at("--probability", "", found=probability, expected="0.5 or more, and less than 1")
    if not 1.0 <= snr <= 1e6:
        raise BadInput.at("--snr", "", found=snr, expected="1 to 1e6")
    allowed = catalogue(without)
    inputs = read_inputs(campaign, calibrations, only, need_capture=False, part=part)
    rows = [*slow_rows(inputs, allowed, probability, snr), *fast_rows(inputs, allowed, probability)]
    rows = [_within(row) for row in rows]
    order = list(EFFECTS)
    rows.sort(key=lambda row: order.index(row.effect))
    absent = [name for name in order if name in allowed and all(row.effect != name for row in rows)]
    return {
        "schema": SCHEMA,
        "campaign": campaign.resolve().name,
        "runs": [one.facts.run_id for one in inputs],
        "probability": probability,
        "snr": snr,
        "effects": [row.document(inputs[0].facts.raw_unit.name) for row in rows],
        "groups": groups(rows),
        "not_shown": {name: _why(name, inputs) for name in absent},
    }


def _within(row: Row) -> Row:
    """A row whose amplitude the effect could have; one beyond that is not seen."""
    high = next((p.high for p in EFFECTS[row.effect].parameters if p.name == row.parameter), np.inf)
    if row.amplitude is None or row.amplitude <= high:
        return row
    return replace(row, amplitude=None, seen=False)


def groups(rows: Sequence[Row]) -> list[list[str]]:
    """Effects of which each is not told from some other of its group, by label."""
    left = {row.label: set(row.rivals) for row in rows}
    for name, rivals in list(left.items()):
        for other in rivals:
            left.setdefault(other, set()).add(name)
    out: list[list[str]] = []
    seen: set[str] = set()
    for name in left:
        if name in seen or not left[name]:
            continue
        group, waiting = [], [name]
        while waiting:
            here = waiting.pop(0)
            if here not in seen:
                seen.add(here)
                group.append(here)
                waiting += sorted(left[here] - seen)
        out.append(group)
    return out


def _why(name: str, inputs: Sequence[Any]) -> str:
    """Why an effect does nothing in these runs, as far as that is plain."""
    if EFFECTS[name].needs_temperature and any(one.scene.temperature is None for one in inputs):
        return UNLOGGED
    if inputs[0].facts.n_gyros == 1 and EFFECTS[name].needs_pair:
        return "needs a second gyro"
    return "does nothing in these runs"
