"""Stage 3: rates about the gyros' axes to rates about x, y, z."""

from __future__ import annotations

from fogreduce.progress import Progress, silent
from fogreduce.stages.dataset import StageDataset
from fogreduce.stages.files import open_writer, write_axis_rates
from fogreduce.stages.project import Projection
from fogreduce.stages.setup import Setup


def run(setup: Setup, progress: Progress = silent) -> None:
    """Rates about the gyros' axes to rates about x, y, z."""
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


def projection_of(setup: Setup) -> Projection:
    """The projection of a run, no block of it seen yet."""
    return Projection(setup.facts, setup.complete_records)
