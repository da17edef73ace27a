"""What stated uncertainties allow: linear propagation of calibration, mounting, site and table to x, y, z.

Each stated standard deviation, put alone into the forward physics and reduced nominally, adds some function
of time to the rates with Earth's part taken away. A fitted mean curve is linear in what is added, so its
coefficients, and with them mean rate and drift, have a covariance that is a sum over the sources. Noise is
not in it: that is the curve's own covariance.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.estimate.curve_projection import CurveProjection
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.alignment import axis_rates_from_gyro_rates, gyro_rates_from_axis_rates
from fogreduce.physics.earth_rate import add_earth_rate
from fogreduce.physics.frames import DIRECTIONS_ENU, across, rotation
from fogreduce.physics.raw_quantity import unit_of_capture
from fogreduce.physics.table_motion import Profile, table_rates

if TYPE_CHECKING:
    from fogreduce.metadata.calibration import CalibrationRecord
    from fogreduce.metadata.run import Run

Array = NDArray[np.float64]


#: What the uncertainty of a result comes from, noise apart.
GROUPS = ("calibration_record", "turn_on", "azimuth", "latitude", "table_rate")
#: Parameters of a gyro in a record's covariance, in the order of the departures.
_RECORD_PARAMETERS = ("scale_factor_rel", "bias_deg_h", "axis1_rad", "axis2_rad")


@dataclass(frozen=True)
class RecordCovariance:
    """Covariance of what a calibration record states of n gyros.

    Attributes
    ----------
    root : (4 n, 4 n) array
        A square root: root root' is the covariance of scale factor [relative], bias [deg/h] and the axis in
        two directions [rad], gyro after gyro.
    directions : (n, 2, 3) array
        Those directions, in the unit frame.
    """

    root: Array
    directions: Array

    @classmethod
    def of_plain(cls, stated: Mapping[str, Any], n_gyros: int) -> RecordCovariance | None:
        """From the record's block `covariance`; None where that leaves out a parameter or a direction."""
        names, n = list(stated["parameters"]), n_gyros
        wanted = [f"gyro{i + 1}.{name}" for i in range(n) for name in _RECORD_PARAMETERS]
        if set(names) != set(wanted) or np.shape(stated["axis_directions"]) != (2 * n, 3):
            return None
        order = [names.index(name) for name in wanted]
        matrix = np.array(stated["matrix"], float)[np.ix_(order, order)]
        size, turn = np.linalg.eigh((matrix + matrix.T) / 2)
        directions = np.array(stated["axis_directions"], float).reshape(n, 2, 3)
        return cls(turn * np.sqrt(np.maximum(size, 0.0)), directions)


@dataclass(frozen=True)
class StatedErrors:
    """Standard deviations that a run and its calibration record state.

    Attributes
    ----------
    scale_factor_rel, bias, axis_rad, turn_on_bias_deg_h : (n,) arrays
        Of each gyro; `bias` in the unit of the raw readings, `axis_rad` in each of two directions at right
        angles to its axis.
    azimuth_deg, latitude_deg, table_rate_ppm : float
    record : RecordCovariance or None
        Of a record that states one: it then stands in for the standard deviations of scale
        factor, bias and axis.
    """

    scale_factor_rel: Array
    bias: Array
    axis_rad: Array
    turn_on_bias_deg_h: Array
    azimuth_deg: float
    latitude_deg: float
    table_rate_ppm: float
    record: RecordCovariance | None = None

    @classmethod
    def of(cls, run: Run, record: CalibrationRecord) -> StatedErrors:
        """From the metadata models, the project's defaults where the record is silent."""
        covariance = None if record.covariance is None else record.covariance.model_dump(mode="json")
        stated = record.stated_uncertainty.model_dump(mode="json")
        return cls.of_plain(run.model_dump(mode="json"), stated, covariance)

    @classmethod
    def of_plain(
        cls,
        run: Mapping[str, Any],
        stated: Mapping[str, Any],
        covariance: Mapping[str, Any] | None = None,
    ) -> StatedErrors:
        """From run.yaml and a record's stated uncertainties as plain, validated data, defaults filled in.

        `covariance` as the record has it, None where it has none.
        """
        raw_unit = unit_of_capture(run["capture"])
        return cls(
            np.array(stated["scale_factor_rel"], float),
            np.array(stated[raw_unit.bias_key], float),
            np.array(stated["axis_rad"], float),
            np.array(stated["turn_on_bias_deg_h"], float),
            float(run["azimuth_uncertainty_deg"]),
            float(run["site"]["latitude_uncertainty_deg"]),
            float(run["table"]["rate_uncertainty_ppm"]),
            None if covariance is None else RecordCovariance.of_plain(covariance, len(stated["axis_rad"])),
        )


def gyro_departures(facts: RunFacts, stated: StatedErrors, time_s: Array) -> Array:
    """What each source, at one standard deviation, adds to the rates that the gyros read.

    Parameters
    ----------
    facts : RunFacts
    stated : StatedErrors
        One standard deviation of each source.
    time_s : (N,) array
        Times from the run's start [s].

    Returns
    -------
    (sources, n, N) array
        [deg/s]: scale factor, bias, axis (two directions) and turn-on bias of each gyro; then azimuth,
        latitude and table rate. Where the record states a covariance, the four of each gyro that it covers
        are independent combinations of all that it covers.
    """
    n = facts.n_gyros
    motion = axis_rates(facts, time_s)
    readings = gyro_rates_from_axis_rates(motion, facts.axes)
    found = np.zeros((5 * n + 3, n, time_s.size))
    record = stated.record
    for i in range(n):
        of_gyro = found[5 * i : 5 * i + 5, i]
        directions = across(facts.axes[i]) if record is None else record.directions[i]
        of_gyro[0], of_gyro[1] = readings[i], 1.0
        of_gyro[2], of_gyro[3] = (direction @ motion for direction in directions)
        of_gyro[4] = stated.turn_on_bias_deg_h[i] / SECONDS_PER_HOUR
        if record is None:
            bias, axis = stated.bias[i] / facts.scale_factor[i], stated.axis_rad[i]
            of_gyro[:4] *= np.array([stated.scale_factor_rel[i], bias, axis, axis])[:, None]
        else:
            of_gyro[1] /= SECONDS_PER_HOUR
    if record is not None:
        each = found[: 5 * n].reshape(n, 5, -1)
        each[:, :4] = (record.root.T @ each[:, :4].reshape(4 * n, -1)).reshape(n, 4, -1)
    # The true motion differs; gyros and reduction are nominal.
    for row, change in zip(found[5 * n :], motion_departures(facts, stated, time_s), strict=True):
        row[:] = gyro_rates_from_axis_rates(change, facts.axes)
    return found


