"""The lazy view of a campaign: every reduced run along one dimension, read where it is looked at."""

from __future__ import annotations

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import DTypeLike
from xarray.backends import BackendArray
from xarray.core import indexing

from fogreduce.datasets.view import open_run
from fogreduce.errors import BadInput

#: What stands for records that a run does not have, by kind of number.
_FILL: Mapping[str, Any] = {"f": np.nan, "M": np.datetime64("NaT"), "u": 0, "i": 0}


@dataclass(frozen=True)
class _Run:
    """A reduced run: folder, name and number of records."""

    folder: Path
    name: str
    records: int


class _Stacked(BackendArray):
    """One variable of all runs, (run, ..., record); a run's files are open only while it is read."""

    def __init__(self, runs: list[_Run], name: str, inner: tuple[int, ...], dtype: DTypeLike) -> None:
        self.runs, self.name = runs, name
        self.dtype = np.dtype(dtype)
        self.shape = (len(runs), *inner, max(run.records for run in runs))

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, self._read)

    def _read(self, key: tuple[Any, ...]) -> np.ndarray[Any, Any]:
        chosen = np.atleast_1d(np.arange(len(self.runs))[key[0]])
        parts = [self._run(self.runs[k], key[1:]) for k in chosen]
        return parts[0] if np.ndim(key[0]) == 0 and not isinstance(key[0], slice) else np.stack(parts)

    def _run(self, run: _Run, key: tuple[Any, ...]) -> np.ndarray[Any, Any]:
        """One run's part: records that it has are read, the others filled."""
        *inner, records = key
        wanted = np.arange(self.shape[-1])[records]
        has = np.atleast_1d(wanted) < run.records
        with open_run(run.folder) as view:
            variable = view[self.name].variable
            there = np.atleast_1d(wanted)[has]
            part = slice(int(there.min()), int(there.max()) + 1) if there.size else slice(0, 0)
            read = variable[(*inner, part)].values[..., there - part.start]
        found = np.full((*read.shape[:-1], has.size), _FILL[self.dtype.kind], self.dtype)
        found[..., has] = read
        return found[..., 0] if np.ndim(wanted) == 0 else found


def open_campaign(path: str | os.PathLike[str]) -> xr.Dataset:
    """Open the results of a campaign, lazily: its runs along the dimension ``run``.

    Parameters
    ----------
    path : path
        The campaign's results folder, for instance ``results/published``, with a folder for each run.

    Returns
    -------
    xarray.Dataset
        The variables that all runs have (see `open_run`), with the dimensions ``run``, ``gyro`` or
        ``axis``, and ``record``, which goes up to the longest run; beyond a run's ``records``, numbers are
        NaN, times NaT and flags 0. ``time`` is (run, record). Nothing but labels is read until it is asked
        for, and no file stays open.

    Raises
    ------
    BadInput
        No reduced run in the folder, results that are damaged, or runs of units with other gyros.
    """
    folder = Path(path)
    if not folder.is_dir():
        found = "a file" if folder.exists() else "no such folder"
        raise BadInput.at(folder, "", found=found, expected="a campaign's results folder")
    inside = sorted(entry for entry in folder.iterdir() if entry.name[0] not in "._")
    folders = [entry for entry in inside if (entry / "manifest.json").is_file()]
    if not folders:
        raise BadInput.at(folder, "", found="no reduced run", expected="a folder for each, with its manifest")
    runs: list[_Run] = []
    first: xr.Dataset | None = None
    shared: dict[str, xr.Variable] = {}
    versions = []
    for entry in folders:
        with open_run(entry) as view:
            runs.append(_Run(entry, entry.name, view.sizes["time"]))
            versions.append(view.attrs["version_id"])
            if first is None:
                first, shared = view, {str(name): one for name, one in view.variables.items()}
                labels = {name: view[name].values for name in ("gyro", "axis") if name in view.coords}
                attributes = {
                    name: view.attrs[name] for name in ("campaign", "unit", "comment") if name in view.attrs
                }
            elif not np.array_equal(view["gyro"].values, labels["gyro"]):
                found = ", ".join(map(str, view["gyro"].values))
                raise BadInput.at(entry, "gyro", found=found, expected=", ".join(map(str, labels["gyro"])))
            shared = {name: one for name, one in shared.items() if name in view.variables}
    variables = {}
    for name, one in shared.items():
        if not one.dims or one.dims[-1] != "time":
            continue
        inner = one.dims[:-1]
        stacked = _Stacked(runs, str(name), tuple(labels[str(dim)].size for dim in inner), one.dtype)
        lazy = indexing.LazilyIndexedArray(stacked)
        variables[name] = xr.Variable(("run", *inner, "record"), lazy, one.attrs)
    time = variables.pop("time")
    variables["records"] = xr.Variable(("run",), [run.records for run in runs], {"units": "1"})
    coordinates = {"run": [run.name for run in runs], **labels, "version_id": ("run", versions)}
    return xr.Dataset(variables, {**coordinates, "time": time}, attributes)
