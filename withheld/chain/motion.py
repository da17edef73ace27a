"""The unit's true motion, and the effects of table, site and mounting on it."""

from dataclasses import dataclass

import numpy as np

from withheld.arrays import Array
from withheld.chain.attitude import earth_deg_s, room_to_unit, seen_from_table
from withheld.chain.campaign import Run
from withheld.chain.truth import Truth
from withheld.effects.entry import Entry, select

TABLE_EFFECTS = (
    "table_rate_error", "table_rate_ripple", "heading_error", "latitude_error", "rotation_sense",
    "start_offset", "mount_rotation", "base_motion",
)  # fmt: skip


@dataclass(frozen=True)
class Motion:
    """Times t [s] (k,), unit rate w [deg/s] (k, 3) in the unit frame, true table angle [rad] (k,) and its
    axis (3,), and u0 (3, 3); `commanded_deg` [deg] (k,) is what the table was told.
    """

    t: Array
    w: Array
    alpha_rad: Array
    commanded_deg: Array
    axis: Array
    u0: Array

    def seen(self, room: Array) -> Array:
        """A direction fixed in the room (east, north, up) as the unit sees it, (k, 3)."""
        return seen_from_table(self.u0 @ room, self.axis, self.alpha_rad)


def commanded(run: Run, t: Array) -> tuple[Array, Array]:
    """Commanded rate [deg/s] and angle [deg] at times `t` [s]; outside the profile it stands."""
    rates = np.array([0.0] + [rate for rate, _ in run.profile] + [0.0])
    starts = np.concatenate([[0.0], np.cumsum([duration for _, duration in run.profile])])
    angles = np.concatenate([[0.0], np.cumsum([rate * duration for rate, duration in run.profile])])
    place = np.searchsorted(starts, t, side="right")
    since = np.where(place > 0, t - starts[place - 1], 0.0)
    base = np.where(place > 0, angles[place - 1], 0.0)
    return rates[place], base + rates[place] * since


def motion(run: Run, truth: Truth, entries: tuple[Entry, ...], t: Array) -> Motion:
    """The true motion at times `t` [s], with the effects of the first block that act in this run."""
    acting = select(entries, run.run_id, *TABLE_EFFECTS)
    full = _motion(run, truth, acting, t)
    wobbling = [entry for entry in acting if entry.departure.get("wobble", 0.0)]
    if not wobbling:
        return full
    w = full.w.copy()
    for entry in wobbling:
        without = _motion(run, truth, [other for other in acting if other is not entry], t)
        w += (full.w - without.w) * (np.asarray(entry.wobble(t)) - 1.0)[:, None]
    return Motion(t, w, full.alpha_rad, full.commanded_deg, full.axis, full.u0)


def _motion(run: Run, truth: Truth, acting: list[Entry], t: Array) -> Motion:
    def total(effect: str, parameter: str) -> float:
        return float(sum(e.parameters[parameter] for e in acting if e.effect == effect))

    later = t - total("start_offset", "s")
    rate, angle = commanded(run, later)
    told = angle
    gain = (1.0 + truth.table_ppm * 1e-6) * (1.0 + total("table_rate_error", "ppm") * 1e-6)
    if any(e.effect == "rotation_sense" for e in acting):
        gain = -gain
    ripple, swing = np.zeros_like(t), np.zeros_like(t)
    for e in acting:
        if e.effect == "table_rate_ripple":
            n, phase, size = e.number("harmonic"), e.phase_rad(run.run_id), e.number("ppm") * 1e-6
            ripple = ripple + size * np.cos(n * np.deg2rad(told) + phase)
            # the integral of rate cos(n alpha + phi) over time is sin(n alpha + phi) / n over the angle
            swing = swing + np.rad2deg(size / n) * (np.sin(n * np.deg2rad(told) + phase) - np.sin(phase))
    rate, angle = gain * rate * (1.0 + ripple), gain * (angle + swing)

    azimuth = run.azimuth_deg + truth.azimuth_deg[run.run_id] + total("heading_error", "deg")
    latitude = run.latitude_deg + truth.latitude_deg + total("latitude_error", "deg")
    u0, axis = room_to_unit(run.orientation, azimuth), np.array(run.axis)
    alpha = np.deg2rad(angle)
    w = rate[:, None] * axis + seen_from_table(u0 @ earth_deg_s(latitude), axis, alpha)
    for e in acting:
        if e.effect == "mount_rotation":
            w = w - np.cross(np.array(e.parameters["mrad"]) * 1e-3, w)
    for e in acting:
        if e.effect == "base_motion":
            direction = np.array(e.parameters["axis"], dtype=float)
            direction /= np.linalg.norm(direction)
            turn = 2 * np.pi * e.number("frequency_hz") * t + e.phase_rad(run.run_id)
            w = w + (e.number("deg_h") / 3600.0 * np.sin(turn))[:, None] * direction
    return Motion(t, w, alpha, told, axis, u0)
