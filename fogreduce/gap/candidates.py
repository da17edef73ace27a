"""Every effect at every place it may sit, as columns: what it would change in block means.

Columns are finite differences of the simulator's own chain with the effect in it. An effect that is not
linear in all its parameters has a grid of them; what has no amplitude (a swapped column, a dead zone of a
given
width) is its exact difference and is not scaled.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.effects.at import At, Place
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.effects.selection import Action, action
from fogreduce.effects.table import EFFECTS
from fogreduce.gap.capture import RunInput
from fogreduce.gap.noise_model import Whitener
from fogreduce.physics.frames import across
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.streams import stream

Array = NDArray[np.float64]
EVERY = ("*",)

#: One number scales these: parameter, and the small step of the finite difference.
LINEAR_GYRO = {
    "bias_offset": ("deg_h", 1.0),
    "bias_ramp": ("deg_h_per_h", 10.0),
    "temperature_bias": ("deg_h_per_degC", 1.0),
    "temperature_rate_bias": ("deg_h_per_degC_per_min", 1.0),
    "temperature_scale_factor": ("ppm_per_degC", 1.0),
    "scale_factor_error": ("ppm", 1.0),
    "scale_factor_asymmetry": ("ppm", 1.0),
    "scale_factor_nonlinearity": ("ppm_at_10_deg_s", 1.0),
    "acceleration_bias": ("deg_h_per_g", 1.0),
}
LINEAR_TABLE = {
    "table_rate_error": ("ppm", 1.0),
    "heading_error": ("deg", 0.01),
    "latitude_error": ("deg", 0.01),
}
WIDTHS_DEG_H = np.geomspace(0.05, 250.0, 56)
DELAYS_S = (0.02, 0.05, 0.15, 0.4, 1.0, 2.0, 3.0)
HARMONICS = (1, 2, 3, 4, 5, 6, 8, 9, 10, 12, 18, 24, 36)
_TAUS = 12
_FEW_PAIRS = 9
_CLIPS = np.linspace(0.5, 0.98, 9)


@dataclass(frozen=True)
class Candidate:
    """One effect at one place.

    Attributes
    ----------
    effect : str
    channels, runs : tuples of str
        As an effects file has them; runs ``("*",)`` for all.
    rows : slice
        The rows that it touches.
    columns : (rows, J, k) array
        Whitened; k columns a point of the grid.
    grid : tuple of mappings
        Parameters at each point, those that scale left out.
    scales : tuple of str
        What the k columns scale: parameter names, a component of a vector as ``mrad[0]``.
    steps : (J, k) array
        What a coefficient of one means in the parameter.
    fixed : bool
        Exact differences of a given size.
    positive : bool
        Its amplitude cannot be negative.
    share : float
        Prior share of the effect's name that this place has.
    known : bool
        False for what no effect of the catalogue does: a family of the unknown.
    feature, stage : str
        For a family of the unknown: the contract's words for where it shows.
    """

    effect: str
    channels: tuple[str, ...]
    runs: tuple[str, ...]
    rows: slice
    columns: Array
    grid: tuple[Mapping[str, Any], ...]
    scales: tuple[str, ...]
    steps: Array
    fixed: bool = False
    positive: bool = False
    share: float = 1.0
    known: bool = True
    feature: str = ""
    stage: str = "gyro"
    extra: Mapping[str, Any] = field(default_factory=dict)

    @property
    def key(self) -> tuple[str, tuple[str, ...], tuple[str, ...], str]:
        """Effect, channels, runs, and the other gyro of a pair."""
        return (
            self.effect,
            self.channels,
            self.runs,
            str(self.extra.get("source", self.extra.get("with", ""))),
        )

    @cached_property
    def flat(self) -> Array:
        """Columns as one matrix, (rows, J k)."""
        return self.columns.reshape(len(self.columns), -1)

    @cached_property
    def gram(self) -> Array:
        """Inner products of the columns at each point of the grid, (J, k, k)."""
        return pairs(self.columns, self.columns)


def pairs(x: Array, y: Array) -> Array:
    """Inner products over the first axis of (m, J, k) and (m, J, l), point by point: (J, k, l)."""
    j, k, columns = x.shape[1], x.shape[2], y.shape[2]
    if j == 1:
        return (x[:, 0].T @ y[:, 0])[None]
    out = np.empty((j, k, columns))
    if k * columns > _FEW_PAIRS:
        for point in range(j):
            out[point] = x[:, point].T @ y[:, point]
        return out
    for a in range(k):
        for b in range(columns):
            np.einsum("mj,mj->j", x[:, :, a], y[:, :, b], out=out[:, a, b])
    return out


class Builder:
    """Builds candidates about a chain that may have effects in it already.

    Parameters
    ----------
    inputs : runs
    whiten : Whitener
    base : actions
        In the chain already.
    allowed : names of effects
    rails : mapping
        Gyro -> volts at which its converter seems to rest.
    """

    def __init__(
        self,
        inputs: Sequence[RunInput],
        whiten: Whitener,
        base: Sequence[Action],
        allowed: frozenset[str],
        rails: Mapping[int, float],
    ) -> None:
        self.inputs, self.whiten, self.base = inputs, whiten, list(base)
        self.allowed, self.rails = allowed, rails
        self.n = inputs[0].facts.n_gyros
        self.ids = [one.facts.run_id for one in inputs]
        self.plain = [one.scene.block_means(base) for one in inputs]
        self.warm = all(one.scene.temperature is not None for one in inputs)
        self.turning = [bool(np.any(one.facts.profile.rate_deg_s != 0.0)) for one in inputs]
        self.names = [gyro_name(i) for i in range(self.n)]

    def all(self) -> list[Candidate]:
        """Every candidate whose effect is allowed and does anything at all in these runs."""
        found = [*self._gyros(), *self._pairs(), *self._table(), *self._wiring()]
        return [one for one in found if one.effect in self.allowed and np.any(one.columns)]

    # ---------------------------------------------------------------------------------- simulation

    def difference(self, specs: Sequence[tuple[str, Sequence[str], Mapping[str, Any]]]) -> Array:
        """What effects (name, channels, parameters) together change, unwhitened: (rows,) [deg/h]."""
        actions = [
            action(effect, channels, self.ids, parameters, self.n) for effect, channels, parameters in specs
        ]
        changed = [
            one.scene.block_means([*self.base, *actions]) - before
            for one, before in zip(self.inputs, self.plain, strict=True)
        ]
        return self.whiten.rows.stacked(changed)

    def _per_gyro(self, effect: str, parameters: Mapping[str, Any]) -> Array:
        return self.difference([(effect, self.names, parameters)])

    def gyro_columns(self, i: int, columns: Sequence[Array], run: int | None = None) -> Array:
        """Whitened rows of gyro i of unwhitened columns (rows,): (rows of i, number of columns)."""
        part = self.whiten.rows.of(i, run)
        return self.whiten(np.column_stack([column[part] for column in columns]), part)

    # ---------------------------------------------------------------------------------- candidates

    def _at_gyro(self, effect: str, i: int, columns: Array, **others: Any) -> Candidate:
        """A candidate at gyro i from whitened columns (rows of i, J, k)."""
        given: dict[str, Any] = {
            "effect": effect,
            "channels": (self.names[i],),
            "runs": EVERY,
            "rows": self.whiten.rows.of(i),
            "columns": columns,
            "grid": ({},) * columns.shape[1],
            "scales": (),
            "steps": np.ones(columns.shape[1:]),
            "share": 1.0 / self.n,
        }
        return Candidate(**{**given, **others})

    def _gyros(self) -> Iterator[Candidate]:
        for effect, (name, step) in LINEAR_GYRO.items():
            if effect not in self.allowed or (EFFECTS[effect].needs_temperature and not self.warm):
                continue
            one = self._per_gyro(effect, {name: step})
            for i in range(self.n):
                white = self.gyro_columns(i, [one])[:, None, :]
                yield self._at_gyro(effect, i, white, scales=(name,), steps=np.array([[step]]))
            if effect in ("bias_offset", "scale_factor_error") and self.n > 1:
                yield Candidate(
                    effect,
                    tuple(self.names),
                    EVERY,
                    slice(0, self.whiten.rows.total),
                    self.whiten(one[:, None])[:, None, :],
                    ({},),
                    (name,),
                    np.array([[step]]),
                    share=0.05,
                )
        yield from self._shaped()
        yield from self._turn_on_and_steps()
        yield from self._late()
        yield from self._dead_zones()
        yield from self._clipped()

    def _shaped(self) -> Iterator[Candidate]:
        longest = max(one.scene.blocks.count * one.scene.blocks.length_s for one in self.inputs)
        taus = np.geomspace(longest / 60.0, 2.0 * longest, _TAUS)
        if "warm_up" in self.allowed:
            columns = [self._per_gyro("warm_up", {"deg_h": 1.0, "tau_s": tau}) for tau in taus.tolist()]
            grid = tuple({"tau_s": tau} for tau in taus.tolist())
            for i in range(self.n):
                white = self.gyro_columns(i, columns)[:, :, None]
                yield self._at_gyro("warm_up", i, white, scales=("deg_h",), grid=grid)
        if "magnetic_bias" in self.allowed:
            field_columns = [
                self._per_gyro("magnetic_bias", {"deg_h": 1.0, "field_direction": tuple(f)})
                for f in np.eye(3).tolist()
            ]
            names = tuple(f"field[{k}]" for k in range(3))
            for i in range(self.n):
                yield self._at_gyro(
                    "magnetic_bias", i, self.gyro_columns(i, field_columns)[:, None, :], scales=names
                )
        if "axis_misalignment" in self.allowed:
            tips = [across(axis) for axis in self.inputs[0].facts.axes]
            both = [
                self.difference(
                    [
                        ("axis_misalignment", [name], {"mrad": tuple((0.1 * tip[k]).tolist())})
                        for name, tip in zip(self.names, tips, strict=True)
                    ]
                )
                for k in range(2)
            ]
            for i in range(self.n):
                yield self._at_gyro(
                    "axis_misalignment",
                    i,
                    self.gyro_columns(i, both)[:, None, :],
                    scales=("tip[0]", "tip[1]"),
                    steps=np.full((1, 2), 0.1),
                    extra={"tips": tips[i]},
                )

    def _turn_on_and_steps(self) -> Iterator[Candidate]:
        rows, runs = self.whiten.rows, len(self.ids)
        stepped: dict[int, Array] = {}
        for i in range(self.n):
            for r, run_id in enumerate(self.ids):
                matrix = self.whiten.filters[i, r]
                if "turn_on_bias" in self.allowed:
                    one = matrix.sum(axis=1)[:, None, None]
                    yield self._at_gyro(
                        "turn_on_bias",
                        i,
                        one,
                        runs=(run_id,),
                        rows=rows.of(i, r),
                        scales=("deg_h",),
                        share=1.0 / self.n / runs,
                    )
                if "bias_step" in self.allowed and len(matrix) > 2:
                    if id(matrix) not in stepped:
                        # a unit step at each block's start, whitened: sums of the filter's columns from there
                        # on
                        stepped[id(matrix)] = np.cumsum(matrix[:, ::-1], axis=1)[:, ::-1][:, 1:]
                    length = self.inputs[r].scene.blocks.length_s
                    times = ((np.arange(len(matrix) - 1) + 1) * length).tolist()
                    yield self._at_gyro(
                        "bias_step",
                        i,
                        stepped[id(matrix)][:, :, None],
                        runs=(run_id,),
                        rows=rows.of(i, r),
                        grid=tuple({"time_s": time} for time in times),
                        scales=("deg_h",),
                        share=1.0 / self.n / runs,
                    )

    def _late(self) -> Iterator[Candidate]:
        wanted = [e for e in ("latency", "low_pass") if e in self.allowed]
        if not wanted:
            return
        late = self._per_gyro("latency", {"ms": 10.0})
        if not np.any(np.abs(late) > 1e-9):
            return
        for i in range(self.n):
            white = self.gyro_columns(i, [late])[:, None, :]
            # a filter of a given time constant delays what is slower than itself by that much
            for effect, name in (("latency", "ms"), ("low_pass", "time_constant_ms")):
                if effect in wanted:
                    yield self._at_gyro(
                        effect, i, white, scales=(name,), steps=np.array([[10.0]]), positive=True
                    )

    def _dead_zones(self) -> Iterator[Candidate]:
        if "dead_zone" not in self.allowed:
            return
        effect = EFFECTS["dead_zone"]
        for kind in ("threshold", "subtractive"):
            parts = []
            for one in self.inputs:
                blocks, place = one.scene.blocks, Place("", 0, (), self.n, partial(stream, 0, "gap"))
                early = [a for a in self.base if self._is_early(a)]
                forward = ForwardRun(one.facts, None, early, one.scene.temperature, turning=one.scene.turning)
                m = forward.readings(blocks.time_s)
                at = At(place, blocks.time_s, 1.0, forward.motion, forward.axes[0], None, m, m[0])
                changes = [
                    blocks.means(effect.forward(m, {"deg_h": width, "kind": kind}, at) - m)
                    for width in WIDTHS_DEG_H.tolist()
                ]
                parts.append(np.array(changes) * SECONDS_PER_HOUR)
            grid = tuple({"deg_h": width, "kind": kind} for width in WIDTHS_DEG_H.tolist())
            for i in range(self.n):
                columns = np.concatenate([part[:, i] for part in parts], axis=1).T
                if np.any(columns):
                    rows = self.whiten.rows.of(i)
                    yield self._at_gyro(
                        "dead_zone",
                        i,
                        self.whiten(columns, rows)[:, :, None],
                        grid=grid,
                        fixed=True,
                        share=0.5 / self.n,
                    )

    @staticmethod
    def _is_early(one: Action) -> bool:
        return one.effect.stage < EFFECTS["dead_zone"].stage

    def _clipped(self) -> Iterator[Candidate]:
        if "saturation" not in self.allowed:
            return
        facts = self.inputs[0].facts
        limits = []
        for i in range(self.n):
            largest = max(
                float(np.abs(p[i]).max()) / SECONDS_PER_HOUR * abs(facts.scale_factor[i]) for p in self.plain
            )
            limits.append([self.rails[i]] if i in self.rails else (_CLIPS * largest).tolist())
        # what clips one gyro changes no other: all are clipped at once
        columns = [
            self.difference(
                [
                    ("saturation", [name], {"volts": own[min(k, len(own) - 1)]})
                    for name, own in zip(self.names, limits, strict=True)
                ]
            )
            for k in range(max(len(own) for own in limits))
        ]
        for i, own in enumerate(limits):
            white = self.gyro_columns(i, columns[: len(own)])[:, :, None]
            grid = tuple({"volts": v} for v in own)
            yield self._at_gyro("saturation", i, white, grid=grid, fixed=True)

    def _pairs(self) -> Iterator[Candidate]:
        if "crosstalk" not in self.allowed:
            return
        for shift in range(1, self.n):
            sources = [self.names[(i + shift) % self.n] for i in range(self.n)]
            one = self.difference(
                [
                    ("crosstalk", [name], {"ppm": 1.0, "source": source})
                    for name, source in zip(self.names, sources, strict=True)
                ]
            )
            for i, source in enumerate(sources):
                yield self._at_gyro(
                    "crosstalk",
                    i,
                    self.gyro_columns(i, [one])[:, None, :],
                    scales=("ppm",),
                    grid=({"source": source},),
                    share=1.0 / self.n / (self.n - 1),
                    extra={"source": source},
                )

    def _of_table(
        self,
        effect: str,
        columns: Sequence[Array],
        k: int,
        grid: Sequence[Mapping[str, Any]],
        scales: tuple[str, ...],
        steps: Array,
        **others: Any,
    ) -> Candidate:
        white = self.whiten(np.column_stack(columns)).reshape(-1, len(grid), k)
        rows = slice(0, self.whiten.rows.total)
        return Candidate(
            effect, ("table",), EVERY, rows, white, tuple(grid), scales, steps, stage="table", **others
        )

    def _table(self) -> Iterator[Candidate]:
        table = ["table"]
        for effect, (name, step) in LINEAR_TABLE.items():
            if effect in self.allowed:
                one = self.difference([(effect, table, {name: step})])
                yield self._of_table(effect, [one], 1, [{}], (name,), np.array([[step]]))
        if "mount_rotation" in self.allowed:
            tilts = [
                self.difference([("mount_rotation", table, {"mrad": tuple(t)})])
                for t in (0.1 * np.eye(3)).tolist()
            ]
            names = tuple(f"mrad[{k}]" for k in range(3))
            yield self._of_table("mount_rotation", tilts, 3, [{}], names, np.full((1, 3), 0.1))
        if not any(self.turning):
            return
        if "start_offset" in self.allowed:
            delays = [*DELAYS_S, *(-s for s in DELAYS_S)]
            late = [self.difference([("start_offset", table, {"s": s})]) for s in delays]
            yield self._of_table(
                "start_offset", late, 1, [{} for _ in delays], ("s",), np.array(delays)[:, None]
            )
        if "table_rate_ripple" in self.allowed:
            waves = [
                self.difference(
                    [("table_rate_ripple", table, {"ppm": 1.0, "harmonic": n, "phase_rad": phase})]
                )
                for n in HARMONICS
                for phase in (0.0, np.pi / 2)
            ]
            grid = [{"harmonic": n} for n in HARMONICS]
            steps = np.ones((len(grid), 2))
            yield self._of_table("table_rate_ripple", waves, 2, grid, ("cos", "sin"), steps)

    def _wiring(self) -> Iterator[Candidate]:
        rows = slice(0, self.whiten.rows.total)

        def exact(effect: str, channel: str, share: float, **parameters: Any) -> Candidate:
            one = self.difference([(effect, [channel], parameters)])
            stage = "table" if channel == "table" else "link"
            white = self.whiten(one[:, None])[:, None, :]
            return Candidate(
                effect,
                (channel,),
                EVERY,
                rows,
                white,
                (parameters,),
                (),
                np.ones((1, 1)),
                fixed=True,
                share=share,
                stage=stage,
                extra=parameters,
            )

        if "rotation_sense" in self.allowed and any(self.turning):
            yield exact("rotation_sense", "table", 1.0)
        for i, name in enumerate(self.names):
            if "polarity_error" in self.allowed:
                yield exact("polarity_error", name, 1.0 / self.n)
            for other in self.names[i + 1 :] if "channel_swap" in self.allowed else []:
                share = 2.0 / self.n / (self.n - 1)
                yield exact("channel_swap", name, share, **{"with": other})
