"""Mistakes in run.yaml or calibration record that would make a run look as it does.

Each mistake is the run's facts with one thing changed, as it would be without the mistake. The mean curves of
all gyros are held against what the changed facts let expect of them; a mistake explains a run where little is
left of what was off. It says what a difference looks like, not what it is: mistakes that one run cannot tell
apart are all named.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from fogreduce.estimate.curve_projection import CurveProjection
from fogreduce.estimate.curve_terms import mean_rate_terms
from fogreduce.estimate.gyro_curves import expected_gyro_curves, rate_curve
from fogreduce.estimate.uncertainty import StatedErrors, stated_gyro_covariance
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.frames import AXES, DIRECTIONS_ENU, rotation
from fogreduce.physics.table_motion import Profile

Array = NDArray[np.float64]

#: Factors by which units are mixed up: 60 (min), 3600 (h), 180/pi, 6 (rpm), arc seconds, thousands.
_FACTORS = (2.0, 6.0, 10.0, 60.0, 100.0, math.degrees(1.0), 1e3, 3600.0, 1e4, math.degrees(3600.0), 1e6)
_LEAST_FACTOR = 1e-3  # a factor nearer to one that has a name is that one
#: A mistake explains a run where it leaves this part of chi-squared, a tenth of the difference, or less ...
_PART_LEFT = 0.01
#: ... or where what it leaves is as likely as one of so many normal deviations (upper tail 1e-4).
_QUANTILE = 3.719
_ALIKE = 10.0  # mistakes whose chi-squared differs by less are not told apart: odds of 150
_MOST_NAMED = 3


@dataclass(frozen=True)
class MeasuredCurve:
    """The fitted curve of a gyro's raw readings over a segment.

    Attributes
    ----------
    gyro : int
        From 0.
    theta : (4,) array
        a, p, q, e [raw unit, and a second].
    covariance : (4, 4) array
        Of theta, by noise.
    has_sine : bool
    """

    gyro: int
    theta: Array
    covariance: Array
    has_sine: bool


@dataclass(frozen=True)
class MeasuredSegment:
    """The gyros' curves over a segment of the commanded profile.

    Attributes
    ----------
    rate_deg_s : float
        The commanded rate.
    projection : CurveProjection
        On the curve that was fitted.
    mean : (4,) array
        Takes theta to the mean rate.
    curves : tuple of MeasuredCurve
    """

    rate_deg_s: float
    projection: CurveProjection
    mean: Array
    curves: tuple[MeasuredCurve, ...]

    @classmethod
    def of(cls, profile: Profile, segment: int, curves: Iterable[MeasuredCurve]) -> MeasuredSegment:
        """Of a segment of the profile, from 1."""
        rate, edges = float(profile.rate_deg_s[segment - 1]), profile.edges_s
        mean = mean_rate_terms(float(edges[segment - 1]), float(edges[segment]), math.radians(rate))
        return cls(rate, CurveProjection.of(profile, segment), mean, tuple(curves))

    def rows(self, curve: MeasuredCurve) -> Array:
        """Rows that take theta to what is compared: the mean rate and, with a sine, p and q."""
        return np.array([self.mean, *np.eye(4)[1:3]]) if curve.has_sine else self.mean[None, :]


Measured = Sequence[MeasuredSegment]


def likely_mistakes(facts: RunFacts, stated: StatedErrors, measured: Measured) -> list[str]:
    """What the run looks like, in words: the mistakes that explain it, the best first; none if none does.

    Parameters
    ----------
    facts : RunFacts
        As run.yaml and record have it.
    stated : StatedErrors
    measured : mapping
        The gyros' curves.
    """
    before = misfit(facts, stated, measured)
    freedom = sum(len(segment.rows(curve)) for segment in measured for curve in segment.curves)
    enough = max(_PART_LEFT * before, _chi_squared(freedom))
    found = [
        (left, words)
        for words, changed in _changes(facts, stated, measured)
        if (left := misfit(changed, stated, measured)) < min(enough, 0.5 * before)
    ]
    found.sort(key=lambda pair: pair[0])
    return [words for left, words in found if left < found[0][0] + _ALIKE][:_MOST_NAMED]


def misfit(facts: RunFacts, stated: StatedErrors, measured: Measured) -> float:
    """Chi-squared of the gyros' mean rates and sines about what the facts let expect."""
    total = 0.0
    for segment in measured:
        weights = _weights(facts, stated, segment)
        departures = _departures(facts, segment)
        for curve, weight, departure in zip(segment.curves, weights, departures, strict=True):
            left = segment.rows(curve) @ departure
            total += float(left @ weight @ left)
    return total


