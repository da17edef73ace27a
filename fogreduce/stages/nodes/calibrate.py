"""Stage 2: raw readings to rates about the gyros' axes."""

from __future__ import annotations

from fogreduce.progress import Progress, silent
from fogreduce.stages.calibrate import calibrate
from fogreduce.stages.dataset import StageDataset, ingested_blocks
from fogreduce.stages.files import open_writer, write_gyro_rates
from fogreduce.stages.setup import Setup


def run(setup: Setup, progress: Progress = silent) -> None:
    """Raw readings to rates about the gyros' axes."""
    with (
        StageDataset(setup, "ingest") as source,
        open_writer(setup, "calibrate", source.n_records) as writer,
    ):
        for block in ingested_blocks(setup, source):
            write_gyro_rates(writer, block, calibrate(setup.facts, block.raw))
            progress(block.start + block.time_us.size)
