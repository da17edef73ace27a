"""The capture contract's chain forward: from metadata, calibration and effects to what the capture holds.

Blocks of records with a carried state, so that memory stays flat in the length of the run. The physics are
those of the reduction, from the same files.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import MICROSECONDS_PER_SECOND
from fogreduce.datasets.logs import TemperatureLog
from fogreduce.effects.at import At, Place
from fogreduce.effects.model import Parameters, Stage
from fogreduce.effects.motion import Motion
from fogreduce.effects.noise import NoiseLevels
from fogreduce.effects.selection import Action
from fogreduce.effects.table import EFFECTS
from fogreduce.errors import BadInput
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.alignment import axis_rates_from_unit_rate, gyro_rates_from_axis_rates
from fogreduce.physics.noise import BLOCK
from fogreduce.physics.quantization import counts_from_raw
from fogreduce.physics.scale_factor import raw_from_rate
from fogreduce.simulate.nominal_noise import GyroNoise, NoiseCoefficients
from fogreduce.simulate.streams import stream

Array = NDArray[np.float64]
Counts = NDArray[np.int32]

_READING_STAGES = (Stage.BIAS, Stage.SCALE, Stage.CROSSTALK, Stage.DEAD_ZONE)
_VOLT_STAGES = (Stage.FILTER, Stage.CONVERTER, Stage.CLIPPING)
_COUNT_STAGES = (
    Stage.BITS, Stage.REPEATS, Stage.SPIKES, Stage.DROPOUTS, Stage.COLUMNS, Stage.POLARITY,
)  # fmt: skip
_NONE = np.zeros(0)

#: Within a stage effects act in the catalogue's order, whatever the order of an effects file.
_CATALOGUE_ORDER = {name: k for k, name in enumerate(EFFECTS)}


@dataclass(frozen=True)
class _Acting:
    """One effect at one place in this run."""

    action: Action
    place: Place
    parameters: Parameters

    def forward(self, value: Any, at: At) -> Any:
        return self.action.effect.forward(value, self.parameters, at)


@dataclass(frozen=True)
class SimulatedBlock:
    """Consecutive records: stamps [us] (N,) int64, pulse numbers (N,) int64, counts (n, N) int32."""

    time_us: NDArray[np.int64]
    pulse: NDArray[np.int64]
    counts: Counts


@dataclass(frozen=True)
class Turning:
    """A motion at given times: alpha [rad] (N,) and what the projected axes read [deg/s] (3, N)."""

    motion: Motion
    time_s: Array
    alpha_rad: Array
    axis_rates: Array

    @classmethod
    def of(cls, motion: Motion, facts: RunFacts, time_s: Array) -> Turning:
        """Work it out; the same `time_s` object must be given to `ForwardRun.readings` to be recognised."""
        alpha = motion.angle_at(time_s)
        axis_rates = axis_rates_from_unit_rate(motion.unit_rate(time_s, alpha), facts.frame_signs)
        return cls(motion, time_s, alpha, axis_rates)


class ForwardRun:
    """One run, forward. A capture is drawn from it once, by `blocks`; `readings` may be asked at any times.

    Parameters
    ----------
    facts : RunFacts
        What run.yaml and calibration record state.
    noise : NoiseCoefficients or None
        The unit's stated noise; None for none of any kind (what remains is rounding).
    actions : sequence of Action
        Effects; those of other runs are passed over.
    temperature : TemperatureLog or None
    seed : int
        Of the noise and of all that is random.
    motion : Motion or None
        None: as run.yaml states it. Another one for a unit that is elsewhere than on its table.
    turning : Turning or None
        The motion at times that will be asked for again and again, worked out before.
    """

    def __init__(
        self,
        facts: RunFacts,
        noise: NoiseCoefficients | None = None,
        actions: Sequence[Action] = (),
        temperature: TemperatureLog | None = None,
        seed: int = 0,
        motion: Motion | None = None,
        turning: Turning | None = None,
    ) -> None:
        self.facts = facts
        self._turning = turning
        self.temperature = temperature
        self._by_stage: dict[Stage, list[_Acting]] = {}
        for action in actions:
            if facts.run_id in action.runs:
                self._take(action, seed)
        for acting in self._by_stage.values():
            acting.sort(key=lambda one: _CATALOGUE_ORDER.get(one.action.effect.name, len(_CATALOGUE_ORDER)))
        if motion is None:
            motion = Motion.nominal(facts) if turning is None else turning.motion
        self.motion, self.axes = motion, facts.axes
        self.motion = self._common(Stage.MOTION, self.motion)
        self.axes = np.array(self._per_gyro(Stage.AXES, list(facts.axes)))
        ages = self._per_gyro(Stage.LATENCY, [0.0] * facts.n_gyros)
        self._ages = {age: [i for i, other in enumerate(ages) if other == age] for age in set(ages)}
        self._noise: GyroNoise | None = None
        if noise is not None:
            levels = self.noise_levels(noise)
            self._noise = GyroNoise(levels, facts.sample_rate_hz, facts.run_id, seed)

    # ------------------------------------------------------------------------------- without noise

    def readings(self, time_s: Array) -> Array:
        """What the gyros answer at true times [s], noise apart: M (n, N) [deg/s], latencies in it."""
        answers = np.empty((self.facts.n_gyros, len(time_s)))
        for age, gyros in self._ages.items():
            seen_at = np.maximum(time_s - age, 0.0) if age else time_s
            answers[gyros] = self._readings(seen_at)[gyros]
        return answers

    def _readings(self, time_s: Array) -> Array:
        turning = self._turning
        if turning is None or self.motion is not turning.motion or time_s is not turning.time_s:
            turning = Turning.of(self.motion, self.facts, time_s)
        alpha = turning.alpha_rad
        readings = gyro_rates_from_axis_rates(turning.axis_rates, self.axes)
        for stage in _READING_STAGES:
            readings = self._act(stage, readings, time_s, alpha)
        return readings

    def volts(self, readings: Array) -> Array:
        """Raw output for readings [deg/s], before noise and electronics: (n, N) [raw unit]."""
        facts = self.facts
        return raw_from_rate(readings, facts.scale_factor, facts.bias, facts.polarity)

    def noise_levels(self, noise: NoiseCoefficients) -> list[NoiseLevels]:
        """Each gyro's noise: what the record states, with the effects on noise in it."""
        each = np.eye(self.facts.n_gyros)
        stated = zip(noise.white_deg_sqrt_h, noise.flicker_deg_h, noise.walk_deg_h_sqrt_h, each, strict=True)
        return self._per_gyro(Stage.NOISE, [NoiseLevels(n, b, k, row) for n, b, k, row in stated])

    # ----------------------------------------------------------------------------------- a capture

    def blocks(self) -> Iterator[SimulatedBlock]:
        """The whole capture in blocks. Noise and the electronics' memory run on from one to the next."""
        for start in range(0, self.facts.n_expected, BLOCK):
            pulse = np.arange(start, min(start + BLOCK, self.facts.n_expected))
            yield self._block(pulse)

    def _block(self, pulse: NDArray[np.int64]) -> SimulatedBlock:
        facts = self.facts
        time_s = pulse / facts.sample_rate_hz
        volts = self.volts(self.readings(time_s))
        added = self._added(time_s)
        if added is not None:
            volts += (facts.polarity * facts.scale_factor)[:, None] * added
        for stage in _VOLT_STAGES:
            volts = self._act(stage, volts, time_s)
        counts = counts_from_raw(volts, facts.least_count)
        for stage in _COUNT_STAGES:
            counts = self._act(stage, counts, time_s)
        shown = self._common(Stage.STAMPS, time_s)
        time_us = np.rint(shown * MICROSECONDS_PER_SECOND).astype(np.int64)
        return SimulatedBlock(time_us, pulse, counts)

    def _added(self, time_s: Array) -> Array | None:
        """Noise and interference [deg/s], (n, N); None where there is neither."""
        interfered = Stage.INTERFERENCE in self._by_stage
        if self._noise is not None:
            added = self._noise.next_block()[:, : len(time_s)]
        elif interfered:
            added = np.zeros((self.facts.n_gyros, len(time_s)))
        else:
            return None
        if interfered:
            for age, gyros in self._ages.items():
                seen_at = np.maximum(time_s - age, 0.0) if age else time_s
                added[gyros] = self._act(Stage.INTERFERENCE, added, seen_at)[gyros]
        return added

    # ------------------------------------------------------------------------------------- effects

    def _take(self, action: Action, seed: int) -> None:
        """File an action under its stage, with a place of its own for each gyro."""
        facts, effect = self.facts, action.effect
        if effect.needs_temperature and self.temperature is None:
            raise BadInput.at(
                f"run {facts.run_id}", "temperature", found="no log", expected=f"one, for {effect.name}"
            )
        source = partial(stream, seed, "effect", facts.run_id, effect.name, str(action.ordinal))
        for gyro, parameters in action.acting():
            place = Place(facts.run_id, gyro, action.gyros, facts.n_gyros, source)
            self._by_stage.setdefault(effect.stage, []).append(_Acting(action, place, parameters))

    def _act(self, stage: Stage, rows: Any, time_s: Array, alpha: Array | None = None) -> Any:
        """`rows` (n, N), a row a gyro, with the effects of one stage in them."""
        acting = self._by_stage.get(stage)
        if not acting:
            return rows
        # Crosstalk couples what gyros read before any of it; columns are exchanged entry after entry.
        before, rows, entry = rows, rows.copy(), acting[0].action
        for one in acting:
            if one.action is not entry and stage == Stage.COLUMNS:
                before, entry = rows.copy(), one.action
            i = one.place.gyro
            rows[i] = one.forward(rows[i], self._at(one.place, time_s, before, alpha))
        return rows

    def _per_gyro(self, stage: Stage, values: list[Any]) -> list[Any]:
        """One value a gyro, with the effects of a stage in it."""
        for one in self._by_stage.get(stage, ()):
            i = one.place.gyro
            values[i] = one.forward(values[i], self._at(one.place))
        return values

    def _common(self, stage: Stage, value: Any) -> Any:
        """A value common to all gyros, with the effects of a stage in it."""
        for one in self._by_stage.get(stage, ()):
            value = one.forward(value, self._at(one.place))
        return value

    def _at(
        self,
        place: Place,
        time_s: Array = _NONE,
        columns: NDArray[Any] = _NONE,
        alpha: Array | None = None,
    ) -> At:
        return At(
            place=place,
            time_s=time_s,
            step_s=1.0 / self.facts.sample_rate_hz,
            motion=self.motion,
            axis=self.axes[place.gyro],
            temperature=self.temperature,
            columns=columns,
            alpha_rad=_NONE if alpha is None else alpha,
        )
