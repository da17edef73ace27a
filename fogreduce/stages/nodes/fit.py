"""Stage 5: mean curves, bins, unstable intervals."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from fogreduce.progress import Progress, silent
from fogreduce.stages.dataset import StageDataset, ingested_blocks
from fogreduce.stages.files import write_bins, write_json
from fogreduce.stages.fit import Fit
from fogreduce.stages.fit_report import as_plain
from fogreduce.stages.setup import Setup, seconds
from fogreduce.stages.tables import RATE_FIT_COLUMNS, fit_rows, gyro_fit_columns, write_table


def run(setup: Setup, progress: Progress = silent) -> None:
    """Mean curves, bins, unstable intervals."""
    with StageDataset(setup, "ingest") as source, StageDataset(setup, "remove_earth") as reduced:
        fit = fit_of(setup, source.n_records)
        rates_by_block: Iterator[Any] = (
            (part["axis_rate"] for _, part in reduced.blocks(("axis_rate",)))
            if setup.axes
            else iter(lambda: None, 0)
        )
        for block, rates in zip(ingested_blocks(setup, source), rates_by_block, strict=False):
            fit.add(seconds(block.time_us), block.flag, block.gyro_flag, block.raw, rates)
            progress(block.start + block.time_us.size)
    finish_fit(setup, fit)


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


def finish_fit(setup: Setup, fit: Fit) -> None:
    """Datasets, report and tables of the stage, once all records are added."""
    bins = fit.bins()
    limits = setup.parameters["unstable"]
    unstable = fit.unstable(bins, limits["threshold"], limits["min_duration_s"])
    fits = {"version_id": setup.version_id, **as_plain(fit.fits(bins), unstable, fit.bin_s)}
    write_bins(setup, bins)
    write_json(setup.out / "reports" / "fit.json", fits)
    version = setup.version_id
    gyro_rows = fit_rows(fits, setup.gyros, ("coloured",), version)
    write_table(setup.table("gyro_fit"), gyro_fit_columns(setup.facts.raw_unit), gyro_rows)
    rate_rows = fit_rows(fits, setup.axes, ("coloured", "stated"), version)
    write_table(setup.table("rate_fit"), RATE_FIT_COLUMNS, rate_rows)
    write_table(
        setup.table("unstable"),
        ["gyro", "start_s", "stop_s", "noise_ratio", "version_id"],
        [
            [item["gyro"], item["start_s"], item["stop_s"], item["noise_ratio"], version]
            for item in fits["unstable"]
        ],
    )
