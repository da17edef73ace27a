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
from withheld.chain.injector import World
from withheld.chain.truth import nominal
from withheld.clairvoyant.blocks import Metric, difference
from withheld.clairvoyant.columns import Columns
from withheld.effects.entry import Entry
from withheld.effects.gyro import BIASES, SCALES, dead_zone

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


def _unit(effect: str, parameter: str, value: float = 1.0, **others: object) -> Entry:
    return Entry(effect, (), EVERY, {parameter: value, **others})


def _gyro_rivals(columns: Columns, i: int) -> Iterator[Rival]:
    name = (f"gyro{i + 1}",)
    shapes = {**BIASES, **SCALES, "dead_zone": dead_zone}

    def rival(effect: str, *entries: Entry, runs: tuple[str, ...] = EVERY) -> Rival:
        return Rival(effect, name, runs, columns.gyro(i, *entries, shapes=shapes))

    yield rival("bias_offset", _unit("bias_offset", "deg_h"))
    yield rival("bias_ramp", _unit("bias_ramp", "deg_h_per_h"))
    for tau in (10.0, 20.0, 30.0, 60.0, 100.0, 200.0, 300.0, 600.0, 1000.0):
        yield rival("warm_up", _unit("warm_up", "deg_h", tau_s=tau))
    if all(one.run.temperature for one in columns.runs):
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
    for one in columns.runs:
        here = (one.run.run_id,)
        yield rival("turn_on_bias", Entry("turn_on_bias", (), here, {"deg_h": 1.0}), runs=here)
        for share in np.linspace(0.0, 1.0, 14)[1:-1]:
            step = Entry("bias_step", (), here, {"deg_h": 1.0, "time_s": share * one.run.duration_s})
            yield rival("bias_step", step, runs=here)
    yield from _electronic_rivals(columns, i)


def _electronic_rivals(columns: Columns, i: int) -> Iterator[Rival]:
    name = (f"gyro{i + 1}",)
    axes = columns.world.campaign.unit.axes
    tips = {
        (r, i): (one.scene.motion.w * np.array(one.run.frame_signs))
        @ (np.eye(3) - np.outer(axes[i], axes[i]) / (axes[i] @ axes[i]))
        for r, one in enumerate(columns.runs)
    }
    yield Rival("axis_misalignment", name, EVERY, columns.place(tips))
    for j in range(columns.n):
        if j != i:
            other = {(r, i): one.m[:, [j]] for r, one in enumerate(columns.runs)}
            yield Rival("crosstalk", name, EVERY, columns.place(other))
    late = {(r, i): np.gradient(one.m[:, [i]], one.scene.t, axis=0) for r, one in enumerate(columns.runs)}
    if any(np.abs(values).max() > 1e-9 for values in late.values()):
        yield Rival("latency", name, EVERY, columns.place(late))
        yield Rival("low_pass", name, EVERY, columns.place(late))
    most = max(float(np.abs(one.m[:, i]).max()) for one in columns.runs)
    for share in (0.5, 0.8, 0.99, 0.9999):
        clip = {
            (r, i): np.clip(one.m[:, [i]], -share * most, share * most) - one.m[:, [i]]
            for r, one in enumerate(columns.runs)
        }
        yield Rival("saturation", name, EVERY, columns.place(clip))


def _table_rivals(columns: Columns) -> Iterator[Rival]:
    small = {
        "table_rate_error": ("ppm", 1.0),
        "heading_error": ("deg", 0.01),
        "latitude_error": ("deg", 0.01),
    }
    for effect, (parameter, step) in small.items():
        yield Rival(effect, ("table",), EVERY, columns.moved((_unit(effect, parameter, step),)))
    offset = columns.moved((_unit("start_offset", "s", 0.05),))
    if np.abs(offset).max() > 1e-9:
        yield Rival("start_offset", ("table",), EVERY, offset)
    tilts = tuple(_unit("mount_rotation", "mrad", v) for v in (np.eye(3) * 0.1).tolist())
    yield Rival("mount_rotation", ("table",), EVERY, columns.moved(tilts))
    if any(rate != 0.0 for one in columns.runs for rate, _ in one.run.profile):
        for harmonic in (1, 2, 3, 4, 5, 6, 8, 12, 36):
            waves = (0.0, np.pi / 2)
            pair = tuple(
                _unit("table_rate_ripple", "ppm", 1.0, harmonic=harmonic, phase_rad=p) for p in waves
            )
            yield Rival("table_rate_ripple", ("table",), EVERY, columns.moved(pair))
    for effect in ("scale_factor_error", "bias_offset"):
        shapes = {**BIASES, **SCALES}
        entry = _unit(effect, "ppm" if effect == "scale_factor_error" else "deg_h")
        total = sum(columns.gyro(i, entry, shapes=shapes) for i in range(columns.n))
        everyone = tuple(f"gyro{i + 1}" for i in range(columns.n))
        yield Rival(effect, everyone, EVERY, np.asarray(total))


def _line_rivals(columns: Columns, frequencies: tuple[float, ...]) -> Iterator[Rival]:
    axes = columns.world.campaign.unit.axes
    for frequency in frequencies:
        lines = columns.lines(frequency)
        for i in range(columns.n):
            yield Rival("periodic_interference", (f"gyro{i + 1}",), EVERY, lines[:, i])
        moved = np.einsum("rik,ia->rka", lines, axes).reshape(columns.rows, -1)
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
    columns = Columns(world, inner)
    everyone: list[Rival] = list(_table_rivals(columns)) + list(_line_rivals(columns, slow_lines(world)))
    for i in range(columns.n):
        everyone += list(_gyro_rivals(columns, i))
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