def source_groups(n_gyros: int) -> list[str]:
    """Which of `GROUPS` each source of `gyro_departures` belongs to."""
    of_gyro = [GROUPS[0]] * 4 + [GROUPS[1]]
    return of_gyro * n_gyros + list(GROUPS[2:])


def departures(facts: RunFacts, stated: StatedErrors, time_s: Array) -> Array:
    """What each source of `gyro_departures` adds to x, y, z: (sources, 3, N) [deg/s].

    The unit must have three gyros or more.
    """
    projection = facts.projection
    assert projection is not None
    return np.array(
        [axis_rates_from_gyro_rates(added, projection) for added in gyro_departures(facts, stated, time_s)]
    )


def motion_departures(facts: RunFacts, stated: StatedErrors, time_s: Array) -> Array:
    """What azimuth, latitude and table rate, each one standard deviation off, add to what the axes read.

    Parameters
    ----------
    facts, stated :
        As `departures` takes them; a unit of any number of gyros.
    time_s : (N,) array
        Times from the run's start [s].

    Returns
    -------
    (3, 3, N) array
        [deg/s]: source (azimuth, latitude, table rate), axis of the unit, time.
    """
    found = []
    for change in (_azimuth(stated), _latitude(stated), _table_rate(stated)):
        high, low = (axis_rates(change(facts, sign), time_s) for sign in (1.0, -1.0))
        found.append((high - low) / 2)
    return np.array(found)


def stated_theta(facts: RunFacts, stated: StatedErrors, segment: int, terms: int = 4) -> Array:
    """What each source, at one standard deviation, adds to the mean curves of x, y, z.

    Parameters
    ----------
    facts, stated :
        As `departures` takes them.
    segment : int
        Of the profile, from 1.
    terms : int
        Of the curve that was fitted, as `CurveBasis.first` takes them.

    Returns
    -------
    (sources, 3, 4) array
        Of theta = (a, p, q, e) of each axis (see `fogreduce.estimate.mean_curve`), with sign: the same source
        moves axes and segments together.
    """
    projection = CurveProjection.of(facts.profile, segment, terms)
    return projected(projection, departures(facts, stated, projection.time_s))


def stated_covariance(facts: RunFacts, stated: StatedErrors, segment: int, terms: int = 4) -> Array:
    """Covariance of theta of x, y, z each, (3, 4, 4), by all sources of `stated_theta`; noise not in it."""
    return _covariance(stated_theta(facts, stated, segment, terms))


def stated_gyro_theta(facts: RunFacts, stated: StatedErrors, projection: CurveProjection) -> Array:
    """What each source adds to the curves of the rates that the gyros read: (sources, n, 4)."""
    return projected(projection, gyro_departures(facts, stated, projection.time_s))


def stated_gyro_covariance(facts: RunFacts, stated: StatedErrors, projection: CurveProjection) -> Array:
    """Covariance of theta of each gyro's rate, (n, 4, 4), by all sources."""
    return _covariance(stated_gyro_theta(facts, stated, projection))


def projected(projection: CurveProjection, added: Array) -> Array:
    """Theta of functions of time (sources, channels, N): (sources, channels, 4)."""
    theta: Array = added @ projection.to_theta.T
    return theta


def _covariance(theta: Array) -> Array:
    """Covariance of theta of each channel, from what each source adds to it."""
    covariance: Array = np.einsum("saj,sak->ajk", theta, theta)
    return covariance


def axis_rates(facts: RunFacts, time_s: Array) -> Array:
    """What the axes read in all, Earth's rate in it: (3, N) [deg/s]."""
    table = table_rates(facts.profile, facts.table_axis, facts.frame_signs, time_s)
    return add_earth_rate(table, facts.earth, facts.profile.angle_at(time_s))


Change = Callable[[RunFacts, float], RunFacts]


def _azimuth(stated: StatedErrors) -> Change:
    def change(facts: RunFacts, sign: float) -> RunFacts:
        # Clockwise from above by a is a turn of the unit by -a about up: u0 R(up, -a)' = u0 R(up, a).
        turn = rotation(np.array(DIRECTIONS_ENU["up"]), sign * np.radians(stated.azimuth_deg))
        return replace(facts, unit_from_enu=facts.unit_from_enu @ turn)

    return change


def _latitude(stated: StatedErrors) -> Change:
    return lambda facts, sign: replace(facts, latitude_deg=facts.latitude_deg + sign * stated.latitude_deg)


def _table_rate(stated: StatedErrors) -> Change:
    def change(facts: RunFacts, sign: float) -> RunFacts:
        rates = facts.profile.rate_deg_s * (1.0 + sign * stated.table_rate_ppm * 1e-6)
        return replace(facts, profile=Profile(rates, facts.profile.duration_s))

    return change
