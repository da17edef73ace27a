"""Runs that might be next, within what the bench can do: about each axis, both senses, slow, still; in a
soak; shorter and longer.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fogreduce.datasets.logs import TemperatureLog
from fogreduce.diagnosis.observe.blocks import Blocks
from fogreduce.diagnosis.observe.capture import RunInput
from fogreduce.diagnosis.observe.predict import Scene
from fogreduce.metadata.bench import Bench
from fogreduce.metadata.facts import RunFacts
from fogreduce.metadata.run import Run

RUN_ID = "next-run"
#: Durations that are weighed, as parts and multiples of today's longest.
DURATIONS = (0.25, 0.5, 1.0, 2.0, 4.0)
#: A soak warms by so much where chamber and time allow it, and is no soak below the least [degC].
SOAK_DEGC, _LEAST_SOAK_DEGC = 20.0, 1.0
#: Part of a run in which the table may spin up.
_SPIN_UP = 0.05
#: What is assumed of a bench that no file describes.
ANY_BENCH = Bench()
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
    soak_degC : float
        By how much the sensor is warmed in the first half of the run; 0: it is not.
    """

    axis: str
    way: str
    rate_deg_s: float
    duration_s: float
    soak_degC: float = 0.0

    @property
    def orientation(self) -> dict[str, str]:
        """As run.yaml has it."""
        other, direction = _SECOND[self.axis]
        return {self.axis: self.way, other: direction}

    @property
    def words(self) -> str:
        """In plain English."""
        motion = "standing still" if self.rate_deg_s == 0.0 else f"turning at {self.rate_deg_s:g} deg/s"
        warm = f", warmed by {self.soak_degC:g} degC in its first half" if self.soak_degC else ""
        return f"{motion} with {self.axis} {self.way} for {self.duration_s:g} s{warm}"

    def profile(self) -> list[dict[str, float]]:
        """As run.yaml has it."""
        return [{"rate_deg_s": self.rate_deg_s, "duration_s": self.duration_s}]


def proposals(inputs: Sequence[RunInput], soaks: bool, bench: Bench = ANY_BENCH) -> Iterator[Proposal]:
    """Runs as long as today's longest.

    Parameters
    ----------
    inputs : runs of today
    soaks : bool
        Whether what is to be separated acts through temperature.
    bench : Bench
        What table and chamber can do.
    """
    longest = longest_s(inputs)
    fastest = max((abs(s.rate_deg_s) for one in inputs for s in one.run.table.profile), default=0.0)
    fast = _reached(fastest if fastest >= 1.0 else 10.0, longest, bench)
    for axis in _SECOND:
        for way in ("up", "down"):
            for rate in (fast, -fast, min(0.5, fast), 0.0):
                yield Proposal(axis, way, rate, longest)
        warmer = soak_degC(inputs, longest, bench) if soaks else 0.0
        if warmer:
            for rate in (fast, 0.0):
                yield Proposal(axis, "up", rate, longest, warmer)


def _reached(rate_deg_s: float, duration_s: float, bench: Bench) -> float:
    """A rate within the table's limits, one that it reaches in a small part of a run."""
    table = bench.table
    if table.largest_rate_deg_s is not None:
        rate_deg_s = min(rate_deg_s, table.largest_rate_deg_s)
    if table.largest_acceleration_deg_s2 is not None:
        rate_deg_s = min(rate_deg_s, _SPIN_UP * duration_s * table.largest_acceleration_deg_s2)
    return float(f"{rate_deg_s:.3g}")


def lasting(proposal: Proposal, seconds: float, inputs: Sequence[RunInput], bench: Bench) -> Proposal:
    """The same for another time, within the bench's limits."""
    rate = float(np.copysign(_reached(abs(proposal.rate_deg_s), seconds, bench), proposal.rate_deg_s))
    warmer = soak_degC(inputs, seconds, bench) if proposal.soak_degC else 0.0
    return replace(proposal, rate_deg_s=rate, duration_s=seconds, soak_degC=warmer)


def soak_degC(inputs: Sequence[RunInput], duration_s: float, bench: Bench) -> float:
    """By how much a chamber warms the sensor in the first half of a run; 0 where that is no soak."""
    chamber = bench.chamber
    if chamber is None:
        return 0.0
    steepest = chamber.largest_slope_degC_per_min * duration_s / 2.0 / 60.0
    warmer = min(SOAK_DEGC, steepest, chamber.highest_degC - _start_degC(inputs))
    # rounded down: the slope is a limit
    return float(np.floor(warmer * 10.0) / 10.0) if warmer >= _LEAST_SOAK_DEGC else 0.0


def _start_degC(inputs: Sequence[RunInput]) -> float:
    today = inputs[0].scene.temperature
    return _ROOM_DEGC if today is None else round(float(today.sensor_degC[0]), 1)


def longest_s(inputs: Sequence[RunInput]) -> float:
    """Duration of today's longest run [s]."""
    return max(one.run.duration_s for one in inputs)


def is_warm(inputs: Sequence[RunInput]) -> bool:
    """Whether every run of today has a temperature log, so that the next should have one."""
    return all(one.scene.temperature is not None for one in inputs)


def temperature(inputs: Sequence[RunInput], proposal: Proposal) -> TemperatureLog | None:
    """The log that the run would have: a soak's, or a steady one where today's runs have logs."""
    if not (proposal.soak_degC or is_warm(inputs)):
        return None
    time_s = np.arange(np.ceil(proposal.duration_s) + 1.0)
    share = np.clip(2.0 * time_s / proposal.duration_s, 0.0, 1.0)
    return TemperatureLog(time_s, None, _start_degC(inputs) + proposal.soak_degC * share)


def temperature_text(log: TemperatureLog) -> str:
    """A log as temperature.csv has it."""
    rows = zip(log.time_s.tolist(), log.sensor_degC.tolist(), strict=True)
    return "time_s,sensor_degC\n" + "".join(f"{t:.6g},{s:.6g}\n" for t, s in rows)


def as_input(inputs: Sequence[RunInput], proposal: Proposal) -> RunInput:
    """The proposal as a run like those of today."""
    pattern = inputs[0]
    run = Run.from_data(run_document(pattern.run, proposal), "next run")
    facts = RunFacts.of_models(run, pattern.record)
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
