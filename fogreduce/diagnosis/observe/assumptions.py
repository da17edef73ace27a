"""What a diagnosis takes for granted because no file states it."""

from __future__ import annotations

from typing import Any

from fogreduce.diagnosis.observe.data import Data
from fogreduce.metadata.assumed import Assumed, assumed_of_record, assumed_of_run
from fogreduce.metadata.calibration import DEFAULT_NOISE

_WHITE = "noise.angle_random_walk_deg_sqrt_h"


def assumed(data: Data) -> list[dict[str, Any]]:
    """Every value that stands in for one not stated: file, key, value, reason, and the runs that it is for.

    White noise is that of the captures, one value [deg/sqrt(h)] a gyro, where they show it; all else
    is the default.
    """
    out = [_of(one, data.run_ids) for one in assumed_of_record(data.record)]
    for entry in out:
        if entry["key"] == _WHITE and data.found_white is not None:
            entry["value"] = [float(value) for value in data.found_white]
            entry["reason"] = "estimated from the captures: another level than theirs cannot be noticed"
        elif entry["key"] == _WHITE:
            default = DEFAULT_NOISE["angle_random_walk_deg_sqrt_h"]
            entry["reason"] = f"{default.reason}; the captures hold too few samples to estimate it"
    silent: dict[Assumed, list[str]] = {}
    for one in data.inputs:
        for item in assumed_of_run(one.run):
            silent.setdefault(item, []).append(one.facts.run_id)
    out += [_of(item, data.run_ids) for item in data.inputs[0].from_part]
    return out + [_of(item, runs) for item, runs in silent.items()]


def _of(item: Assumed, runs: list[str]) -> dict[str, Any]:
    return {"of": item.file, "key": item.key, "value": item.value, "reason": item.said, "runs": runs}
