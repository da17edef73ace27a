"""The stages of a run: one after another through files (a node of the DAG each), or all in one pass.

Both ways hand the same blocks to the same functions in the same order, so their tables are equal to the byte.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from functools import partial
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from fogreduce.datasets.block import Block
from fogreduce.datasets.readers import Reader, open_capture
from fogreduce.datasets.readers.contradictions import contradictions
from fogreduce.datasets.run_logs import table_log_of, temperatures_of
from fogreduce.datasets.store import DatasetWriter
from fogreduce.datasets.worker import Worker
from fogreduce.errors import BadInput, Fault
from fogreduce.physics.quantization import raw_from_counts
from fogreduce.plausibility.finding import Finding
from fogreduce.stages import drift as drift_stage
from fogreduce.stages import encoder as encoder_stage
from fogreduce.stages import tables
from fogreduce.stages.budget import BUDGET_COLUMNS, CORRELATIONS_COLUMNS, budget_of
from fogreduce.stages.budget_dataset import write_budget
from fogreduce.stages.calibrate import calibrate
from fogreduce.stages.dataset import StageDataset
from fogreduce.stages.files import (
    Logs,
    open_ingest_writer,
    open_writer,
    read_report,
    write_axis_rates,
    write_bins,
    write_gyro_rates,
    write_ingest,
    write_json,
    write_logs,
)
from fogreduce.stages.fit import Fit
from fogreduce.stages.fit_report import as_plain
from fogreduce.stages.ingest import Ingest
from fogreduce.stages.look import look, write_warnings
from fogreduce.stages.project import Projection
from fogreduce.stages.rates import RATES_COLUMNS, rate_rows
from fogreduce.stages.remove_earth import remove_earth
from fogreduce.stages.setup import Setup, TableAngle, microseconds, seconds

Progress = Callable[[int], None]

_BLOCKS_AHEAD = 2


def _silent(records: int) -> None:
    """Progress that nobody wants to see."""


def reduce_run(setup: Setup, run_dir: Path, progress: Progress = _silent) -> None:
    """All stages in one pass over the capture; `progress` is told how many records are done."""
    facts = setup.facts
    reader = _open_capture(setup, run_dir)
    angle = TableAngle(setup, run_dir)
    ingest = Ingest(facts, setup.parameters["outliers"]["threshold_sigma"])
    fit = fit_of(setup, reader.n_records)
    projection = projection_of(setup)
    with ExitStack() as stack:
        raw = stack.enter_context(_ingest_writer(setup, run_dir, reader))
        gyro, axis, table = (
            stack.enter_context(open_writer(setup, stage, reader.n_records))
            for stage in ("calibrate", "project", "remove_earth")
        )
        # The fit goes on in a thread of its own while the next block is read, judged and projected.
        fitting = stack.enter_context(Worker(_BLOCKS_AHEAD))
        for block in ingest.blocks(reader, setup.block_records):
            write_ingest(raw, block, facts.raw_unit.variable)
            gyro_rates = calibrate(facts, block.raw)
            write_gyro_rates(gyro, block, gyro_rates)
            time_s = seconds(block.time_us)
            axis_rates = rates = None
            if setup.axes:
                axis_rates = projection.block(gyro_rates, block.gyro_flag, block.time_us)
                rates = remove_earth(facts, angle, time_s, axis_rates)
            write_axis_rates(axis, block.start, block.time_us, block.flag, axis_rates)
            write_axis_rates(table, block.start, block.time_us, block.flag, rates)
            fitting.do(partial(fit.add, time_s, block.flag, block.gyro_flag, block.raw, rates))
            progress(block.start + block.time_us.size)
        report = ingest.report(reader)
        found = look(facts, setup.manifest["run"], report, run_dir)
    _finish_ingest(setup, run_dir, report, found)
    _finish_fit(setup, fit)
    run_drift(setup)


def run_ingest(setup: Setup, run_dir: Path, progress: Progress = _silent) -> None:
    """Stage 1: the capture's records, judged and flagged."""
    reader = _open_capture(setup, run_dir)
    ingest = Ingest(setup.facts, setup.parameters["outliers"]["threshold_sigma"])
    with _ingest_writer(setup, run_dir, reader) as writer:
        for block in ingest.blocks(reader, setup.block_records):
            write_ingest(writer, block, setup.facts.raw_unit.variable)
            progress(block.start + block.time_us.size)
        report = ingest.report(reader)
        found = look(setup.facts, setup.manifest["run"], report, run_dir)
    _finish_ingest(setup, run_dir, report, found)


