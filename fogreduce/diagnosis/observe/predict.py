"""What the simulator's own forward chain, without noise, makes of a run: decoded as the reduction decodes it.

Effects on readings, motion and age act inside `ForwardRun`; those on volts, columns and polarity are applied
here by their own forward functions, before the volts are decoded with what the metadata state. Rounding, bits
and what is random belong to the full rate and are left out.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.datasets.logs import TemperatureLog
from fogreduce.diagnosis.observe.blocks import Blocks
from fogreduce.diagnosis.observe.table_motion import TableMotion
from fogreduce.effects.at import At, Place
from fogreduce.effects.model import Stage
from fogreduce.effects.motion import Motion
from fogreduce.effects.selection import Action
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.alignment import axis_rates_from_unit_rate, gyro_rates_from_axis_rates
from fogreduce.physics.scale_factor import rate_from_raw
from fogreduce.simulate.forward import ForwardRun, Turning
from fogreduce.simulate.streams import stream

Array = NDArray[np.float64]

_FAINT = 0.01  # of the largest error of a logged motion: what is less does not count
_BEFORE = (Stage.MOTION, Stage.AXES, Stage.BIAS, Stage.SCALE, Stage.CROSSTALK, Stage.DEAD_ZONE, Stage.LATENCY)
_AFTER = (Stage.FILTER, Stage.CONVERTER, Stage.CLIPPING, Stage.COLUMNS, Stage.POLARITY)
#: Stages whose effects change what a block's mean is.
SLOW_STAGES = (*_BEFORE, *_AFTER)


@dataclass(frozen=True)
class Scene:
    """A run, ready to be predicted: its facts, temperature log, blocks, its table's motion by its log."""

    facts: RunFacts
    temperature: TemperatureLog | None
    blocks: Blocks
    table: TableMotion | None = None

    def block_means(self, actions: Sequence[Action] = ()) -> Array:
        """Decoded readings in block means, (n, blocks) [deg/h], with effects in the chain."""
        here = [a for a in actions if self.facts.run_id in a.runs]
        if any(a.effect.stage == Stage.FILTER for a in here):
            return self._of_samples(here)
        blocks = self._asked(here)
        return blocks.means(self.decoded(blocks.time_s, here))

    def _asked(self, actions: Sequence[Action]) -> Blocks:
        """The blocks, those asked at every sample into which effects shift an edge of the profile or step."""
        start = sum(a.parameters["s"] for a in actions if a.effect.name == "start_offset")
        ages = {a.parameters["ms"] * 1e-3 for a in actions if a.effect.name == "latency"}
        steps = [a.parameters["time_s"] for a in actions if "time_s" in a.parameters]
        if not start and not ages and not steps:
            return self.blocks
        edges = self.facts.profile.edges_s
        late = np.concatenate([steps, *(edges + start + age for age in (0.0, *ages) if start or ages)])
        corners = frozenset() if self.table is None else self.blocks.holding(self.table.departure.time_s)
        further = self.blocks.holding(late) - self.blocks.holding(edges) - corners
        if further not in self._shifted:
            self._shifted[further] = Blocks.of(self.facts, further | corners) if further else self.blocks
        return self._shifted[further]

    @cached_property
    def _shifted(self) -> dict[frozenset[int], Blocks]:
        return {}

    @cached_property
    def turning(self) -> Turning:
        """The motion as stated and logged, at the blocks' times."""
        motion = Motion.nominal(self.facts)
        if self.table is not None:
            motion = replace(motion, departure=self.table.departure)
        return Turning.of(motion, self.facts, self.blocks.time_s)

    def table_errors(self) -> list[Array]:
        """Independent errors of the logged motion in block means, (n, blocks) [deg/h] each: one sigma."""
        if self.table is None:
            return []
        facts = self.facts
        turned = axis_rates_from_unit_rate(facts.table_axis[:, None], facts.frame_signs)
        seen = gyro_rates_from_axis_rates(turned, facts.axes) * SECONDS_PER_HOUR
        means = self.blocks.means(self.table.error_rates(self.blocks.time_s))
        # what many rows of a log leave open within a block is one number
        _, size, shapes = np.linalg.svd(means, full_matrices=False)
        return [seen * (s * shape) for s, shape in zip(size, shapes, strict=True) if s > _FAINT * size[0]]

    def decoded(self, time_s: Array, actions: Sequence[Action] = ()) -> Array:
        """Decoded readings (n, N) [deg/h] at true times [s]; even times where a filter is among the
        effects.
        """
        here = [a for a in actions if self.facts.run_id in a.runs and a.effect.stage in SLOW_STAGES]
        before = [a for a in here if a.effect.stage in _BEFORE]
        forward = ForwardRun(self.facts, None, before, self.temperature, turning=self.turning)
        volts = forward.volts(forward.readings(time_s))
        for stage in _AFTER:
            for action in here:
                if action.effect.stage == stage:
                    volts = self._applied(action, volts, time_s, forward)
        return self.rates(volts)

    def rates(self, volts: Array) -> Array:
        """Volts (n, N) decoded by the stated calibration [deg/h]."""
        facts = self.facts
        return rate_from_raw(volts, facts.scale_factor, facts.bias, facts.polarity) * SECONDS_PER_HOUR

    def _of_samples(self, actions: Sequence[Action]) -> Array:
        """Block means over all samples: for a filter, whose memory needs every one."""
        time_s = np.arange(self.facts.n_expected) / self.facts.sample_rate_hz
        values, index = self.decoded(time_s, actions), self.blocks.of_samples(time_s)
        count = np.bincount(index, minlength=self.blocks.count + 1)[: self.blocks.count]
        sums = [np.bincount(index, row, self.blocks.count + 1)[: self.blocks.count] for row in values]
        return np.array(sums) / count

    def _applied(self, action: Action, volts: Array, time_s: Array, forward: ForwardRun) -> Array:
        before, volts = volts, volts.copy()
        for gyro, parameters in action.acting():
            place = Place(
                self.facts.run_id, gyro, action.gyros, self.facts.n_gyros, partial(stream, 0, "gap")
            )
            at = At(
                place=place,
                time_s=time_s,
                step_s=1.0 / self.facts.sample_rate_hz,
                motion=forward.motion,
                axis=forward.axes[gyro],
                temperature=self.temperature,
                columns=before,
                alpha_rad=np.zeros(0),
            )
            volts[gyro] = action.effect.forward(volts[gyro], parameters, at)
        return volts
