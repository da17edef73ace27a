"""Stage 4: Earth's rate taken away."""

from __future__ import annotations

from pathlib import Path

from fogreduce.progress import Progress, silent
from fogreduce.stages.dataset import StageDataset
from fogreduce.stages.files import open_writer, write_axis_rates
from fogreduce.stages.remove_earth import remove_earth
from fogreduce.stages.setup import Setup, TableAngle, seconds


def run(setup: Setup, run_dir: Path | None = None, progress: Progress = silent) -> None:
    """Earth's rate taken away; `run_dir` is read only where alpha comes from the encoder."""
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
