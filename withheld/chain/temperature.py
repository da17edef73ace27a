"""Temperatures of one run: what the log says, and what the coil feels."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from withheld.arrays import Array
from withheld.errors import BadInput


@dataclass(frozen=True)
class Temperature:
    """A log (rows once a second) and the lag of the coil behind its sensor.

    Parameters
    ----------
    time_s, electronics_degC, sensor_degC : (rows,), as written to temperature.csv
    felt_degC : (rows,), what the gyros respond to; the log's own numbers where nothing departs
    """

    time_s: Array
    electronics_degC: Array
    sensor_degC: Array
    felt_degC: Array

    def rise(self, t: Array) -> Array:
        """T(t) - T(0) [degC] of what is felt; straight between rows, held beyond them."""
        return np.interp(t, self.time_s, self.felt_degC) - np.interp(0.0, self.time_s, self.felt_degC)

    def slope_per_min(self, t: Array, half_s: float = 10.0) -> Array:
        """dT/dt [degC/min]: least-squares straight line through the rows within 10 s of each time.

        Sums over a sliding window come from cumulative sums, about the middle of the log so that
        no digits are lost.
        """
        time = self.time_s - self.time_s.mean()
        value = self.felt_degC - self.felt_degC.mean()
        sums = [np.concatenate([[0.0], np.cumsum(x)]) for x in (time, value, time * time, time * value)]
        low = np.searchsorted(self.time_s, t - half_s, side="left")
        high = np.searchsorted(self.time_s, t + half_s, side="right")
        count = high - low
        st, sv, stt, stv = (s[high] - s[low] for s in sums)
        spread = count * stt - st * st
        slope = np.divide(count * stv - st * sv, spread, out=np.zeros_like(spread), where=count > 1)
        result: Array = 60.0 * slope
        return result


def straight(duration_s: float, start_degC: float = 25.0, degC_per_s: float = 0.01) -> Temperature:
    """A straight ramp without noise: every reading of the contract's slope agrees on it."""
    time = np.arange(0.0, np.floor(duration_s) + 1.0)
    sensor = np.round(start_degC + degC_per_s * time, 6)
    return Temperature(time, np.round(sensor + 6.0, 6), sensor, sensor)


def read_log(path: Path) -> Temperature:
    """temperature.csv as it stands; what the gyros feel is what it says."""
    try:
        rows = np.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
        time, electronics, sensor = rows.T
    except (OSError, ValueError) as error:
        raise BadInput(f"{path}: not a temperature log ({error})") from error
    return Temperature(time, electronics, sensor, sensor)


def realistic(duration_s: float, rng: np.random.Generator, start_degC: float) -> Temperature:
    """A slowly wandering room, two sensors with their own noise and rounding, and a coil that lags.

    The true temperature is a drift with two slow swings.  The coil follows it with a lag of 3 to 15 s and a
    gain of a few per cent off one; the sensors add noise and are written with three and four decimals.
    """
    time = np.arange(0.0, np.floor(duration_s) + 1.0)
    # of a long run no more than four times that of a run of five minutes, and its swings are as much slower
    drift = rng.uniform(-1.2, 1.2) * time / max(300.0, duration_s / 4.0)
    stretch = max(1.0, duration_s / 1200.0)
    swing = np.zeros_like(time)
    for _ in range(2):
        period = stretch * rng.uniform(250.0, 900.0)
        swing += rng.uniform(0.1, 0.5) * np.sin(2 * np.pi * (time / period + rng.random()))
    true = start_degC + drift + swing - swing[0]
    lag, gain = rng.uniform(3.0, 15.0), 1.0 + 0.02 * rng.standard_normal()
    later = np.interp(time - lag, time, true, left=np.nan)
    before = true[0] + (true[1] - true[0]) * (time - lag)
    felt = true[0] + gain * (np.where(np.isnan(later), before, later) - true[0])
    sensor = np.round(true + 0.004 * rng.standard_normal(time.size), 4)
    electronics = np.round(true + 6.0 + 0.02 * rng.standard_normal(time.size), 3)
    return Temperature(time, electronics, sensor, felt)
