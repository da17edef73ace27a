"""The lazy view of a reduced run: every stage's dataset as one xarray Dataset.

xarray is imported here and nowhere else on the way of a reduction: its import alone costs a second.
"""

from __future__ import annotations

import os
from pathlib import Path

import h5py
import numpy as np
import xarray as xr
from numpy.typing import NDArray

from fogreduce.errors import BadInput

#: Stage -> what its variables are called in the view, where that is not what they are called in the file.
STAGES: dict[str, dict[str, str]] = {
    "ingest": {},
    "calibrate": {},
    "project": {"axis_rate": "axis_rate_with_earth"},
    "remove_earth": {},
}

#: The variables along the records, and those that a stage cannot do without.
_DIMENSIONS = {
    "time": ("time",),
    "pulse": ("time",),
    "flag": ("time",),
    "gyro_flag": ("gyro", "time"),
    "volts": ("gyro", "time"),
    "raw": ("gyro", "time"),
    "gyro_rate": ("gyro", "time"),
    "axis_rate": ("axis", "time"),
}
_NEEDED = {
    "ingest": ("time", "pulse", "flag", "gyro_flag", "volts"),
    "calibrate": ("time", "flag", "gyro_flag", "gyro_rate"),
    "project": ("time", "flag"),
    "remove_earth": ("time", "flag"),
}

_EXPECTED = "a run's results folder (as `fogreduce reduce --out` or the workflow leaves it)"


def open_run(path: str | os.PathLike[str]) -> xr.Dataset:
    """Open the results of a run, lazily: only the time stamps and labels are read at once.

    Parameters
    ----------
    path : path
        The run's results folder, for instance ``results/published/x-one-turn``.

    Returns
    -------
    xarray.Dataset
        Dimensions ``time`` (records, in file order), ``gyro`` and ``axis``; variables

        ======================== ============== ========== ==================================================
        ``volts``                (gyro, time)   V          raw volts; NaN = no answer; spurious ones stand
        ``raw``                  (gyro, time)   see attrs  in their place: raw readings in another unit
        ``pulse``                (time)         1          number of the stimulus pulse
        ``flag``                 (time)         bit mask   why a record is out of the ordinary (`RecordFlag`)
        ``gyro_flag``            (gyro, time)   bit mask   why a sample is (`GyroFlag`)
        ``gyro_rate``            (gyro, time)   degree s-1 rate about each input axis (eq. 1)
        ``axis_rate_with_earth`` (axis, time)   degree s-1 rate about x, y, z (eq. 2)
        ``axis_rate``            (axis, time)   degree s-1 the same, Earth's rate taken away (eq. 6)
        ======================== ============== ========== ==================================================

        and, where they were logged, ``electronics_temperature`` and ``sensor_temperature`` along
        ``temperature_time``, ``table_angle`` along ``table_time``.

        A unit of one or two gyros has no ``axis_rate`` and no ``axis_rate_with_earth``. ``time`` is UTC,
        exact to the microsecond, as stamped; a stamp that no calendar holds is NaT (its record is flagged
        ``bad_stamp``). Attributes are those of the datasets: version id, unit, calibration and so on.
        Close it, or use it in a ``with`` block, to close the files.

    Raises
    ------
    BadInput
        The folder holds no results of a run, or only some, or some of another version.
    """
    folder = Path(path)
    if not folder.is_dir():
        raise BadInput.at(
            folder, "", found="a file" if folder.exists() else "no such folder", expected=_EXPECTED
        )
    parts: dict[str, xr.Dataset] = {}
    try:
        for stage in STAGES:
            path = folder / "datasets" / f"{stage}.nc"
            parts[stage] = _open_stage(path)
            _as_written(path, parts[stage], _needed(stage, parts[stage]))
            _same_run(folder, parts, stage)
        view = _merged(parts)
        view.encoding["source"] = str(folder.resolve())
        return view
    except (AttributeError, KeyError, TypeError, ValueError) as error:
        # What a damaged attribute leads to, such as units of time that are no text.
        _close(parts)
        raise BadInput.at(folder, "", found=f"damage ({error})", expected=_EXPECTED) from None
    except BaseException:
        _close(parts)
        raise


