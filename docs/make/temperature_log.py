"""A made-up temperature log of a unit that warms up: how the bundled campaigns' logs were made.

``python docs/make/temperature_log.py CAMPAIGN SEED`` writes the log of every run of a campaign. The
logs are inputs and kept; this is here so that it can be seen where they come from.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets.atomic import write_text
from fogreduce.metadata.folder import list_runs, load_campaign
from fogreduce.metadata.run import Run
from fogreduce.simulate.streams import stream

Array = NDArray[np.float64]


def warm_up(duration_s: float, generator: np.random.Generator) -> tuple[Array, Array, Array]:
    """One row a second of a unit that was switched on a while ago.

    The electronics heat themselves by 9 degC above the room with a time constant of 25 minutes and are seen
    10 to 40 minutes after power-on; the sensor coils follow the electronics' rise with a share of 0.35 and a
    lag of 10 minutes; the room's air conditioning swings by a few tenths of a degree.

    Parameters
    ----------
    duration_s : float
        Length of the run [s].
    generator : numpy.random.Generator
        Draws what differs from run to run.

    Returns
    -------
    time_s, electronics_degC, sensor_degC : (rows,) arrays
        Rounded to 0, 2 and 3 decimals.
    """
    time = np.arange(0.0, np.floor(duration_s) + 1.0)
    since_power_on = time + generator.uniform(600.0, 2400.0)
    room = generator.uniform(21.0, 23.0) + 0.2 * np.sin(
        2 * np.pi * (time / generator.uniform(1200.0, 2400.0) + generator.random())
    )
    fast, slow = 1500.0, 600.0
    rise = 9.0 * (1.0 - np.exp(-since_power_on / fast))
    # A first-order lag `slow` of that rise, which was 0 at power-on.
    lagged = 9.0 * (
        1.0 - (fast * np.exp(-since_power_on / fast) - slow * np.exp(-since_power_on / slow)) / (fast - slow)
    )
    electronics = room + rise + 0.02 * generator.standard_normal(time.size)
    sensor = room + 0.35 * lagged + 0.003 * generator.standard_normal(time.size)
    return time, np.round(electronics, 2), np.round(sensor, 3)


def log_text(time_s: Array, electronics_degC: Array, sensor_degC: Array) -> str:
    """The log as CSV, in the capture contract's columns."""
    rows = zip(time_s, electronics_degC, sensor_degC, strict=True)
    return "time_s,electronics_degC,sensor_degC\n" + "".join(
        f"{t:.0f},{electronics:.2f},{sensor:.3f}\n" for t, electronics, sensor in rows
    )


def main(campaign_dir: Path, seed: int) -> None:
    """Write the temperature log of every run of a campaign that names one."""
    load_campaign(campaign_dir)
    for folder in list_runs(campaign_dir):
        run = Run.from_yaml(folder / "run.yaml")
        if run.temperature is not None:
            generator = stream(seed, "temperature", run.run_id)
            write_text(folder / run.temperature, log_text(*warm_up(run.duration_s, generator)))


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
