"""What a converter's error within the noise leaves in block means: nothing where whole periods are swept.

The full rate finds its amplitude and period; where it stands within its period in a run nobody knows, as the
stated uncertainties are many periods wide.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.noise_model import Rows
from fogreduce.diagnosis.observe.capture import RunInput

Array = NDArray[np.float64]


def converter_means(inputs: Sequence[RunInput], causes: Sequence[Cause], noise: Array, rows: Rows) -> Array:
    """Columns (rows, 2 x runs) [deg/h], one standard deviation each, of every converter among the causes.

    Parameters
    ----------
    inputs : runs
    causes : those found
    noise : (R, n) array
        White noise of a sample in each run [raw unit].
    rows : Rows
    """
    columns = [np.zeros((rows.total, 0))]
    for cause in causes:
        if cause.effect != "adc_nonlinearity" or cause.slow:
            continue
        i = int(cause.channels[0][4:]) - 1
        numbers = cause.parameters()
        kappa = 2.0 * np.pi / numbers["period_volts"]
        for r, one in enumerate(inputs):
            # noise sweeps over part of the period
            left = abs(numbers["volts"]) * float(np.exp(-0.5 * (kappa * noise[r, i]) ** 2))
            per_volt = SECONDS_PER_HOUR / abs(float(one.facts.scale_factor[i]))
            volts = one.scene.decoded(one.scene.blocks.time_s)[i] / per_volt
            waves = one.scene.blocks.means(np.array([np.cos(kappa * volts), np.sin(kappa * volts)]))
            column = np.zeros((rows.total, 2))
            column[rows.of(i, r)] = left * per_volt * waves.T
            columns.append(column)
    return np.column_stack(columns)
