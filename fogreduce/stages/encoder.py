"""The encoder's log, where there is one, compared with the command: table ``encoder.csv``."""

from __future__ import annotations

from pathlib import Path

from fogreduce.datasets.run_logs import table_log_of
from fogreduce.estimate.encoder import compare_with_command
from fogreduce.stages.setup import Setup
from fogreduce.stages.tables import write_table

COLUMNS = (
    *("segment", "commanded_deg_s", "rate_deg_s", "rate_err_deg_s", "lag_s", "lag_err_s"),
    *("ripple_deg", "ripple_harmonic", "scatter_deg", "rows", "version_id"),
)


def write_encoder_table(setup: Setup, run_dir: Path) -> None:
    """Lag, rate and ripple of each segment; header only where the run has no encoder log."""
    log = table_log_of(run_dir, setup.manifest["run"], setup.facts.start_us)
    segments = []
    if log is not None:
        guard = setup.parameters["edge_guard_s"]
        segments = compare_with_command(log.time_s, log.angle_deg, setup.facts.profile, guard)
    write_table(
        setup.table("encoder"),
        COLUMNS,
        [
            [
                item.number,
                item.commanded_deg_s,
                item.rate_deg_s,
                item.rate_err_deg_s,
                item.lag_s,
                item.lag_err_s,
                item.ripple_deg,
                item.ripple_harmonic or None,
                item.scatter_deg,
                item.rows,
                setup.version_id,
            ]
            for item in segments
        ],
    )