def run_calibrate(setup: Setup, progress: Progress = _silent) -> None:
    """Stage 2: raw readings to rates about the gyros' axes."""
    with (
        StageDataset(setup, "ingest") as source,
        open_writer(setup, "calibrate", source.n_records) as writer,
    ):
        for block in _ingested(setup, source):
            write_gyro_rates(writer, block, calibrate(setup.facts, block.raw))
            progress(block.start + block.time_us.size)


def run_project(setup: Setup, progress: Progress = _silent) -> None:
    """Stage 3: rates about the gyros' axes to rates about x, y, z."""
    projection = projection_of(setup)
    with (
        StageDataset(setup, "calibrate") as source,
        open_writer(setup, "project", source.n_records) as writer,
    ):
        for start, part in source.blocks(("time", "gyro_rate", "flag", "gyro_flag")):
            rates = None
            if setup.axes:
                rates = projection.block(part["gyro_rate"], part["gyro_flag"], part["time"])
            write_axis_rates(writer, start, part["time"], part["flag"], rates)
            progress(start + part["time"].size)


def run_remove_earth(setup: Setup, run_dir: Path | None = None, progress: Progress = _silent) -> None:
    """Stage 4: Earth's rate taken away; `run_dir` is read only where alpha comes from the encoder."""
    angle = TableAngle(setup, run_dir)
    with (
        StageDataset(setup, "project") as source,
        open_writer(setup, "remove_earth", source.n_records) as writer,
    ):
        names = ("time", "axis_rate", "flag") if setup.axes else ("time", "flag")
        for start, part in source.blocks(names):
            rates = None
            if setup.axes:
                rates = remove_earth(setup.facts, angle, seconds(part["time"]), part["axis_rate"])
            write_axis_rates(writer, start, part["time"], part["flag"], rates)
            progress(start + part["time"].size)


def run_fit(setup: Setup, progress: Progress = _silent) -> None:
    """Stage 5: mean curves, bins, unstable intervals."""
    with StageDataset(setup, "ingest") as source, StageDataset(setup, "remove_earth") as reduced:
        fit = fit_of(setup, source.n_records)
        rates_by_block: Iterator[Any] = (
            (part["axis_rate"] for _, part in reduced.blocks(("axis_rate",)))
            if setup.axes
            else iter(lambda: None, 0)
        )
        for block, rates in zip(_ingested(setup, source), rates_by_block, strict=False):
            fit.add(seconds(block.time_us), block.flag, block.gyro_flag, block.raw, rates)
            progress(block.start + block.time_us.size)
    _finish_fit(setup, fit)


def run_drift(setup: Setup, progress: Progress = _silent) -> None:
    """Stage 6: the paper's offset rule and the integration; over at once, whatever the record's length."""
    fits = read_report(setup, "fit")
    complete_records = setup.complete_records
    try:
        budget = budget_of(setup.facts, setup.stated_errors, fits, setup.gyros, setup.axes)
        rows = drift_stage.drift_rows(setup.facts, fits, setup.axes, budget, setup.version_id)
        rules = drift_stage.rule_rows(fits, setup.axes, complete_records, setup.version_id)
        rates = rate_rows(setup.facts, setup.stated_errors, fits, setup.axes, budget, setup.version_id)
        parts = budget.rows(setup.version_id), budget.correlation_rows(setup.version_id)
    except (KeyError, TypeError, ValueError, IndexError, AttributeError) as error:
        path = setup.out / "reports" / "fit.json"
        found = f"damage ({type(error).__name__}: {error})"
        raise BadInput.at(path, "", found=found, expected="the report as stage fit writes it") from None
    tables.write_table(setup.table("drift"), drift_stage.DRIFT_COLUMNS, rows)
    tables.write_table(setup.table("rates"), RATES_COLUMNS, rates)
    tables.write_table(setup.table("drift_by_records"), drift_stage.RULE_COLUMNS, rules)
    tables.write_table(setup.table("budget"), BUDGET_COLUMNS, parts[0])
    tables.write_table(setup.table("correlations"), CORRELATIONS_COLUMNS, parts[1])
    write_budget(setup, budget)


