"""What stands in the dataset of each stage: dimensions, variables, units and CF attributes.

Every dataset carries ``time`` in whole microseconds since the run's start, exactly as stamped.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from fogreduce.constants import MISSING_COUNT
from fogreduce.datasets.flags import GyroFlag, RecordFlag, cf_attributes
from fogreduce.metadata.facts import RunFacts
from fogreduce.units import instant_of

Attributes = Mapping[str, object]


@dataclass(frozen=True)
class Variable:
    """One variable of a dataset: its dimensions by name, its type on disk and its attributes."""

    name: str
    dims: tuple[str, ...]
    dtype: str
    attributes: Attributes = field(default_factory=dict)


def time_variable(facts: RunFacts, dim: str = "time", of: str = "record") -> Variable:
    """Time stamps along `dim`, as int64 microseconds that CF readers turn into exact datetimes."""
    start = instant_of(facts.start_us).replace(tzinfo=None).isoformat(sep=" ", timespec="microseconds")
    return Variable(
        dim,
        (dim,),
        "<i8",
        {
            "standard_name": "time",
            "long_name": f"time stamp of the {of}",
            "units": f"microseconds since {start}",
            "calendar": "proleptic_gregorian",
        },
    )


RECORD_FLAG = Variable(
    "flag",
    ("time",),
    "|u1",
    {"long_name": "why a record is out of the ordinary", **cf_attributes(RecordFlag)},
)
GYRO_FLAG = Variable(
    "gyro_flag",
    ("gyro", "time"),
    "|u1",
    {"long_name": "why a sample is out of the ordinary", **cf_attributes(GyroFlag)},
)


def ingest_variables(facts: RunFacts, *, has_counts: bool) -> list[Variable]:
    """Raw readings as they stand in the capture (packed counts where it holds counts) and their flags."""
    unit = facts.raw_unit
    described = {"long_name": f"raw {unit.quantity} of each gyro", "units": unit.cf}
    if has_counts:
        packing = {
            "scale_factor": np.float64(facts.least_count),
            "_FillValue": np.int32(MISSING_COUNT),
        }
        raw = Variable(unit.variable, ("gyro", "time"), "<i4", {**described, **packing})
    else:
        raw = Variable(unit.variable, ("gyro", "time"), "<f8", described)
    pulse = Variable("pulse", ("time",), "<i8", {"long_name": "number of the stimulus pulse", "units": "1"})
    return [time_variable(facts), pulse, raw, RECORD_FLAG, GYRO_FLAG]


def log_variables(facts: RunFacts, logs: Mapping[str, object]) -> list[Variable]:
    """Temperatures and encoder angle beside the capture, as logged; those of the names in `logs`."""
    described = {
        "electronics_temperature": ("temperature_time", "temperature of the electronics", "degree_Celsius"),
        "sensor_temperature": ("temperature_time", "temperature of the sensors", "degree_Celsius"),
        "table_angle": ("table_time", "angle turned about the table's axis, by its encoder", "degree"),
    }
    variables = [
        time_variable(facts, dim, "log's row") for dim in ("temperature_time", "table_time") if dim in logs
    ]
    variables += [
        Variable(name, (dim,), "<f8", {"long_name": long_name, "units": units})
        for name, (dim, long_name, units) in described.items()
        if name in logs
    ]
    return variables


def calibrate_variables(facts: RunFacts) -> list[Variable]:
    """Rates about the gyros' input axes."""
    rate = Variable(
        "gyro_rate",
        ("gyro", "time"),
        "<f8",
        {"long_name": "rate about each gyro's input axis (eq. 1)", "units": "degree s-1"},
    )
    return [time_variable(facts), rate, RECORD_FLAG, GYRO_FLAG]


def project_variables(facts: RunFacts) -> list[Variable]:
    """Rates about x, y, z, Earth's part in them."""
    return [
        time_variable(facts),
        _axis_rate("rates about x, y, z (eq. 2), Earth's rate in them"),
        RECORD_FLAG,
    ]


def remove_earth_variables(facts: RunFacts) -> list[Variable]:
    """Rates about x, y, z with Earth's part taken away."""
    return [
        time_variable(facts),
        _axis_rate("rates about x, y, z, Earth's rate taken away (eq. 6)"),
        RECORD_FLAG,
    ]


def _axis_rate(long_name: str) -> Variable:
    return Variable("axis_rate", ("axis", "time"), "<f8", {"long_name": long_name, "units": "degree s-1"})


_BIN_KINDS = {
    "mean": "mean of usable values in the bin",
    "scatter": "standard deviation of usable values about the bin's mean",
    "lowest": "lowest of all values in the bin",
    "highest": "highest of all values in the bin",
    "count": "usable values in the bin",
}


def bin_variables(facts: RunFacts) -> list[Variable]:
    """The run in some thousand bins: raw readings and, where there are any, rates about x, y, z."""
    families = [(facts.raw_unit.variable, "gyro", facts.raw_unit.cf)]
    if facts.projection is not None:
        families.append(("axis_rate", "axis", "degree s-1"))
    variables = [time_variable(facts)]
    for name, dim, units in families:
        for kind, long_name in _BIN_KINDS.items():
            attributes = {"long_name": f"{long_name}, {name}", "units": "1" if kind == "count" else units}
            variables.append(Variable(f"{name}_{kind}", (dim, "time"), "<f8", attributes))
    return variables


def variables_of(stage: str, facts: RunFacts, *, has_counts: bool) -> dict[str, Variable]:
    """What stands along the records in the dataset of a stage, by name."""
    makers = {
        "calibrate": calibrate_variables,
        "project": project_variables,
        "remove_earth": remove_earth_variables,
        "bins": bin_variables,
    }
    made = ingest_variables(facts, has_counts=has_counts) if stage == "ingest" else makers[stage](facts)
    return {variable.name: variable for variable in made}
