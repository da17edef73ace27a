"""The logs of a run, wherever they are: in files of their own, or as columns of the capture.

Columns of a capture are averaged over seconds (temperatures) or tenths of a second (angles), in one pass.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND
from fogreduce.datasets.logs import TableLog, TemperatureLog, read_table_log, read_temperature
from fogreduce.datasets.readers import open_capture
from fogreduce.errors import BadInput

Array = NDArray[np.float64]

_TEMPERATURES = ("electronics_temperature", "sensor_temperature")
_TEMPERATURE_BIN_S, _ANGLE_BIN_S = 1.0, 0.1
_RECORDS = 65536  # read at a time
_TURN_DEG = 360.0


def temperatures_of(folder: Path, run: Mapping[str, Any], start_us: int) -> TemperatureLog | None:
    """The temperatures of a run; None where there are none.

    Parameters
    ----------
    folder : Path
        The run's folder.
    run : mapping
        run.yaml, validated plain data.
    start_us : int
        The run's start, microseconds since 1970-01-01T00:00:00Z.
    """
    if run.get("temperature") is not None:
        return read_temperature(folder / run["temperature"])
    names = _named(run, _TEMPERATURES)
    if not names:
        return None
    time_s, means = _means(folder, run, start_us, names, _TEMPERATURE_BIN_S)
    found = dict(zip(names, means, strict=True))
    electronics = found.get("electronics_temperature")
    return TemperatureLog(time_s, electronics, found.get("sensor_temperature", means[0]))


def table_log_of(folder: Path, run: Mapping[str, Any], start_us: int) -> TableLog | None:
    """The encoder's log of a run; None where there is none. Columns that wrap at a turn go on."""
    if run.get("table_log") is not None:
        return read_table_log(folder / run["table_log"])
    names = _named(run, ("table_angle",))
    if not names:
        return None
    time_s, means = _means(folder, run, start_us, names, _ANGLE_BIN_S)
    return TableLog(time_s, means[0])


def _named(run: Mapping[str, Any], names: Sequence[str]) -> list[str]:
    columns = run["capture"].get("columns") or {}
    return [name for name in names if columns.get(name) is not None]


def _means(
    folder: Path, run: Mapping[str, Any], start_us: int, names: Sequence[str], bin_s: float
) -> tuple[Array, Array]:
    """Mean time and mean values of every bin that has any, (m,) and (k, m); angles unwrapped."""
    capture = run["capture"]
    path = folder / capture["file"]
    reader: Any = open_capture(path, capture, start_us)
    sums: dict[int, Array] = {}
    last: float | None = None
    for time_us, values in reader.log_columns(names, _RECORDS):
        time_s = time_us / MICROSECONDS_PER_SECOND
        if names == ["table_angle"]:
            values, last = _continuous(values, last)
        there = np.isfinite(values).all(axis=0)
        numbers = np.floor(time_s[there] / bin_s).astype(np.int64)
        bins, inverse = np.unique(numbers, return_inverse=True)
        rows = np.vstack((np.ones(numbers.size), time_s[there], values[:, there]))
        added = np.array([np.bincount(inverse, row, bins.size) for row in rows])
        for k, number in enumerate(bins.tolist()):
            sums[number] = sums.get(number, 0.0) + added[:, k]
    if not sums:
        raise BadInput.at(path, "", found=f"no value in {', '.join(names)}", expected="at least one")
    table = np.array([sums[number] for number in sorted(sums)])
    return table[:, 1] / table[:, 0], (table[:, 2:] / table[:, :1]).T


def _continuous(values: Array, last: float | None) -> tuple[Array, float | None]:
    """Angles [deg] (1, N) without steps of whole turns, going on from the last one before."""
    there = np.flatnonzero(np.isfinite(values[0]))
    if there.size == 0:
        return values, last
    found = values[0, there] if last is None else np.append(last, values[0, there])
    unwrapped = np.unwrap(found, period=_TURN_DEG)
    out = values.copy()
    out[0, there] = unwrapped[-there.size :]
    return out, float(unwrapped[-1])
