"""Columns of the catalogue's effects: how each would change a campaign's block means, for small amplitudes.

A rival is an effect at a place; its columns span what it can do there, one set for each point of a grid over
parameters in which it is not linear.  The rivals with no amplitude at all (a swapped channel, a wrong sign)
are handled by their exact waveform.  Temperature rivals use the log, because that is what a diagnoser has;
where there is no log there are none.  Not among them: a converter's nonlinearity, whose free period lets it
imitate nearly anything slow at a single rate, and random processes, whose realisations can imitate any drift.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from withheld.arrays import Array
from withheld.chain.campaign import Run
from withheld.chain.injector import World
from withheld.chain.motion import Motion, motion
from withheld.chain.readings import sense
from withheld.chain.temperature import Temperature
from withheld.chain.truth import nominal
from withheld.clairvoyant.blocks import Metric, block_means, difference, fine_times
from withheld.effects.entry import Entry
from withheld.effects.gyro import BIASES, SCALES, Scene, Shape, dead_zone

Key = tuple[str, tuple[str, ...], tuple[str, ...]]
EVERY = ("*",)


@dataclass(frozen=True)
class Rival:
    """An effect at a place, with whitened columns (rows, k); `fixed` ones have one column of one length."""

    effect: str
    channels: tuple[str, ...]
    runs: tuple[str, ...]
    columns: Array
    fixed: bool = False

    @property
    def key(self) -> Key:
        """Effect, channels, runs."""
        return (self.effect, self.channels, self.runs)


@dataclass(frozen=True)
class _Run:
    """A run without anything wrong, on its fine times: motion, scene and readings (k, n) [deg/s]."""

    run: Run
    scene: Scene
    m: Array


def _nominal_runs(world: World) -> list[_Run]:
    campaign = world.campaign
    still = nominal(campaign)
    out = []
    for run in campaign.runs:
        t = fine_times(run)
        heat = world.heat[run.run_id]
        logged = Temperature(heat.time_s, heat.electronics_degC, heat.sensor_degC, heat.sensor_degC)
        moving = motion(run, still, (), t)
        m = sense(run, campaign.unit, still, (), logged, moving)
        out.append(_Run(run, Scene(moving, logged, campaign.unit.axes), m))
    return out


class _Builder:
    """Puts values of one gyro, or of all, into whitened columns."""

    def __init__(self, world: World, inner: Metric) -> None:
        self.world, self.inner = world, inner
        self.runs = _nominal_runs(world)
        self.n = world.campaign.unit.n
        sizes = [[f.shape[0] for f in filters] for filters in inner.filters]
        ends = np.cumsum([size for row in sizes for size in row]).tolist()
        self.start = {
            (r, i): [0, *ends][r * self.n + i] for r in range(len(self.runs)) for i in range(self.n)
        }
        self.rows = ends[-1]

    def place(self, parts: dict[tuple[int, int], Array]) -> Array:
        """Fine values (k, c) [deg/s] by (run, gyro) -> whitened columns (rows, c)."""
        width = next(iter(parts.values())).shape[1]
        column = np.zeros((self.rows, width))
        for (r, i), values in parts.items():
            matrix = self.inner.filters[r][i]
            start = self.start[r, i]
            column[start : start + len(matrix)] = matrix @ block_means(values) * 3600.0
        return column

    def gyro(self, i: int, *entries: Entry, shapes: dict[str, Shape]) -> Array:
        """One column an entry, for gyro i in every run in which the entry acts."""
        parts = {}
        for r, one in enumerate(self.runs):
            values = [
                shapes[e.effect](one.scene, i, one.m[:, i], e) * np.ones(one.scene.t.size)
                if e.acts_in(one.run.run_id)
                else np.zeros(one.scene.t.size)
                for e in entries
            ]
            parts[r, i] = np.stack(values, axis=-1)
        return self.place(parts)

    def moved(self, entries: tuple[Entry, ...]) -> Array:
        """One column an entry of the table's block, by a small finite step."""
        still = nominal(self.world.campaign)
        unit = self.world.campaign.unit
        parts: dict[tuple[int, int], Array] = {}
        for r, one in enumerate(self.runs):
            changes = []
            for entry in entries:
                moving: Motion = motion(one.run, still, (entry,), one.scene.t)
                changes.append(sense(one.run, unit, still, (), one.scene.temperature, moving) - one.m)
            for i in range(self.n):
                parts[r, i] = np.stack([change[:, i] for change in changes], axis=-1)
        return self.place(parts)

    def lines(self, frequency_hz: float) -> Array:
        """Sine and cosine on each gyro in each run, (rows, gyros, 2 runs)."""
        columns = np.zeros((self.rows, self.n, 2 * len(self.runs)))
        for r, one in enumerate(self.runs):
            turn = 2 * np.pi * frequency_hz * one.scene.t
            pair = np.stack([np.sin(turn), np.cos(turn)], axis=-1)
            for i in range(self.n):
                columns[:, i, 2 * r : 2 * r + 2] = self.place({(r, i): pair})
        return columns


