"""Stage 1: the capture's records, checked and flagged."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from fogreduce.datasets.readers import Reader, open_capture
from fogreduce.datasets.readers.contradictions import contradictions
from fogreduce.datasets.run_logs import table_log_of, temperatures_of
from fogreduce.datasets.store import DatasetWriter
from fogreduce.errors import BadInput, Fault
from fogreduce.plausibility.finding import Finding
from fogreduce.progress import Progress, silent
from fogreduce.stages.encoder import write_encoder_table
from fogreduce.stages.files import Logs, open_ingest_writer, write_ingest, write_json, write_logs
from fogreduce.stages.ingest import Ingest
from fogreduce.stages.look import look, write_warnings
from fogreduce.stages.setup import Setup, microseconds
from fogreduce.stages.tables import Cell, write_table


def run(setup: Setup, run_dir: Path, progress: Progress = silent) -> None:
    """The capture's records, checked and flagged."""
    reader = open_capture_of(setup, run_dir)
    ingest = Ingest(setup.facts, setup.parameters["outliers"]["threshold_sigma"])
    with ingest_writer(setup, run_dir, reader) as writer:
        for block in ingest.blocks(reader, setup.block_records):
            write_ingest(writer, block, setup.facts.raw_unit.variable)
            progress(block.start + block.time_us.size)
        report = ingest.report(reader)
        found = look(setup.facts, setup.manifest["run"], report, run_dir)
    finish_ingest(setup, run_dir, report, found)


def open_capture_of(setup: Setup, run_dir: Path) -> Reader:
    """The capture, held against run.yaml and the manifest."""
    run = setup.manifest["run"]
    path = run_dir / run["capture"]["file"]
    reader = open_capture(path, run["capture"], setup.facts.start_us)
    faults = contradictions(reader.facts, setup.facts, path)
    stated = next(item["bytes"] for item in setup.manifest["inputs"] if item["name"] == path.name)
    if (size := path.stat().st_size) != stated:
        faults.append(Fault(str(path), "", f"{size} bytes", f"{stated}, as the manifest has it"))
    if faults:
        raise BadInput(*faults)
    return reader


@contextmanager
def ingest_writer(setup: Setup, run_dir: Path, reader: Reader) -> Iterator[DatasetWriter]:
    """The dataset of ingest, the logs already in it."""
    logs = _read_logs(setup, run_dir)
    has_counts = reader.facts.least_count is not None and not setup.facts.is_increment
    with open_ingest_writer(setup, reader.n_records, has_counts, logs) as writer:
        write_logs(writer, logs)
        yield writer


def _read_logs(setup: Setup, run_dir: Path) -> Logs:
    """The logs of the run, checked line by line."""
    run, start_us = setup.manifest["run"], setup.facts.start_us
    logs: dict[str, NDArray[Any]] = {}
    faults: list[Fault] = []
    try:
        if (temperature := temperatures_of(run_dir, run, start_us)) is not None:
            logs["temperature_time"] = microseconds(temperature.time_s)
            if temperature.electronics_degC is not None:
                logs["electronics_temperature"] = temperature.electronics_degC
            logs["sensor_temperature"] = temperature.sensor_degC
    except BadInput as error:
        faults += error.faults
    try:
        if (table := table_log_of(run_dir, run, start_us)) is not None:
            logs["table_time"] = microseconds(table.time_s)
            logs["table_angle"] = table.angle_deg
    except BadInput as error:
        faults += error.faults
    if faults:
        raise BadInput(*faults)
    return logs


def finish_ingest(setup: Setup, run_dir: Path, ingested: Mapping[str, Any], found: list[Finding]) -> None:
    """Report and tables of the stage, once all records are read."""
    report = {"version_id": setup.version_id, **ingested}
    write_json(setup.out / "reports" / "ingest.json", report)
    rows: list[list[Cell]] = [
        [kind, report[kind] or 0, setup.version_id] for kind in ("records", "expected", "lost", "torn_bytes")
    ]
    rows += [[kind, count, setup.version_id] for kind, count in report["flagged"].items()]
    write_table(setup.table("quality"), ["what", "count", "version_id"], rows)
    write_warnings(setup, found)
    write_encoder_table(setup, run_dir)