def _open_stage(path: Path) -> xr.Dataset:
    if not path.is_file():
        raise BadInput.at(path, "", found="no such file", expected=f"a dataset of {_EXPECTED}")
    try:
        # First without h5netcdf, which complains on its own when it lets go of a file that it could not open.
        with h5py.File(path, "r") as file:
            for part in (file, *(file[name] for name in file)):
                dict(part.attrs)
        # Times are decoded below: a corrupt stamp must not make the other records unreadable.
        return xr.open_dataset(path, engine="h5netcdf", decode_times=False, phony_dims="access")
    except (OSError, RuntimeError, ValueError, KeyError, TypeError, AttributeError, LookupError) as error:
        raise BadInput.at(path, "", found=str(error), expected=f"a dataset of {_EXPECTED}") from None


def _needed(stage: str, part: xr.Dataset) -> tuple[str, ...]:
    """What a stage's dataset cannot do without; raw readings in another unit than volts are called `raw`."""
    in_volts = "raw" not in part.variables
    return tuple(name if in_volts or name != "volts" else "raw" for name in _NEEDED[stage])


def _as_written(path: Path, part: xr.Dataset, needed: tuple[str, ...]) -> None:
    """Refuse a dataset whose variables are missing, not numbers, or along other dimensions."""
    for name in dict.fromkeys((*needed, *_DIMENSIONS)):
        if name not in part.variables:
            if name in needed:
                raise BadInput.at(
                    path, name, found="no such variable", expected="one, as its stage writes it"
                )
            continue
        variable, dims = part.variables[name], _DIMENSIONS[name]
        if variable.dims != dims or variable.dtype.kind not in "iuf":
            found = f"{variable.dtype} along {', '.join(map(str, variable.dims)) or 'nothing'}"
            raise BadInput.at(path, name, found=found, expected=f"numbers along {', '.join(dims)}")


def _same_run(folder: Path, parts: dict[str, xr.Dataset], stage: str) -> None:
    """Refuse stages of different results, which a run interrupted in between can leave."""
    first, here = parts["ingest"], parts[stage]
    for name, found, expected in (
        ("version_id", here.attrs.get("version_id"), first.attrs.get("version_id")),
        ("time", here.sizes.get("time"), first.sizes.get("time")),
    ):
        if not isinstance(found, str | int) or not isinstance(expected, str | int) or found != expected:
            raise BadInput.at(
                folder / "datasets" / f"{stage}.nc",
                name,
                found=found,
                expected=f"{expected}, as in ingest.nc (reduce the run again)",
            )


def _merged(parts: dict[str, xr.Dataset]) -> xr.Dataset:
    variables: dict[str, xr.Variable] = {}
    coordinates: dict[str, xr.Variable] = {}
    for stage, names in STAGES.items():
        part = parts[stage]
        for name, variable in part.variables.items():
            if name in part.dims:
                coordinates.setdefault(str(name), variable)
            else:
                variables.setdefault(names.get(str(name), str(name)), variable)
    for name in ("time", "temperature_time", "table_time"):
        if name in coordinates:
            coordinates[name] = _decoded(coordinates[name])
    attributes = {key: value for key, value in parts["remove_earth"].attrs.items() if key != "left_out"}
    view = xr.Dataset(variables, coordinates, attributes)
    view.set_close(lambda: _close(parts))
    return view


def _close(parts: dict[str, xr.Dataset]) -> None:
    for part in parts.values():
        part.close()


def _decoded(time: xr.Variable) -> xr.Variable:
    """Stamps as datetime64[us], in whole numbers throughout."""
    attributes = dict(time.attrs)
    since = np.datetime64(attributes.pop("units").removeprefix("microseconds since ").replace(" ", "T"), "us")
    attributes.pop("calendar", None)
    return xr.Variable(time.dims, _instants(since, np.asarray(time.values, np.int64)), attributes)


def _instants(since: np.datetime64, stamps_us: NDArray[np.int64]) -> NDArray[np.datetime64]:
    """`since` plus stamps [us]; NaT where the sum does not fit."""
    start = int(since.astype(np.int64))
    latest = np.iinfo(np.int64).max - max(start, 0)
    earliest = np.iinfo(np.int64).min + 1 - min(start, 0)
    fits = (stamps_us >= earliest) & (stamps_us <= latest)
    instants: NDArray[np.datetime64] = (np.where(fits, stamps_us, 0) + start).astype("datetime64[us]")
    instants[~fits] = np.datetime64("NaT")
    return instants
