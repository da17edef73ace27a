"""The attitude error that a unit's model implies over one orbit of 100 minutes.

The satellite turns once about one of its axes in an orbit (0.06 deg/s, the rate of the paper's run) and knows
its attitude from the gyros alone. To first order the error at the end, as an angle about each axis, is

    psi = integral of R(u, w t) H dM(t) dt,

dM being what the gyros read in error, R(u, w t) the turn about the axis u since the orbit's start: an error
that is fixed to the body turns with it. The paper's own account leaves R out (it integrates each axis by
itself); both are given. See docs/attitude-model.md.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache, cached_property

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.effects.model import Stage
from fogreduce.effects.motion import Motion
from fogreduce.effects.noise import NoiseLevels
from fogreduce.effects.selection import Action
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.frames import AXES, rotation
from fogreduce.physics.noise import flicker_covariance
from fogreduce.physics.table_motion import Profile
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.nominal_noise import NoiseCoefficients

Array = NDArray[np.float64]

ORBIT_S = 6000.0
STEPS = 600
STEP_S = ORBIT_S / STEPS
RATE_DEG_S = 360.0 / ORBIT_S

#: Effects of a gyro that are bound to the laboratory: to gravity or to a field fixed in the room.
_OF_THE_LABORATORY = ("acceleration_bias", "magnetic_bias")
_CARRIED = (
    Stage.AXES, Stage.BIAS, Stage.SCALE, Stage.CROSSTALK, Stage.DEAD_ZONE, Stage.LATENCY, Stage.NOISE,
)  # fmt: skip


@dataclass(frozen=True)
class Orbit:
    """One orbit of a unit that turns about one of its axes.

    Attributes
    ----------
    facts : RunFacts
        Any run's: calibration and geometry count, its motion does not.
    axis : str
        x, y or z.
    """

    facts: RunFacts
    axis: str

    @property
    def vector(self) -> Array:
        """The axis as a unit vector, (3,)."""
        vector: Array = np.eye(3)[AXES.index(self.axis)]
        return vector

    @property
    def times_s(self) -> Array:
        """Middles of the steps into which the orbit is cut, (K,)."""
        return np.linspace(STEP_S / 2.0, ORBIT_S - STEP_S / 2.0, STEPS)

    @cached_property
    def turning(self) -> Array:
        """Weights (3, n, K) [deg per (deg/s)]: ``psi = sum over gyros and steps of weight times dM``."""
        projection = self.facts.projection
        assert projection is not None
        weights = np.empty((*projection.shape, STEPS))
        for k, time_s in enumerate(self.times_s):
            turn = rotation(self.vector, np.radians(RATE_DEG_S * time_s))
            weights[:, :, k] = turn @ projection * STEP_S
        return weights

    @cached_property
    def each_by_itself(self) -> Array:
        """The same where each axis is integrated by itself, as in the paper."""
        projection = self.facts.projection
        assert projection is not None
        return np.repeat(projection[:, :, None] * STEP_S, STEPS, axis=2)

    def forward(self, actions: Sequence[Action] = ()) -> ForwardRun:
        """The unit in orbit."""
        profile = Profile(np.array([RATE_DEG_S]), np.array([ORBIT_S]))
        facts = replace(self.facts, profile=profile, table_axis=self.vector, frame_signs=np.ones(3))
        motion = replace(Motion.nominal(facts), on_earth=False)
        return ForwardRun(facts, None, actions, motion=motion)

    def wrong(self, actions: Sequence[Action]) -> Array:
        """What effects change in the gyros' readings, dM (n, K) [deg/s]."""
        return self.forward(actions).readings(self.times_s) - self._right

    @cached_property
    def _right(self) -> Array:
        return self.forward().readings(self.times_s)


def attitude_error(weights: Array, wrong: Array) -> Array:
    """Attitude error [deg], (3,), of readings that are wrong by `wrong` (n, K) [deg/s]."""
    error: Array = np.einsum("xik,ik->x", weights, wrong)
    return error


def noise_covariance(weights: Array, levels: Sequence[NoiseLevels]) -> dict[str, Array]:
    """Covariance [deg^2], (3, 3), of the attitude error from each kind of noise."""
    middles = (np.arange(STEPS) + 0.5) * STEP_S
    white = [level.white_deg_sqrt_h / 60.0 * level.mixing for level in levels]
    spread = np.einsum("xik,ij->xjk", weights, np.array(white))
    lags = np.abs(np.subtract.outer(np.arange(STEPS), np.arange(STEPS)))
    unit_flicker = _flicker_lags()[lags] / SECONDS_PER_HOUR**2
    unit_walk = np.minimum.outer(middles, middles) / SECONDS_PER_HOUR / SECONDS_PER_HOUR**2
    flicker = [level.flicker_deg_h**2 + sum(b**2 for b, _ in level.further_flicker) for level in levels]
    walk = [level.walk_deg_h_sqrt_h**2 + sum(k**2 for k, _ in level.further_walk) for level in levels]
    return {
        "angle_random_walk": np.einsum("xjk,yjk->xy", spread, spread) / STEP_S,
        "bias_instability": _through(weights, flicker, unit_flicker),
        "rate_random_walk": _through(weights, walk, unit_walk),
    }


@cache
def _flicker_lags() -> Array:
    """Covariance of flicker's means over the orbit's steps, for B = 1 deg/h, at lags 0 to STEPS - 1."""
    return flicker_covariance(1.0, STEP_S, STEPS)


def _through(weights: Array, variances: Sequence[float], unit: Array) -> Array:
    """Covariance (3, 3) of independent gyros' processes, all of one shape `unit` (K, K)."""
    total = np.zeros((3, 3))
    for gyro, variance in enumerate(variances):
        if variance > 0.0:
            total += variance * (weights[:, gyro] @ unit @ weights[:, gyro].T)
    return total


def carried_into_orbit(action: Action, run_ids: Sequence[str]) -> str:
    """Empty for an effect that the unit takes with it into orbit; else why it does not."""
    effect = action.effect
    if effect.channels != "gyro" or effect.name in _OF_THE_LABORATORY:
        return "belongs to the laboratory, not to the unit"
    if effect.needs_temperature:
        return "needs the temperatures of the orbit"
    if set(action.runs) != set(run_ids):
        return "acts in some runs only"
    if effect.stage not in _CARRIED:
        return "acts on single samples: no effect on the mean rate to first order"
    return ""


def coefficients(levels: Sequence[NoiseLevels]) -> NoiseCoefficients:
    """N, B and K of each gyro, further processes added in square."""
    return NoiseCoefficients(
        [level.white_deg_sqrt_h for level in levels],
        [
            float(np.hypot.reduce([level.flicker_deg_h, *(b for b, _ in level.further_flicker)]))
            for level in levels
        ],
        [
            float(np.hypot.reduce([level.walk_deg_h_sqrt_h, *(k for k, _ in level.further_walk)]))
            for level in levels
        ],
    )
