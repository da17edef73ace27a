"""The files of a run's results: each stage's dataset opened for writing, and reports."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets import templates
from fogreduce.datasets.atomic import write_text
from fogreduce.datasets.block import Block
from fogreduce.datasets.store import DatasetWriter
from fogreduce.errors import BadInput
from fogreduce.estimate.bins import Bins
from fogreduce.metadata.words import kind_of
from fogreduce.stages.dataset import problem_of
from fogreduce.stages.setup import Setup, microseconds

Array = NDArray[np.float64]

#: Variables of the logs beside a capture, see `templates.log_variables`.
Logs = Mapping[str, NDArray[Any]]


def open_ingest_writer(setup: Setup, n_records: int, has_counts: bool, logs: Logs) -> DatasetWriter:
    """The dataset of ingest, to be written block by block, and the logs beside the capture with it."""
    facts = setup.facts
    sizes = {"time": n_records, "gyro": facts.n_gyros}
    sizes |= {name: values.size for name, values in logs.items() if name.endswith("_time")}
    variables = templates.ingest_variables(facts, has_counts=has_counts)
    variables += templates.log_variables(facts, logs)
    return DatasetWriter(
        setup.dataset("ingest"), sizes, {"gyro": setup.gyros}, variables, setup.attributes, setup.storage
    )


def open_writer(setup: Setup, stage: str, n_records: int) -> DatasetWriter:
    """The dataset of a stage after ingest, to be written block by block."""
    facts = setup.facts
    sizes, coordinates = {"time": n_records}, {}
    if stage == "calibrate":
        sizes["gyro"], coordinates["gyro"] = facts.n_gyros, setup.gyros
        variables = templates.calibrate_variables(facts)
    else:
        make = templates.project_variables if stage == "project" else templates.remove_earth_variables
        variables = make(facts)
        if setup.axes:
            sizes["axis"], coordinates["axis"] = 3, setup.axes
        else:
            variables = [variable for variable in variables if "axis" not in variable.dims]
    attributes = setup.attributes
    if not setup.axes and stage in ("project", "remove_earth"):
        attributes["left_out"] = "axis_rate: a unit of one or two gyros gives no x, y, z"
    return DatasetWriter(setup.dataset(stage), sizes, coordinates, variables, attributes, setup.storage)


def write_logs(writer: DatasetWriter, logs: Logs) -> None:
    """The logs beside the capture, whole."""
    for name, values in logs.items():
        writer.write(name, 0, values)


def write_ingest(writer: DatasetWriter, block: Block, raw_variable: str) -> None:
    """A block as ingest leaves it; `raw_variable` names the readings."""
    writer.write("time", block.start, block.time_us)
    writer.write("pulse", block.start, block.pulse)
    writer.write(raw_variable, block.start, block.raw if block.counts is None else block.counts)
    writer.write("flag", block.start, block.flag)
    writer.write("gyro_flag", block.start, block.gyro_flag)


def write_gyro_rates(writer: DatasetWriter, block: Block, rates: Array) -> None:
    """A block as calibrate leaves it."""
    writer.write("time", block.start, block.time_us)
    writer.write("gyro_rate", block.start, rates)
    writer.write("flag", block.start, block.flag)
    writer.write("gyro_flag", block.start, block.gyro_flag)


def write_axis_rates(
    writer: DatasetWriter,
    start: int,
    time_us: NDArray[np.int64],
    flag: NDArray[np.uint8],
    rates: Array | None,
) -> None:
    """A block as project and remove_earth leave it; `rates` None for a unit of one or two gyros."""
    writer.write("time", start, time_us)
    if rates is not None:
        writer.write("axis_rate", start, rates)
    writer.write("flag", start, flag)


def write_bins(setup: Setup, bins: Bins) -> None:
    """Dataset ``bins``: the run in some thousand bins, for figures and for a quick look."""
    n = setup.facts.n_gyros
    sizes, coordinates = {"time": bins.time_s.size, "gyro": n}, {"gyro": setup.gyros}
    if setup.axes:
        sizes["axis"], coordinates["axis"] = 3, setup.axes
    variables = templates.bin_variables(setup.facts)
    channels = {setup.facts.raw_unit.variable: slice(0, n), "axis_rate": slice(n, n + 3)}
    with DatasetWriter(
        setup.dataset("bins"), sizes, coordinates, variables, setup.attributes, setup.storage
    ) as writer:
        writer.write("time", 0, microseconds(bins.time_s))
        for variable in variables[1:]:
            family, _, kind = variable.name.rpartition("_")
            writer.write(variable.name, 0, getattr(bins, kind)[channels[family]])


def write_json(path: Path, data: Mapping[str, Any]) -> None:
    """A report, keys in the order given."""
    write_text(path, json.dumps(data, indent=1, allow_nan=False) + "\n")


def read_report(setup: Setup, name: str) -> dict[str, Any]:
    """A report written by an earlier stage, of the version that the manifest names."""
    path = setup.out / "reports" / f"{name}.json"
    data = read_json(path)
    if (found := data.get("version_id")) != setup.version_id:
        expected = f"{setup.version_id}, as the manifest has it"
        raise BadInput.at(path, "version_id", found=found, expected=expected)
    return data


def read_json(path: Path) -> dict[str, Any]:
    """A report written by an earlier stage."""
    try:
        data: dict[str, Any] = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        found = problem_of(path, error) if isinstance(error, OSError) else str(error)
        raise BadInput.at(path, "", found=found, expected="the report of an earlier stage") from None
    if not isinstance(data, dict):
        raise BadInput.at(path, "", found=kind_of(data), expected="the report of an earlier stage")
    return data
