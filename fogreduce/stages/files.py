"""The files of a run's results: each stage's dataset opened for writing, and read again in blocks."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets import templates
from fogreduce.datasets.atomic import write_text
from fogreduce.datasets.block import Block
from fogreduce.datasets.store import DatasetWriter
from fogreduce.errors import BadInput
from fogreduce.estimate.bins import Bins
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


def write_ingest(writer: DatasetWriter, block: Block) -> None:
    """A block as ingest leaves it."""
    writer.write("time", block.start, block.time_us)
    writer.write("pulse", block.start, block.pulse)
    writer.write("volts", block.start, block.volts if block.counts is None else block.counts)
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


class StageDataset:
    """A stage's dataset, read in the blocks in which it was written.

    Parameters
    ----------
    setup : Setup
    stage : str
        Whose dataset.
    """

    def __init__(self, setup: Setup, stage: str) -> None:
        self.path = setup.dataset(stage)
        self._size = setup.block_records
        try:
            self._file = h5py.File(self.path, "r")
        except OSError as error:
            expected = f"the dataset of stage {stage}"
            raise BadInput.at(self.path, "", found=_problem(self.path, error), expected=expected) from None
        found_id = self._file.attrs.get("version_id")
        if found_id != setup.version_id:
            self._file.close()
            raise BadInput.at(
                self.path,
                "version_id",
                found=found_id,
                expected=f"{setup.version_id}, as the manifest has it",
            )
        self.n_records = int(self._variable("time").shape[0])

    def _variable(self, name: str) -> h5py.Dataset:
        if name not in self._file:
            self._file.close()
            raise BadInput.at(
                self.path, name, found="no such variable", expected="one, as its stage writes it"
            )
        return self._file[name]

    def __enter__(self) -> StageDataset:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def __contains__(self, name: str) -> bool:
        return name in self._file

    def has_counts(self) -> bool:
        """Whether raw volts are packed counts."""
        return bool(self._variable("volts").dtype == np.int32)

    def blocks(self, names: Sequence[str]) -> Iterator[tuple[int, dict[str, NDArray[Any]]]]:
        """Index of the first record, and the named variables' values, block by block."""
        variables = {name: self._variable(name) for name in names}
        for start in range(0, self.n_records, self._size):
            part = slice(start, min(start + self._size, self.n_records))
            yield start, {name: variable[..., part] for name, variable in variables.items()}


def write_bins(setup: Setup, bins: Bins) -> None:
    """Dataset ``bins``: the run in some thousand bins, for figures and for a quick look."""
    n = setup.facts.n_gyros
    families = [("volts", "gyro", "V", slice(0, n))]
    sizes, coordinates = {"time": bins.time_s.size, "gyro": n}, {"gyro": setup.gyros}
    if setup.axes:
        families.append(("axis_rate", "axis", "degree s-1", slice(n, n + 3)))
        sizes["axis"], coordinates["axis"] = 3, setup.axes
    time = templates.time_variable(setup.facts)
    variables, values = [time], {"time": microseconds(bins.time_s)}
    for name, dim, units, part in families:
        for kind, long_name in _BIN_KINDS.items():
            attributes = {"long_name": f"{long_name}, {name}", "units": "1" if kind == "count" else units}
            variables.append(templates.Variable(f"{name}_{kind}", (dim, "time"), "<f8", attributes))
            values[f"{name}_{kind}"] = getattr(bins, kind)[part]
    with DatasetWriter(
        setup.dataset("bins"), sizes, coordinates, variables, setup.attributes, setup.storage
    ) as writer:
        for name, array in values.items():
            writer.write(name, 0, array)


_BIN_KINDS = {
    "mean": "mean of usable values in the bin",
    "scatter": "standard deviation of usable values about the bin's mean",
    "lowest": "lowest of all values in the bin",
    "highest": "highest of all values in the bin",
    "count": "usable values in the bin",
}


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
    except (OSError, ValueError) as error:
        found = _problem(path, error) if isinstance(error, OSError) else str(error)
        raise BadInput.at(path, "", found=found, expected="the report of an earlier stage") from None
    return data


def _problem(path: Path, error: OSError) -> str:
    """Why a file could not be opened, in words: HDF5's own message is long and names its internals."""
    if not path.exists():
        return "no such file"
    if path.is_dir():
        return "a folder"
    if error.errno is not None:
        return os.strerror(error.errno)
    return "a truncated file" if "truncated file" in str(error) else "a file that is not HDF5"
