"""The true motion of the unit: how the table really follows its command, and where the unit lies."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.earth_rate import EarthPart
from fogreduce.physics.frames import seen_by_unit
from fogreduce.physics.table_motion import Profile, table_rates

Array = NDArray[np.float64]
_ONES = np.ones(3)


@dataclass(frozen=True)
class Ripple:
    """The rate is modulated by ``1 + amplitude cos(harmonic alpha + phase)``, alpha as commanded [rad]."""

    amplitude: float
    harmonic: int
    phase_rad: float


@dataclass(frozen=True)
class Vibration:
    """Angular vibration ``amplitude sin(2 pi f t + phase)`` [deg/s] about a unit vector of the unit frame."""

    amplitude_deg_s: float
    frequency_hz: float
    phase_rad: float
    axis: Array


@dataclass(frozen=True)
class Departure:
    """The table's angle less the commanded one: straight between corners, steady before and after them.

    Attributes
    ----------
    time_s, angle_rad : (k,) arrays
    """

    time_s: Array
    angle_rad: Array

    def angle_at(self, time_s: Array) -> Array:
        """Angle [rad] at times [s]."""
        return np.interp(time_s, self.time_s, self.angle_rad)

    def rate_at(self, time_s: Array) -> Array:
        """Rate [deg/s] at times [s]."""
        slopes = np.degrees(np.diff(self.angle_rad) / np.diff(self.time_s))
        padded = np.concatenate(([0.0], slopes, [0.0]))
        return padded[np.searchsorted(self.time_s, time_s, side="right")]


@dataclass(frozen=True)
class Motion:
    """What turns, how, and where.

    Attributes
    ----------
    profile : Profile
        As commanded.
    table_axis : (3,) array
        Unit frame.
    unit_from_enu : (3, 3) array
        u0, true.
    latitude_deg : float
        True.
    gain : float
        True rate over commanded rate; negative: the other sense.
    start_s : float
        The profile begins this long after the record [s].
    ripples, vibrations : tuples
    tilts_rad : tuple of (3,) arrays
        The unit sits turned on the table by each of these in turn: ``w -> w - tilt x w``.
    on_earth : bool
        False where there is no Earth's rate: a unit in orbit.
    departure : Departure or None
        What the table is known to have done beside all that.
    """

    profile: Profile
    table_axis: Array
    unit_from_enu: Array
    latitude_deg: float
    gain: float = 1.0
    start_s: float = 0.0
    ripples: tuple[Ripple, ...] = ()
    tilts_rad: tuple[Array, ...] = ()
    vibrations: tuple[Vibration, ...] = ()
    on_earth: bool = True
    departure: Departure | None = None

    @classmethod
    def nominal(cls, facts: RunFacts) -> Motion:
        """As the metadata state it."""
        return cls(facts.profile, facts.table_axis, facts.unit_from_enu, facts.latitude_deg)

    def rate_factor(self, commanded_rad: Array) -> Array | float:
        """True rate over commanded rate at commanded angles [rad]."""
        factor: Array | float = 1.0
        for ripple in self.ripples:
            factor = factor + ripple.amplitude * np.cos(ripple.harmonic * commanded_rad + ripple.phase_rad)
        return self.gain * factor

    def angle_at(self, time_s: Array) -> Array:
        """True table angle alpha [rad]: the exact integral of `rate_factor` over the commanded angle."""
        commanded = self.profile.angle_at(time_s - self.start_s)
        angle = commanded
        for ripple in self.ripples:
            n, phase = ripple.harmonic, ripple.phase_rad
            swing = np.sin(n * commanded + phase) - np.sin(phase)
            angle = angle + ripple.amplitude / n * swing
        angle = self.gain * angle
        return angle if self.departure is None else angle + self.departure.angle_at(time_s)

    def unit_rate(self, time_s: Array, alpha_rad: Array) -> Array:
        """The unit's rate w [deg/s], (3, N), in the unit frame, right-handed; `alpha_rad` from `angle_at`."""
        shifted = time_s - self.start_s
        rate = table_rates(self.profile, self.table_axis, _ONES, shifted)
        if self.ripples or self.gain != 1.0:
            rate *= self.rate_factor(self.profile.angle_at(shifted) if self.ripples else alpha_rad)
        if self.departure is not None:
            rate = rate + np.outer(self.table_axis, self.departure.rate_at(time_s))
        if self.on_earth:
            earth = EarthPart.of(self.table_axis, self.unit_from_enu, self.latitude_deg, _ONES)
            rate += earth.at(alpha_rad)
        for tilt in self.tilts_rad:
            rate = rate - np.cross(tilt, rate, axisb=0, axisc=0)
        for v in self.vibrations:
            turn = 2.0 * np.pi * v.frequency_hz * time_s + v.phase_rad
            rate = rate + np.outer(v.axis, v.amplitude_deg_s * np.sin(turn))
        return rate

    def seen(self, direction_enu: Array, alpha_rad: Array) -> Array:
        """A direction fixed in the room (east, north, up) as the unit sees it, (3, N)."""
        return seen_by_unit(self.table_axis, self.unit_from_enu @ direction_enu, alpha_rad)