def _open_capture(setup: Setup, run_dir: Path) -> Reader:
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
def _ingest_writer(setup: Setup, run_dir: Path, reader: Reader) -> Iterator[DatasetWriter]:
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


def _ingested(setup: Setup, source: StageDataset) -> Iterator[Block]:
    """The blocks that ingest wrote."""
    has_counts = source.has_counts()
    variable = setup.facts.raw_unit.variable
    for start, part in source.blocks(("time", "pulse", variable, "flag", "gyro_flag")):
        stored = part[variable]
        raw = raw_from_counts(stored, setup.facts.least_count) if has_counts else stored
        counts = stored if has_counts else None
        yield Block(start, part["time"], part["pulse"], part["flag"], part["gyro_flag"], counts, raw)


def fit_of(setup: Setup, n_records: int) -> Fit:
    """The fit of a run, nothing added to it yet."""
    return Fit(
        setup.facts,
        setup.gyros + setup.axes,
        n_records,
        setup.block_records,
        setup.stated_errors,
        setup.parameters["edge_guard_s"],
        setup.complete_records,
    )


def projection_of(setup: Setup) -> Projection:
    """The projection of a run, no block of it seen yet."""
    return Projection(setup.facts, setup.complete_records)


def _finish_ingest(setup: Setup, run_dir: Path, ingested: Mapping[str, Any], found: list[Finding]) -> None:
    report = {"version_id": setup.version_id, **ingested}
    write_json(setup.out / "reports" / "ingest.json", report)
    rows: list[list[tables.Cell]] = [
        [kind, report[kind] or 0, setup.version_id] for kind in ("records", "expected", "lost", "torn_bytes")
    ]
    rows += [[kind, count, setup.version_id] for kind, count in report["flagged"].items()]
    tables.write_table(setup.table("quality"), ["what", "count", "version_id"], rows)
    write_warnings(setup, found)
    encoder_stage.write_encoder_table(setup, run_dir)


def _finish_fit(setup: Setup, fit: Fit) -> None:
    bins = fit.bins()
    limits = setup.parameters["unstable"]
    unstable = fit.unstable(bins, limits["threshold"], limits["min_duration_s"])
    fits = {"version_id": setup.version_id, **as_plain(fit.fits(bins), unstable, fit.bin_s)}
    write_bins(setup, bins)
    write_json(setup.out / "reports" / "fit.json", fits)
    version = setup.version_id
    gyro_rows = tables.fit_rows(fits, setup.gyros, ("coloured",), version)
    tables.write_table(setup.table("gyro_fit"), tables.gyro_fit_columns(setup.facts.raw_unit), gyro_rows)
    rate_rows = tables.fit_rows(fits, setup.axes, ("coloured", "stated"), version)
    tables.write_table(setup.table("rate_fit"), tables.RATE_FIT_COLUMNS, rate_rows)
    tables.write_table(
        setup.table("unstable"),
        ["gyro", "start_s", "stop_s", "noise_ratio", "version_id"],
        [
            [item["gyro"], item["start_s"], item["stop_s"], item["noise_ratio"], version]
            for item in fits["unstable"]
        ],
    )


STAGES: dict[str, Callable[..., None]] = {
    "ingest": run_ingest,
    "calibrate": run_calibrate,
    "project": run_project,
    "remove_earth": run_remove_earth,
    "fit": run_fit,
    "drift": run_drift,
}
