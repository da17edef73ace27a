"""Runs that might be next: about each axis, both senses, slow, still; in a soak; shorter and longer."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fogreduce.datasets.logs import TemperatureLog
from fogreduce.diagnosis.observe.blocks import Blocks
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.diagnosis.observe.predict import Scene
from fogreduce.metadata.run import Run
from fogreduce.simulate.plan import facts_of

RUN_ID = "next-run"
#: Durations that are weighed, as parts and multiples of today's longest.
DURATIONS = (0.25, 0.5, 1.0, 2.0, 4.0)
SOAK_DEGC = 20.0
_SECOND = {"x": ("z", "north"), "y": ("x", "north"), "z": ("y", "north")}
_ROOM_DEGC = 22.0


@dataclass(frozen=True)
class Proposal:
    """A run that might be next.

    Attributes
    ----------
    axis, way : str
        Axis of the unit that the table turns it about, and where it points: ``up`` or ``down``.
    rate_deg_s, duration_s : float
    soak : bool
        Whether the sensor is warmed by `SOAK_DEGC` in the first half of the run.
    """

    axis: str
    way: str
    rate_deg_s: float
    duration_s: float
    soak: bool = False

    @property
    def orientation(self) -> dict[str, str]:
        """As run.yaml has it."""
        other, direction = _SECOND[self.axis]
        return {self.axis: self.way, other: direction}

    @property
    def words(self) -> str:
        """In plain English."""
        motion = "standing still" if self.rate_deg_s == 0.0 else f"turning at {self.rate_deg_s:g} deg/s"
        warm = f", warmed by {SOAK_DEGC:g} degC in its first half" if self.soak else ""
        return f"{motion} with {self.axis} {self.way} for {self.duration_s:g} s{warm}"

    def profile(self) -> list[dict[str, float]]:
        """As run.yaml has it."""
        return [{"rate_deg_s": self.rate_deg_s, "duration_s": self.duration_s}]


def proposals(inputs: Sequence[RunInput], soaks: bool) -> Iterator[Proposal]:
    """Runs as long as today's longest.

    Parameters
    ----------
    inputs : runs of today
    soaks : bool
        Whether what is to be separated acts through temperature.
    """
    longest = longest_s(inputs)
    fastest = max((abs(s.rate_deg_s) for one in inputs for s in one.run.table.profile), default=0.0)
    fast = fastest if fastest >= 1.0 else 10.0
    for axis in _SECOND:
        for way in ("up", "down"):
            for rate in (fast, -fast, 0.5, 0.0):
                yield Proposal(axis, way, rate, longest)
        if soaks:
            for rate in (fast, 0.0):
                yield Proposal(axis, "up", rate, longest, True)


def longest_s(inputs: Sequence[RunInput]) -> float:
    """Duration of today's longest run [s]."""
    return max(one.run.duration_s for one in inputs)


def is_warm(inputs: Sequence[RunInput]) -> bool:
    """Whether every run of today has a temperature log, so that the next should have one."""
    return all(one.scene.temperature is not None for one in inputs)


def temperature(inputs: Sequence[RunInput], proposal: Proposal) -> TemperatureLog | None:
    """The log that the run would have: a soak's, or a steady one where today's runs have logs."""
    if not (proposal.soak or is_warm(inputs)):
        return None
    today = inputs[0].scene.temperature
    start = _ROOM_DEGC if today is None else round(float(today.sensor_degC[0]), 1)
    time_s = np.arange(np.ceil(proposal.duration_s) + 1.0)
    share = np.clip(2.0 * time_s / proposal.duration_s, 0.0, 1.0)
    sensor = start + SOAK_DEGC * share * proposal.soak
    return TemperatureLog(time_s, None, sensor)


def as_input(inputs: Sequence[RunInput], proposal: Proposal) -> RunInput:
    """The proposal as a run like those of today."""
    pattern = inputs[0]
    run = Run.from_data(run_document(pattern.run, proposal), "next run")
    facts = facts_of(run, pattern.record)
    scene = Scene(facts, temperature(inputs, proposal), Blocks.of(facts))
    return replace(pattern, run=run, facts=facts, scene=scene)


def run_document(pattern: Run, proposal: Proposal, with_log: bool = False) -> dict[str, Any]:
    """run.yaml of a proposal: unit, site and capture as today's first run has them."""
    data = pattern.model_dump(mode="json", by_alias=True, exclude_none=True)
    for key in ("temperature", "table_log", "notes"):
        data.pop(key, None)
    if data["capture"].get("time_zero") is not None:
        data["capture"]["time_zero"] = "first"  # today's epoch is not that of another day's stamps
    if with_log:
        data["temperature"] = "temperature.csv"
    return {
        **data,
        "run_id": RUN_ID,
        "azimuth_deg": 0.0,
        "table": {**data["table"], "axis": proposal.axis, "profile": proposal.profile()},
        "orientation": proposal.orientation,
    }
