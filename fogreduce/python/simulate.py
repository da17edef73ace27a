"""`fogreduce.simulate`: the captures of a campaign, by the forward physics."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fogreduce.constants import MICROSECONDS_PER_SECOND, MISSING_COUNT
from fogreduce.datasets.readers import open_capture
from fogreduce.datasets.sole_writer import sole_writer
from fogreduce.simulate.campaign import write_campaign
from fogreduce.simulate.plan import Options, Plan, prepare

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

Folder = str | os.PathLike[str]

_BLOCK = 1 << 16
_POINTS = 2000


@dataclass(frozen=True)
class Simulation:
    """A simulated campaign: `out` is a campaign folder with captures, `runs` the ids of those made."""

    out: Path
    runs: list[str]
    _plan: Plan

    def __repr__(self) -> str:
        name = self._plan.folder.resolve().name
        return f"Simulation of {name}: {len(self.runs)} captures ({', '.join(self.runs)})"

    def open(self, run_id: str | None = None) -> xr.DataArray:
        """Raw readings of a capture (default: the first), (gyro, time), as they were captured."""
        import xarray as xr

        run_id = self.runs[0] if run_id is None else run_id
        if run_id not in self.runs:
            raise ValueError(f"no run {run_id}; expected one of {', '.join(self.runs)}")
        run, facts = self._plan.runs[run_id], self._plan.facts(run_id)
        path = self.out / "runs" / run_id / run.capture.file
        reader = open_capture(path, run.capture.model_dump(mode="json"), facts.start_us)
        times, readings = [], []
        for block in reader.blocks(_BLOCK):
            times.append(block.time_us / MICROSECONDS_PER_SECOND)
            if block.counts is None:
                assert block.values is not None
                readings.append(block.values)
            else:
                scaled = block.counts * facts.capture_least_count
                readings.append(np.where(block.counts == MISSING_COUNT, np.nan, scaled))
        names = [f"gyro{k + 1}" for k in range(facts.n_gyros)]
        coordinates = {"gyro": names, "time": ("time", np.concatenate(times), {"units": "s"})}
        return xr.DataArray(
            np.concatenate(readings, axis=1),
            coordinates,
            ("gyro", "time"),
            name=run_id,
            attrs={"units": facts.captured_in},
        )

    def plot(self, run_id: str | None = None) -> Figure:
        """Raw readings of a run, each gyro in a panel, in means of neighbouring records."""
        from fogreduce.plotting import style

        readings = self.open(run_id)
        size = max(1, readings.sizes["time"] // _POINTS)
        means = readings.coarsen(time=size, boundary="trim").mean()
        label = self._plan.campaign.label or ""
        identity = style.Identity(self._plan.folder.resolve().name, str(readings.name), "none", label)
        with style.style():
            figure, rows = style.panels(identity, "Simulated readings", means.sizes["gyro"], 1.4)
            for (axes,), values in zip(rows, means, strict=True):
                axes.plot(means["time"], values, color=style.MEAN, linewidth=0.8)
                axes.set_title(str(values["gyro"].item()))
                axes.set_ylabel(f"[{readings.attrs['units']}]")
            rows[-1][0].set_xlabel(f"{style.TIME_LABEL}, means of {size} records")
        return figure


def simulate(
    campaign: Folder,
    calibrations: Folder,
    out: Folder,
    *,
    effects: Folder | None = None,
    seed: int | None = None,
    noise: bool = True,
    draw_uncertainties: bool = False,
    only_runs: Sequence[str] = (),
    overwrite: bool = False,
) -> Simulation:
    """Simulate the captures of a campaign, as ``fogreduce simulate`` does.

    Parameters
    ----------
    campaign : path
        Campaign folder; captures are not needed.
    calibrations : path
        Folder of the calibration records.
    out : path
        Becomes a campaign folder with the captures.
    effects : path, optional
        Effects to put in (fogreduce/effects/1).
    seed : int, optional
        Of the noise; by default campaign.yaml's, else 0.
    noise : bool
        False leaves only rounding.
    draw_uncertainties : bool
        Whether the stated uncertainties are drawn; a file beside `out` says what was.
    only_runs : sequence of str
        Ids; empty: all.
    overwrite : bool
        Whether captures of an earlier simulation in `out` are written over.

    Returns
    -------
    Simulation
    """
    options = Options(
        effects_file=None if effects is None else Path(effects),
        seed=seed,
        noise=noise,
        draw_uncertainties=draw_uncertainties,
        only_runs=tuple(only_runs),
    )
    plan = prepare(Path(campaign), Path(calibrations), options)
    with sole_writer(Path(out)):
        write_campaign(plan, Path(out), overwrite=overwrite)
    return Simulation(Path(out), list(plan.chosen), plan)