def _weights(facts: RunFacts, stated: StatedErrors, segment: MeasuredSegment) -> list[Array]:
    """Inverse covariance of what is compared of each curve: noise and stated errors."""
    covariances = stated_gyro_covariance(facts, stated, segment.projection)
    found = []
    for curve in segment.curves:
        noise, rows = curve.covariance / facts.scale_factor[curve.gyro] ** 2, segment.rows(curve)
        covariance = rows @ (noise + covariances[curve.gyro]) @ rows.T
        found.append(np.linalg.pinv(covariance, hermitian=True))
    return found


def _departures(facts: RunFacts, segment: MeasuredSegment) -> list[Array]:
    """Theta of each gyro's rate less what the facts let expect [deg/s]."""
    found = []
    expected = expected_gyro_curves(facts, segment.projection)
    for curve in segment.curves:
        theta = rate_curve(facts, curve.gyro, curve.theta)
        found.append(theta - expected[curve.gyro])
    return found


def _changes(facts: RunFacts, stated: StatedErrors, measured: Measured) -> Iterator[tuple[str, RunFacts]]:
    """Every mistake in words, and the facts without it."""
    yield from _of_the_table(facts, measured)
    yield from _of_the_readings(facts, measured)
    yield from _of_the_site(facts, stated, measured)


def _of_the_table(facts: RunFacts, measured: Measured) -> Iterator[tuple[str, RunFacts]]:
    if not facts.profile.rate_deg_s.any():
        return

    def turned(factor: float) -> RunFacts:
        profile = Profile(facts.profile.rate_deg_s * factor, facts.profile.duration_s)
        return replace(facts, profile=profile)

    yield "the other sign: the table turning the other way (table.profile)", turned(-1.0)
    yield "a table that stands still (table.profile)", turned(0.0)
    for factor in _FACTORS:
        yield f"a factor of {factor:.6g}: the table slower than commanded (table.profile)", turned(1 / factor)
        yield f"a factor of {factor:.6g}: the table faster than commanded (table.profile)", turned(factor)
    factor = _common_factor(facts, measured)
    if _is_new(factor):
        yield (
            f"a factor of {factor:.6g} to the commanded rate (table.profile or scale factors)",
            turned(factor),
        )
    for (k, name), sign in itertools.product(enumerate(AXES), (1.0, -1.0)):
        axis = sign * np.eye(3)[k]
        if not np.allclose(np.abs(axis @ facts.table_axis), 1.0):
            words = f"the rate of axis {'-' if sign < 0 else ''}{name} (table.axis)"
            yield words, replace(facts, table_axis=axis)


def _is_new(factor: float) -> bool:
    """Whether a measured factor is none of those that have a name."""
    named = (0.0, 1.0, -1.0, *_FACTORS, *(1 / each for each in _FACTORS))
    return (
        all(abs(factor - each) > _LEAST_FACTOR * abs(each) for each in named) and abs(factor) > _LEAST_FACTOR
    )


def _of_the_readings(facts: RunFacts, measured: Measured) -> Iterator[tuple[str, RunFacts]]:
    n = facts.n_gyros
    for i in range(n):
        signs = np.where(np.arange(n) == i, -1.0, 1.0)
        yield (
            f"the other sign: gyro{i + 1} (capture.polarity)",
            replace(facts, polarity=facts.polarity * signs),
        )
    yield "the other sign: every gyro (capture.polarity)", replace(facts, polarity=-facts.polarity)
    for k, name in enumerate(AXES):
        signs = np.where(np.arange(3) == k, -1.0, 1.0)
        turned = replace(facts, frame_signs=facts.frame_signs * signs)
        yield f"the other sign: axis {name} (frame_signs or H)", turned
    yield "the other sign: biases (calibration record)", replace(facts, bias=-facts.bias)
    for factor, size in itertools.product(_FACTORS, ("larger", "smaller")):
        by = factor if size == "larger" else 1 / factor
        words = f"a factor of {factor:.6g}: readings {size} than stated (raw_unit or scale factors)"
        yield words, replace(facts, scale_factor=facts.scale_factor * by, bias=facts.bias * by)
    for i, j in itertools.combinations(range(n), 2):
        order = np.arange(n)
        order[[i, j]] = j, i
        of_order = {name: getattr(facts, name)[order] for name in ("axes", "scale_factor", "bias")}
        yield f"gyro{i + 1} and gyro{j + 1} exchanged", replace(facts, **of_order)
    for i in range(n):
        factor = _factor_of(facts, measured, i)
        if min(abs(factor), abs(factor - 1.0), abs(factor + 1.0)) > _LEAST_FACTOR:
            scale_factor = facts.scale_factor.copy()
            scale_factor[i] *= factor
            words = f"a factor of {factor:.6g} in the scale factor of gyro{i + 1}"
            yield words, replace(facts, scale_factor=scale_factor)