def _unit(effect: str, parameter: str, value: float = 1.0, **others: object) -> Entry:
    return Entry(effect, (), EVERY, {parameter: value, **others})


def _gyro_rivals(b: _Builder, i: int) -> Iterator[Rival]:
    name = (f"gyro{i + 1}",)
    shapes = {**BIASES, **SCALES, "dead_zone": dead_zone}

    def rival(effect: str, *entries: Entry, runs: tuple[str, ...] = EVERY) -> Rival:
        return Rival(effect, name, runs, b.gyro(i, *entries, shapes=shapes))

    yield rival("bias_offset", _unit("bias_offset", "deg_h"))
    yield rival("bias_ramp", _unit("bias_ramp", "deg_h_per_h"))
    for tau in (10.0, 30.0, 100.0, 300.0, 1000.0):
        yield rival("warm_up", _unit("warm_up", "deg_h", tau_s=tau))
    if all(one.run.temperature for one in b.runs):
        yield rival("temperature_bias", _unit("temperature_bias", "deg_h_per_degC"))
        yield rival("temperature_rate_bias", _unit("temperature_rate_bias", "deg_h_per_degC_per_min"))
        yield rival("temperature_scale_factor", _unit("temperature_scale_factor", "ppm_per_degC"))
    yield rival("acceleration_bias", _unit("acceleration_bias", "deg_h_per_g"))
    yield rival(
        "magnetic_bias", *(_unit("magnetic_bias", "deg_h", field_direction=f) for f in np.eye(3).tolist())
    )
    yield rival("scale_factor_error", _unit("scale_factor_error", "ppm"))
    yield rival("scale_factor_asymmetry", _unit("scale_factor_asymmetry", "ppm"))
    yield rival("scale_factor_nonlinearity", _unit("scale_factor_nonlinearity", "ppm_at_10_deg_s"))
    for kind in ("threshold", "subtractive"):
        for width in np.geomspace(0.3, 100.0, 9):
            yield rival("dead_zone", _unit("dead_zone", "deg_h", float(width), kind=kind))
    for one in b.runs:
        here = (one.run.run_id,)
        yield rival("turn_on_bias", Entry("turn_on_bias", (), here, {"deg_h": 1.0}), runs=here)
        for share in np.linspace(0.0, 1.0, 14)[1:-1]:
            step = Entry("bias_step", (), here, {"deg_h": 1.0, "time_s": share * one.run.duration_s})
            yield rival("bias_step", step, runs=here)
    yield from _electronic_rivals(b, i)


def _electronic_rivals(b: _Builder, i: int) -> Iterator[Rival]:
    name = (f"gyro{i + 1}",)
    axes = b.world.campaign.unit.axes
    tips = {
        (r, i): (one.scene.motion.w * np.array(one.run.frame_signs))
        @ (np.eye(3) - np.outer(axes[i], axes[i]) / (axes[i] @ axes[i]))
        for r, one in enumerate(b.runs)
    }
    yield Rival("axis_misalignment", name, EVERY, b.place(tips))
    for j in range(b.n):
        if j != i:
            other = {(r, i): one.m[:, [j]] for r, one in enumerate(b.runs)}
            yield Rival("crosstalk", name, EVERY, b.place(other))
    late = {(r, i): np.gradient(one.m[:, [i]], one.scene.t, axis=0) for r, one in enumerate(b.runs)}
    if any(np.abs(values).max() > 1e-9 for values in late.values()):
        yield Rival("latency", name, EVERY, b.place(late))
        yield Rival("low_pass", name, EVERY, b.place(late))
    most = max(float(np.abs(one.m[:, i]).max()) for one in b.runs)
    for share in (0.5, 0.8, 0.99, 0.9999):
        clip = {
            (r, i): np.clip(one.m[:, [i]], -share * most, share * most) - one.m[:, [i]]
            for r, one in enumerate(b.runs)
        }
        yield Rival("saturation", name, EVERY, b.place(clip))


