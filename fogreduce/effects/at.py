"""What an effect finds around it when it acts: time, motion, temperature, other gyros, its randomness."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.effects.gyro_names import gyro_name

if TYPE_CHECKING:
    from fogreduce.datasets.logs import TemperatureLog
    from fogreduce.effects.motion import Motion

Array = NDArray[np.float64]


@dataclass
class Place:
    """Where one effect of one entry acts in one run, and what it carries from block to block.

    Attributes
    ----------
    run_id : str
    gyro : int
        Index of the gyro, from 0; -1 for what is common to all (table, clock).
    group : tuple of int
        Indices of all gyros that the entry names.
    n_gyros : int
    source : callable
        From a word to a generator: the effect's random streams in this run. Making one costs more than most
        effects do, so that none is made before it is asked for.
    state : dict
        Carried from block to block.
    """

    run_id: str
    gyro: int
    group: tuple[int, ...]
    n_gyros: int
    source: Callable[[str], np.random.Generator]
    state: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def generator(self) -> np.random.Generator:
        """The effect's own stream, for this run and gyro."""
        return self.source(gyro_name(self.gyro))

    @cached_property
    def phase_rad(self) -> float:
        """Drawn once for this run: the phase of an effect whose phase is not given."""
        return float(self.source("phase").uniform(0.0, 2.0 * np.pi))


@dataclass(frozen=True)
class At:
    """The surroundings of one call of an effect's forward function; what a stage does not have is left empty.

    Attributes
    ----------
    place : Place
    time_s : (N,) array
        True times since the run's start [s] at which the value holds.
    step_s : float
        Time between samples [s].
    motion : Motion
        The true motion.
    axis : (3,) array
        The gyro's true input axis in the unit frame.
    temperature : TemperatureLog or None
    columns : (n, N) array
        The values of all gyros before this stage.
    alpha_rad : (N,) array
        True table angle.
    """

    place: Place
    time_s: Array
    step_s: float
    motion: Motion
    axis: Array
    temperature: TemperatureLog | None
    columns: NDArray[Any]
    alpha_rad: Array

    @cached_property
    def warmed_degC(self) -> Array:
        """Sensor temperature less that at t = 0 [degC], (N,)."""
        log = self._log
        start = float(log.sensor_at(np.zeros(1))[0])
        return log.sensor_at(self.time_s) - start

    def phase_rad(self, given: float | None) -> float:
        """The phase given, or this run's draw."""
        return self.place.phase_rad if given is None else given

    @property
    def _log(self) -> TemperatureLog:
        if self.temperature is None:
            raise ValueError("an effect of temperature in a run without a temperature log")
        return self.temperature

    @property
    def warming_degC_per_min(self) -> Array:
        """Slope [degC/min] of the straight line through the sensor's rows within 10 s of each time, (N,)."""
        log = self._log
        return 60.0 * slope_around(log.time_s, log.sensor_degC, self.time_s, half_s=10.0)


def slope_around(row_s: Array, value: Array, time_s: Array, half_s: float) -> Array:
    """Slope [value/s] of the least-squares straight line through the rows within `half_s` of each time.

    Where fewer than two rows lie there the value holds, and the slope is 0.

    Parameters
    ----------
    row_s, value : (k,) arrays
        Rows of a log.
    time_s : (N,) array
        Where the slope is wanted [s].
    half_s : float
        Half the window [s].
    """
    low = np.searchsorted(row_s, time_s - half_s, side="left")
    high = np.searchsorted(row_s, time_s + half_s, side="right")
    # Sums over a window are differences of running sums, taken about the middle so that no digits are lost.
    t, y = row_s - row_s.mean(), value - value.mean()
    count = high - low
    st, sy, stt, sty = (
        sums[high] - sums[low]
        for sums in (np.concatenate(([0.0], np.cumsum(x))) for x in (t, y, t * t, t * y))
    )
    spread = count * stt - st * st
    slope = np.zeros(len(time_s))
    np.divide(count * sty - st * sy, spread, out=slope, where=count > 1)
    return slope