def _of_the_site(facts: RunFacts, stated: StatedErrors, measured: Measured) -> Iterator[tuple[str, RunFacts]]:
    yield "a latitude of the other sign (site.latitude_deg)", replace(facts, latitude_deg=-facts.latitude_deg)
    azimuth = _azimuth_off(facts, stated, measured)
    if azimuth:
        size = "more" if azimuth > 0 else "less"
        words = f"an azimuth of about {abs(azimuth)} deg {size} (azimuth_deg or orientation)"
        yield words, _turned_by(facts, azimuth)
    for places in itertools.permutations(range(3)):
        for signs in itertools.product((1, -1), repeat=3):
            mounted = np.eye(3)[list(places)] * np.array(signs)[:, None]
            turned = mounted @ facts.unit_from_enu
            if np.linalg.det(mounted) < 0 or np.allclose(turned[:, 2], facts.unit_from_enu[:, 2]):
                continue  # a mirror image, or a matter of azimuth
            x, z = _direction(turned[0]), _direction(turned[2])
            where = " ".join(f"{'-' if s < 0 else ''}{AXES[k]}" for k, s in zip(places, signs, strict=True))
            words = f"x {x} and z {z}" if x and z else f"x y z where run.yaml has {where}"
            yield f"the orientation {words}", replace(facts, unit_from_enu=turned)


def _direction(vector: Array) -> str:
    """North, up, ... where a unit vector (east, north, up) points that way; empty where in between."""
    return next((name for name, way in DIRECTIONS_ENU.items() if np.allclose(vector, way)), "")


def _turned_by(facts: RunFacts, azimuth_deg: float) -> RunFacts:
    # Clockwise from above by a is a turn of the unit by -a about up: u0 R(up, -a)' = u0 R(up, a).
    turn = rotation(np.array(DIRECTIONS_ENU["up"]), math.radians(azimuth_deg))
    return replace(facts, unit_from_enu=facts.unit_from_enu @ turn)


def _azimuth_off(facts: RunFacts, stated: StatedErrors, measured: Measured) -> int:
    """By how much the azimuth would have to be changed to fit best, in whole degrees.

    What the gyros should read is linear in the azimuth's cosine and sine, so three azimuths give all.
    """
    angles = np.arange(-179, 181)
    total = np.zeros(angles.size)
    functions = np.array([np.ones(angles.size), np.cos(np.radians(angles)), np.sin(np.radians(angles))])
    for segment in measured:
        weights = _weights(facts, stated, segment)
        at = [_departures(_turned_by(facts, angle), segment) for angle in (0.0, 90.0, 180.0)]
        for curve, weight, zero, quarter, half in zip(segment.curves, weights, *at, strict=True):
            middle = (zero + half) / 2
            terms = np.array([middle, (zero - half) / 2, quarter - middle]).T
            left = segment.rows(curve) @ terms @ functions
            total += np.einsum("ka,kl,la->a", left, weight, left)
    return int(angles[np.argmin(total)])


def _rate_pairs(facts: RunFacts, measured: Measured) -> list[tuple[int, float, float]]:
    """Gyro, commanded and measured mean rate without Earth's part [deg/s], of every curve."""
    found = []
    for segment in measured:
        commanded = facts.axes @ facts.commanded_signs * segment.rate_deg_s
        for curve, departure in zip(segment.curves, _departures(facts, segment), strict=True):
            rate = float(commanded[curve.gyro])
            found.append((curve.gyro, rate, rate + float(segment.mean @ departure)))
    return found


def _common_factor(facts: RunFacts, measured: Measured) -> float:
    """Measured rates over commanded ones, by least squares over all gyros; 1 where none turns."""
    return _ratio(_rate_pairs(facts, measured))


def _factor_of(facts: RunFacts, measured: Measured, gyro: int) -> float:
    return _ratio([pair for pair in _rate_pairs(facts, measured) if pair[0] == gyro])


def _ratio(pairs: list[tuple[int, float, float]]) -> float:
    squares = math.fsum(commanded**2 for _, commanded, _ in pairs)
    return math.fsum(commanded * rate for _, commanded, rate in pairs) / squares if squares > 0 else 1.0


def _chi_squared(freedom: int) -> float:
    """The value that chi-squared of so many degrees of freedom exceeds with 1e-4 (Wilson and Hilferty)."""
    part = 2.0 / (9.0 * max(freedom, 1))
    return freedom * (1.0 - part + _QUANTILE * math.sqrt(part)) ** 3
