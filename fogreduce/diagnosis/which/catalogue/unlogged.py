"""What a temperature that nobody logged may do to a gyro: smooth random processes of a room that warms.

Nothing is known of such a temperature but that it drifts and swings over minutes, differently in each run.
So it is taken as a Gaussian process, a straight drift and swings; what follows the temperature follows how
far it is from where it was at the run's start, what follows its rate how fast it changes. A random walk is
rougher, and what they do begins at nothing or does not: that tells them apart.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.observe.blocks import Blocks
from fogreduce.effects.table import EFFECTS

Array = NDArray[np.float64]

#: Effects that need a log, as processes where there is none; "gain": it goes with the reading.
UNLOGGED = {name: effect.unlogged for name, effect in EFFECTS.items() if effect.unlogged}
#: How long a swing of the temperature holds [s].
HOLDS_S = (40.0, 80.0, 160.0)
#: Swings [degC], and drift in as many minutes.
_SWING, _DRIFT, _DRIFT_S = 0.3, 0.7, 300.0


def unlogged_covariance(kind: str, blocks: Blocks) -> Array:
    """Covariance (blocks, blocks) of block means of a temperature since the run's start, or of its rate.

    Parameters
    ----------
    kind : str
        ``warmth H`` [degC^2] or ``warming H`` [(degC/min)^2]; H: how long a swing holds [s].
    blocks : Blocks
    """
    name, hold = kind.split()
    drift = _DRIFT / _DRIFT_S
    x = blocks.centre_s / float(hold)
    lag2 = np.subtract.outer(x, x) ** 2
    swings = np.exp(-0.5 * lag2)
    if name == "warming":
        rates = (1.0 - lag2) * swings * (60.0 / float(hold)) ** 2
        return np.asarray(_SWING**2 * rates + (60.0 * drift) ** 2)
    start = np.exp(-0.5 * x**2)
    since = swings - start[:, None] - start + 1.0
    return np.asarray(_SWING**2 * since + drift**2 * np.outer(blocks.centre_s, blocks.centre_s))
