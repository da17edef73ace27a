"""What each gyro reads, noise apart, with its effects in the contract's order."""

import numpy as np

from withheld.arrays import Array
from withheld.chain.campaign import Run, Unit
from withheld.chain.motion import Motion, motion
from withheld.chain.temperature import Temperature
from withheld.chain.truth import Truth, across
from withheld.effects.entry import Entry, select
from withheld.effects.gyro import BIASES, SCALES, Scene, Shape, dead_zone
from withheld.effects.near import NEAR
from withheld.effects.strangers import STRANGERS, in_run

# What the catalogue has not, by name.
UNCATALOGUED: dict[str, Shape] = {**STRANGERS, **NEAR}


def true_axes(unit: Unit, truth: Truth, entries: list[Entry]) -> Array:
    """The gyros' axes in the unit frame, (n, 3): stated, tilted by what was drawn and by `axis_misalignment`.

    Of a stated tilt the part along the axis is removed.
    """
    axes = unit.axes
    tipped = axes.copy()
    if truth.axis_tilt_rad.any():
        tipped += np.einsum("ij,ijk->ik", truth.axis_tilt_rad, across(axes))
    for entry in entries:
        for i in entry.gyros():
            along = axes[i] / np.linalg.norm(axes[i])
            delta = np.array(entry.parameters["mrad"], dtype=float) * 1e-3
            tipped[i] = tipped[i] + delta - along * (along @ delta)
    return tipped


def _add(m: Array, scene: Scene, entries: list[Entry], shapes: dict[str, Shape]) -> None:
    for entry in entries:
        for i in entry.gyros():
            m[:, i] += shapes[entry.effect](scene, i, m[:, i], entry) * entry.wobble(scene.t)


def sense(
    run: Run, unit: Unit, truth: Truth, entries: tuple[Entry, ...], heat: Temperature, moving: Motion
) -> Array:
    """Readings M [deg/s], (k, n), for a motion that is already known; latency apart."""
    axes = true_axes(unit, truth, select(entries, run.run_id, "axis_misalignment"))
    scene = Scene(moving, heat, axes)
    m = (moving.w * np.array(run.frame_signs)) @ axes.T
    m += truth.turn_on_deg_h[run.run_id] / 3600.0
    _add(m, scene, select(entries, run.run_id, *BIASES), BIASES)
    strangers = [in_run(entry, run.run_id) for entry in select(entries, run.run_id, *UNCATALOGUED)]
    _add(m, scene, strangers, UNCATALOGUED)
    for effect in SCALES:
        _add(m, scene, select(entries, run.run_id, effect), SCALES)
    before = m.copy()
    for entry in select(entries, run.run_id, "crosstalk"):
        source = int(entry.parameters["source"][4:]) - 1
        for i in entry.gyros():
            m[:, i] += entry.number("ppm") * 1e-6 * before[:, source] * entry.wobble(scene.t)
    for entry in select(entries, run.run_id, "dead_zone"):
        for i in entry.gyros():
            m[:, i] += dead_zone(scene, i, m[:, i], entry)
    result: Array = m
    return result


def readings(
    run: Run, unit: Unit, truth: Truth, entries: tuple[Entry, ...], heat: Temperature, t: Array
) -> Array:
    """Readings M [deg/s], (k, n), at times `t` [s], noise and electronics apart.

    A gyro with `latency` answers with what it read that much earlier; before t = 0, with the reading at 0.
    """
    m = sense(run, unit, truth, entries, heat, motion(run, truth, entries, t))
    for entry in select(entries, run.run_id, "latency"):
        earlier = np.maximum(t - entry.number("ms") * 1e-3, 0.0)
        late = sense(run, unit, truth, entries, heat, motion(run, truth, entries, earlier))
        for i in entry.gyros():
            m[:, i] = late[:, i]
    return m