def _table_rivals(b: _Builder) -> Iterator[Rival]:
    small = {
        "table_rate_error": ("ppm", 1.0),
        "heading_error": ("deg", 0.01),
        "latitude_error": ("deg", 0.01),
    }
    for effect, (parameter, step) in small.items():
        yield Rival(effect, ("table",), EVERY, b.moved((_unit(effect, parameter, step),)))
    offset = b.moved((_unit("start_offset", "s", 0.05),))
    if np.abs(offset).max() > 1e-9:
        yield Rival("start_offset", ("table",), EVERY, offset)
    tilts = tuple(_unit("mount_rotation", "mrad", v) for v in (np.eye(3) * 0.1).tolist())
    yield Rival("mount_rotation", ("table",), EVERY, b.moved(tilts))
    if any(rate != 0.0 for one in b.runs for rate, _ in one.run.profile):
        for harmonic in (1, 2, 3, 4, 5, 6, 8, 12, 36):
            waves = (0.0, np.pi / 2)
            pair = tuple(
                _unit("table_rate_ripple", "ppm", 1.0, harmonic=harmonic, phase_rad=p) for p in waves
            )
            yield Rival("table_rate_ripple", ("table",), EVERY, b.moved(pair))
    for effect in ("scale_factor_error", "bias_offset"):
        shapes = {**BIASES, **SCALES}
        entry = _unit(effect, "ppm" if effect == "scale_factor_error" else "deg_h")
        total = sum(b.gyro(i, entry, shapes=shapes) for i in range(b.n))
        everyone = tuple(f"gyro{i + 1}" for i in range(b.n))
        yield Rival(effect, everyone, EVERY, np.asarray(total))


def _line_rivals(b: _Builder, frequencies: tuple[float, ...]) -> Iterator[Rival]:
    axes = b.world.campaign.unit.axes
    for frequency in frequencies:
        lines = b.lines(frequency)
        for i in range(b.n):
            yield Rival("periodic_interference", (f"gyro{i + 1}",), EVERY, lines[:, i])
        moved = np.einsum("rik,ia->rka", lines, axes).reshape(b.rows, -1)
        yield Rival("base_motion", ("table",), EVERY, moved)


def slow_lines(world: World) -> tuple[float, ...]:
    """Frequencies [Hz] at which a line could pass for something else: the first harmonics of the table's
    turning and of periods that the truth names, as far as blocks can see them.
    """
    found = {
        abs(rate) / 360.0 * k for run in world.campaign.runs for rate, _ in run.profile for k in (1, 2, 3)
    }
    for entry in world.entries:
        if "period_s" in entry.parameters:
            found |= {k / entry.parameters["period_s"] for k in (1, 2)}
        if "frequency_hz" in entry.parameters:
            found.add(float(entry.parameters["frequency_hz"]))
        if "lines_per_turn" in entry.parameters:
            turns = entry.parameters["lines_per_turn"] / 360.0
            found |= {abs(rate) * turns for run in world.campaign.runs for rate, _ in run.profile}
    longest = max(run.duration_s for run in world.campaign.runs)
    return tuple(sorted({round(f, 9) for f in found if 0.5 / longest < f < 0.45}))


def slow_rivals(world: World, inner: Metric, catalogue: frozenset[str]) -> list[Rival]:
    """All rivals of the catalogue with columns on block means."""
    b = _Builder(world, inner)
    everyone: list[Rival] = list(_table_rivals(b)) + list(_line_rivals(b, slow_lines(world)))
    for i in range(b.n):
        everyone += list(_gyro_rivals(b, i))
    everyone += _fixed_rivals(world, inner)
    return [rival for rival in everyone if rival.effect in catalogue]


def _fixed_rivals(world: World, inner: Metric) -> list[Rival]:
    n = world.campaign.unit.n
    bare = replace(world, truth=nominal(world.campaign), entries=())
    entries = [Entry("rotation_sense", ("table",))]
    entries += [Entry("polarity_error", (f"gyro{i + 1}",)) for i in range(n)]
    entries += [
        Entry("channel_swap", (f"gyro{i + 1}",), EVERY, {"with": f"gyro{j + 1}"})
        for i in range(n)
        for j in range(i + 1, n)
    ]
    return [
        Rival(e.effect, e.channels, e.runs, inner.white(difference(bare, (e,)))[:, None], fixed=True)
        for e in entries
    ]
