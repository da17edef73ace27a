"""Everything that a diagnosis is made from: residuals in blocks and full-rate statistics of every run."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.diagnosis.observe.capture import (
    SLOWEST_HZ,
    RunInput,
    Samples,
    block_residual,
    read_inputs,
    read_samples,
)
from fogreduce.diagnosis.observe.constant import Constant, constant_gyros, without_dead
from fogreduce.diagnosis.observe.full_rate import PIECE, FullRate, full_rate, straightened
from fogreduce.diagnosis.observe.run_noise import run_levels, with_white_noise
from fogreduce.diagnosis.which.full_rate.converter import Codes, codes
from fogreduce.diagnosis.which.full_rate.line import Line
from fogreduce.diagnosis.which.full_rate.lines import without_lines
from fogreduce.diagnosis.which.full_rate.link import zero_bits
from fogreduce.effects.model import Stage
from fogreduce.effects.selection import Action
from fogreduce.effects.table import EFFECTS
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.folder import load_run
from fogreduce.metadata.part import Part
from fogreduce.physics.noise import white_sigma
from fogreduce.simulate.streams import stream

Array = NDArray[np.float64]

_PIECE_S = 2.0  # in which what is slow is taken for a straight line or nearly
_ASKED = 16  # times in a piece of a spectrum at which what effects change is asked for


@dataclass(frozen=True)
class Data:
    """A campaign's residuals.

    Attributes
    ----------
    inputs : runs
    residual, sizes : lists of (n, blocks) arrays
        Block means of measured less predicted and of lines [deg/h], 0 where there is none; samples in each.
    full : list of FullRate
    lines : tuple of Line
        What was taken out, and the best that the odds are against.
    of_lines : list of (n, blocks) arrays
        What the lines made of the block means [deg/h].
    stated_white : (n,) array
        N of the record [deg/sqrt(h)].
    bits : (n,) array of int
        Lowest bits of each gyro that are always 0.
    rails : dict
        Gyro -> volts at which its converter rests.
    codes : lists of Codes
        Of each gyro in each run.
    record : CalibrationRecord
        As it stands in its file.
    run_level : (R, n) array
        White noise of a run over that of the gyro's other runs.
    found_white : (n,) array or None
        White noise as the captures show it, where the record states none.
    constant : list of Constant
        Gyros that gave one value all through a run.
    """

    inputs: list[RunInput]
    residual: list[Array]
    sizes: list[Array]
    full: list[FullRate]
    lines: tuple[Line, ...]
    of_lines: list[Array]
    stated_white: Array
    bits: NDArray[np.int64]
    rails: dict[int, float]
    codes: list[list[Codes | None]]
    record: CalibrationRecord
    run_level: Array
    found_white: Array | None = None
    constant: tuple[Constant, ...] = ()

    @property
    def n(self) -> int:
        """Gyros."""
        return self.inputs[0].facts.n_gyros

    @property
    def run_ids(self) -> list[str]:
        """Ids of the runs."""
        return [one.facts.run_id for one in self.inputs]

    def noise_counts(self) -> Array:
        """White noise of a sample in counts, as the record states it, in each run (R, n)."""
        return self.noise_raw() / np.array([[one.facts.least_count] for one in self.inputs])

    def noise_raw(self) -> Array:
        """The same in raw units."""
        return np.array(
            [
                white_sigma(self.stated_white, one.facts.sample_rate_hz) * np.abs(one.facts.scale_factor)
                for one in self.inputs
            ]
        )

    def some_runs(self, which: slice) -> Data:
        """The same of some runs alone."""
        found = [line.of(self.run_ids[which]) for line in self.lines]
        return replace(
            self,
            inputs=self.inputs[which],
            residual=self.residual[which],
            sizes=self.sizes[which],
            full=self.full[which],
            lines=tuple(one for one in found if one is not None),
            of_lines=self.of_lines[which],
            codes=self.codes[which],
            run_level=self.run_level[which],
        )

    def with_parts(self, keep: Sequence[NDArray[np.bool_]]) -> Data:
        """The same with only some blocks of each run counted; `keep`: a mask (blocks,) a run."""
        sizes = [np.where(mask, size, 0.0) for mask, size in zip(keep, self.sizes, strict=True)]
        residual = [np.where(mask, value, 0.0) for mask, value in zip(keep, self.residual, strict=True)]
        return replace(self, residual=residual, sizes=sizes)

    def with_effects(self, actions: Sequence[Action]) -> Data:
        """The same with the full rate held against a chain with steady effects in it.

        What a gross fault changes is far larger than noise: its curvature within a second passes for lines.
        """
        captures = [read_samples(one, actions) for one in self.inputs]
        captures, lines, of_lines = _less_lines(self.inputs, captures)
        residual = [
            np.where(size > 0.0, value + before - after, 0.0)
            for value, size, before, after in zip(
                self.residual, self.sizes, self.of_lines, of_lines, strict=True
            )
        ]
        full = [_full_rate(one, s) for one, s in zip(self.inputs, captures, strict=True)]
        return replace(self, residual=residual, full=full, lines=lines, of_lines=of_lines)

    def bent(self, actions: Sequence[Action]) -> float:
        """What effects change beside a straight line in each piece of a spectrum, in noise of one sample: the
        sum of squares over all samples.
        """
        total = 0.0
        for one in self.inputs:
            rate = one.facts.sample_rate_hz
            noise = white_sigma(self.stated_white, rate) * SECONDS_PER_HOUR
            piece_s = max(PIECE / rate, _PIECE_S)
            pieces = max(int(one.facts.n_expected / rate / piece_s), 1)
            time_s: Array = (np.arange(pieces * _ASKED, dtype=np.float64) + 0.5) * (piece_s / _ASKED)
            change = one.scene.decoded(time_s, actions) - one.scene.decoded(time_s)
            squares = np.sum(straightened(change.reshape(self.n, pieces, _ASKED)) ** 2, axis=(1, 2))
            total += float(np.sum(squares / np.maximum(noise, 1e-300) ** 2)) * piece_s * rate / _ASKED
        return total


def steady(actions: Sequence[Action]) -> list[Action]:
    """Effects of which it is known what they do within a second.

    A filter remembers what came before. A temperature takes longer than that to change: what its log has
    within a second is noise.
    """
    return [a for a in actions if a.effect.stage != Stage.FILTER and not a.effect.needs_temperature]


def read_data(
    campaign: Path,
    calibrations: Path,
    only: Sequence[str] = (),
    simulated: Path | None = None,
    part: Part | None = None,
) -> Data:
    """Read a campaign's captures and hold them against the simulator, or against another one's captures."""
    inputs = read_inputs(campaign, calibrations, only, part=part)
    captures = [read_samples(one) for one in inputs]
    constant = constant_gyros(inputs, captures)
    captures = without_dead(inputs, captures, constant)
    captures, lines, of_lines = _less_lines(inputs, captures)
    full = [_full_rate(one, s) for one, s in zip(inputs, captures, strict=True)]
    record = inputs[0].record
    inputs, found_white = with_white_noise(inputs, captures, full)
    n = inputs[0].facts.n_gyros
    bits = np.array([zero_bits(full, i) for i in range(n)])
    residual, sizes = [], []
    for one, samples in zip(inputs, captures, strict=True):
        means, size = block_residual(samples, one.scene.blocks, one.facts.sample_rate_hz)
        if simulated is not None:
            other = read_samples(_simulated(one, simulated))
            means = means - block_residual(other, one.scene.blocks, one.facts.sample_rate_hz)[0]
        means = means - _rounded_down(one, bits)[:, None]
        residual.append(np.nan_to_num(means))
        sizes.append(np.where(np.isfinite(means), size, 0.0))
    stated = np.array(inputs[0].record.stated_noise.angle_random_walk_deg_sqrt_h)
    cells = [_codes(one, samples, run) for one, samples, run in zip(inputs, captures, full, strict=True)]
    return Data(
        inputs,
        residual,
        sizes,
        full,
        lines,
        of_lines,
        stated,
        bits,
        _rails(captures, full, inputs, constant),
        cells,
        record,
        run_levels(full, inputs, stated, bits.astype(float)),
        found_white,
        constant,
    )


def _simulated(one: RunInput, campaign: Path) -> RunInput:
    """A run as another campaign folder has it, whose capture may be of another format."""
    folder = campaign / "runs" / one.facts.run_id
    return replace(one, run=load_run(folder), folder=folder)


def _less_lines(
    inputs: Sequence[RunInput], captures: Sequence[Samples]
) -> tuple[list[Samples], tuple[Line, ...], list[Array]]:
    """Captures without their lines; the lines; what they made of the block means."""
    residuals = [samples.residual for samples in captures]
    left, lines = without_lines(residuals, [one.facts for one in inputs])
    clean = [replace(samples, residual=r) for samples, r in zip(captures, left, strict=True)]
    of_lines = []
    for one, before, after in zip(inputs, captures, clean, strict=True):
        if after.residual is before.residual:
            of_lines.append(np.zeros((len(before.residual), one.scene.blocks.count)))
            continue
        args = one.scene.blocks, one.facts.sample_rate_hz
        means = block_residual(before, *args)[0] - block_residual(after, *args)[0]
        of_lines.append(np.nan_to_num(means))
    return clean, lines, of_lines


def _full_rate(one: RunInput, samples: Samples) -> FullRate:
    return full_rate(samples, one.facts, stream(0, "gap", one.facts.run_id))


def _codes(one: RunInput, samples: Samples, run: FullRate) -> list[Codes | None]:
    """Cells of each gyro's voltages; none where its converter rests."""
    facts = one.facts
    if facts.sample_rate_hz < SLOWEST_HZ:
        return [None] * facts.n_gyros
    second = max(int(facts.sample_rate_hz), 16)
    middle = np.arange(len(samples.stamp_s) // second, dtype=np.float64) + 0.5
    seconds: Array = middle * (second / facts.sample_rate_hz)
    alpha = facts.profile.angle_at(seconds.copy())
    segment = facts.profile.segment_at(seconds)
    slow = np.column_stack(
        [
            *(segment == k for k in np.unique(segment)),
            *(np.cos(np.pi * m * seconds / max(seconds[-1:].sum(), 1.0)) for m in range(1, 7)),
            *(f(m * alpha) for m in (1, 2) for f in (np.cos, np.sin)),
        ]
    )
    volts = samples.counts * facts.least_count
    departure = samples.residual / SECONDS_PER_HOUR * (facts.polarity * facts.scale_factor)[:, None]
    return [
        None if run.at_rest[i] else codes(volts[i], departure[i], second, slow) for i in range(len(volts))
    ]


def _rounded_down(one: RunInput, bits: NDArray[np.int64]) -> Array:
    """What bits that are always 0 take off the mean of each gyro's readings [deg/h], (n,)."""
    facts, out = one.facts, np.zeros(len(bits))
    for i, m in enumerate(bits.tolist()):
        if m:
            codes = np.arange(1 << m, dtype=np.int32)
            lost = float(np.mean(EFFECTS["lost_bits"].forward(codes, {"bits": m}, None) - codes))  # type: ignore[arg-type]
            volts = lost * facts.least_count * facts.polarity[i]
            out[i] = volts / facts.scale_factor[i] * SECONDS_PER_HOUR
    return out


def _rails(
    captures: Sequence[Samples],
    full: Sequence[FullRate],
    inputs: Sequence[RunInput],
    constant: Sequence[Constant],
) -> dict[int, float]:
    """Where a gyro's noise has gone in some run: the volts at which its converter rests there."""
    rails: dict[int, float] = {}
    for samples, run, one in zip(captures, full, inputs, strict=True):
        for i in np.flatnonzero(run.at_rest).tolist():
            good = np.isfinite(samples.residual[i])
            other = any(c.run == run.run_id and c.gyro == i and c.kind != "rail" for c in constant)
            if good.any() and not other:
                volts = float(np.median(np.abs(samples.counts[i, good]))) * one.facts.least_count
                rails[i] = max(rails.get(i, 0.0), volts)
    return rails
