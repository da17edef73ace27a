"""The tables of a run read back, for who shows them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from fogreduce.physics.raw_quantity import RawUnit
from fogreduce.stages import encoder, look
from fogreduce.stages.budget import BUDGET_COLUMNS
from fogreduce.stages.drift import DRIFT_COLUMNS, RULE_COLUMNS
from fogreduce.stages.rates import RATES_COLUMNS
from fogreduce.stages.read_table import Row, read_table
from fogreduce.stages.tables import RATE_FIT_COLUMNS, gyro_fit_columns

#: Table -> its columns, which may depend on the unit of raw readings; a later version may have more.
COLUMNS: Mapping[str, Callable[[RawUnit], Sequence[str]]] = {
    "quality": lambda _: ("what", "count", "version_id"),
    "encoder": lambda _: encoder.COLUMNS,
    "warnings": lambda _: look.COLUMNS,
    "gyro_fit": gyro_fit_columns,
    "rate_fit": lambda _: RATE_FIT_COLUMNS,
    "unstable": lambda _: ("gyro", "start_s", "stop_s", "noise_ratio", "version_id"),
    "drift": lambda _: DRIFT_COLUMNS,
    "rates": lambda _: RATES_COLUMNS,
    "drift_by_records": lambda _: RULE_COLUMNS,
    "budget": lambda _: BUDGET_COLUMNS,
}
#: Tables that have a row of every run.
_NEVER_EMPTY = ("quality", "gyro_fit")
#: Tables that results of earlier versions do not have.
_MAY_BE_ABSENT = ("rates", "warnings", "drift_by_records", "budget")


def read_rows(results: Path, name: str, version_id: str, raw_unit: RawUnit) -> list[Row]:
    """Rows of a table, as text by column.

    Parameters
    ----------
    results : Path
        The run's results folder.
    name : str
        A key of `COLUMNS`.
    version_id : str
        The manifest's.
    raw_unit : RawUnit
        Of the run's raw readings.

    Raises
    ------
    BadInput
        See `read_table`.
    """
    path = results / "tables" / f"{name}.csv"
    if name in _MAY_BE_ABSENT and not path.exists():
        return []
    return read_table(path, COLUMNS[name](raw_unit), version_id, never_empty=name in _NEVER_EMPTY)
