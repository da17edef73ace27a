"""The table's encoder against the command: lag, rate and ripple."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.physics.table_motion import Profile

Array = NDArray[np.float64]

_HARMONICS = 8
_LEAST_ROWS = 12


@dataclass(frozen=True)
class EncoderSegment:
    """One segment of constant commanded rate, as the encoder saw it.

    Attributes
    ----------
    rate_deg_s, rate_err_deg_s : float
        Rate by the encoder and its standard error (white residuals).
    lag_s, lag_err_s : float
        How much later than commanded the table was at its angles; NaN at a standstill.
    ripple_deg, ripple_harmonic : float, int
        Largest amplitude of a harmonic 1 to 8 of the commanded angle, and its number; NaN, 0 where the
        segment is less than a turn.
    scatter_deg : float
        Standard deviation of what the straight line leaves.
    rows : int
    """

    number: int
    commanded_deg_s: float
    rate_deg_s: float
    rate_err_deg_s: float
    lag_s: float
    lag_err_s: float
    ripple_deg: float
    ripple_harmonic: int
    scatter_deg: float
    rows: int


def compare_with_command(
    time_s: Array, angle_deg: Array, profile: Profile, guard_s: float
) -> list[EncoderSegment]:
    """Each segment's encoder angle against the commanded one.

    Parameters
    ----------
    time_s, angle_deg : (k,) arrays
        The encoder's log.
    profile : Profile
        The command.
    guard_s : float
        Left out on both sides of an edge, start and end of the profile included [s].
    """
    found = []
    edges, angles = profile.edges_s, profile.edge_angles_deg
    first_angle = float(np.interp(0.0, time_s, angle_deg))
    for k, rate in enumerate(profile.rate_deg_s.tolist()):
        # The first edge too: the table starts from rest.
        inside = (time_s >= edges[k] + guard_s) & (time_s <= edges[k + 1] - guard_s)
        if np.count_nonzero(inside) < _LEAST_ROWS:
            continue
        since = time_s[inside] - edges[k]
        departure = angle_deg[inside] - first_angle - (angles[k] + rate * since)
        columns = np.array([np.ones_like(since), since]).T
        inverse = np.linalg.inv(columns.T @ columns)
        offset, slope = inverse @ (columns.T @ departure)
        left = departure - columns @ np.array([offset, slope])
        scatter = math.sqrt(float(left @ left) / (since.size - 2))
        errors = scatter * np.sqrt(np.diag(inverse))
        ripple, harmonic = _ripple(np.radians(rate * since), left)
        found.append(
            EncoderSegment(
                k + 1,
                rate,
                rate + float(slope),
                float(errors[1]),
                -float(offset) / rate if rate else math.nan,
                float(errors[0]) / abs(rate) if rate else math.nan,
                ripple,
                harmonic,
                scatter,
                int(since.size),
            )
        )
    return found


def _ripple(alpha_rad: Array, left_deg: Array) -> tuple[float, int]:
    if abs(alpha_rad[-1] - alpha_rad[0]) < 2 * math.pi:
        return math.nan, 0
    amplitudes = []
    for harmonic in range(1, _HARMONICS + 1):
        columns = np.array([np.cos(harmonic * alpha_rad), np.sin(harmonic * alpha_rad)]).T
        part = np.linalg.lstsq(columns, left_deg, rcond=None)[0]
        amplitudes.append(float(np.hypot(*part)))
    best = int(np.argmax(amplitudes))
    return amplitudes[best], best + 1
