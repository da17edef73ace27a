"""All stages of a run in one pass over its capture.

`fogreduce.stages.nodes` has them one after another, through files. Both hand the same blocks to the same
functions in the same order, so their tables are equal to the byte.
"""

from __future__ import annotations

from contextlib import ExitStack
from functools import partial
from pathlib import Path

from fogreduce.datasets.worker import Worker
from fogreduce.progress import Progress, silent
from fogreduce.stages.calibrate import calibrate
from fogreduce.stages.files import open_writer, write_axis_rates, write_gyro_rates, write_ingest
from fogreduce.stages.ingest import Ingest
from fogreduce.stages.look import look
from fogreduce.stages.nodes import drift
from fogreduce.stages.nodes.fit import finish_fit, fit_of
from fogreduce.stages.nodes.ingest import finish_ingest, ingest_writer, open_capture_of
from fogreduce.stages.nodes.project import projection_of
from fogreduce.stages.remove_earth import remove_earth
from fogreduce.stages.setup import Setup, TableAngle, seconds

_BLOCKS_AHEAD = 2


def reduce_run(setup: Setup, run_dir: Path, progress: Progress = silent) -> None:
    """All stages in one pass over the capture; `progress` is called with how many records are done."""
    facts = setup.facts
    reader = open_capture_of(setup, run_dir)
    angle = TableAngle(setup, run_dir)
    ingest = Ingest(facts, setup.parameters["outliers"]["threshold_sigma"])
    fit = fit_of(setup, reader.n_records)
    projection = projection_of(setup)
    with ExitStack() as stack:
        raw = stack.enter_context(ingest_writer(setup, run_dir, reader))
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
    finish_ingest(setup, run_dir, report, found)
    finish_fit(setup, fit)
    drift.run(setup)
