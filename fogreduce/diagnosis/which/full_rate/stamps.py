"""Time stamps against pulses: a clock that runs fast or slow, or stamps that bend.

Stamps are whole microseconds, and a steady clock's rounding is no noise: an error that adds up to less than
half a microsecond in a run changes no stamp, and one of a few microseconds is a staircase whose slope and
bend are not those of the clock.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.inference.evidence import log_mean_exp
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.estimate.clock import STAMP_TOLERANCE_PULSES, STAMP_TOLERANCE_S

Array = NDArray[np.float64]

_STEP_US = 1.0
#: Of a step, what a staircase may bend by: one step where it bends most.
_BENDS = 3.0
#: Stamps that must agree for a jump to last, and how many jumps are looked at.
_LASTING, _MOST_JUMPS = 8, 200
_CERTAIN = 50.0  # ln of odds


@dataclass(frozen=True)
class Stamps:
    """A run's stamps against its pulses.

    Attributes
    ----------
    ppm, ppm_std : float
        Rate of the stamps less that of the pulses; its error from scatter, infinite where nothing is known.
    rounding_ppm : float
        Its error from whole microseconds.
    bend : float
        Normal deviate of a bend beyond what whole microseconds make.
    jump_s : float
        What the stamps jump by, for good, where they jump most: at the start from 0, or later [s].
    """

    ppm: float
    ppm_std: float
    rounding_ppm: float
    bend: float
    jump_s: float = 0.0


def stamps(stamp_s: Array, rate_hz: float) -> Stamps:
    """Straight line and bend of stamps (N,) [s], NaN where none is; scatter at least that of rounding."""
    # an interval of a part of a microsecond makes a staircase of its own
    pulse_s = np.rint(np.arange(len(stamp_s)) * (1e6 / rate_hz / _STEP_US)) * (_STEP_US * 1e-6)
    there = np.isfinite(stamp_s)
    x, y = pulse_s[there], (stamp_s - pulse_s)[there]
    if x.size < 8 or np.ptp(x) == 0.0:
        return Stamps(0.0, np.inf, 0.0, 0.0)
    jumps = _jumps(y, max(STAMP_TOLERANCE_S, STAMP_TOLERANCE_PULSES / rate_hz))
    jump = float(jumps[np.argmax(np.abs(jumps))])
    y = y - np.cumsum(jumps)
    far = np.abs(y - np.median(y))
    near = far <= max(10.0 * float(np.median(far)), 1e-3)
    if not near.all():
        x, y = x[near], y[near]
    u = (x - x.mean()) / np.ptp(x)
    bend = u * u - np.mean(u * u)
    bend -= u * ((bend @ u) / (u @ u))
    slope, bent = float(u @ y) / float(u @ u), float(bend @ y) / float(bend @ bend)
    left = y - np.mean(y) - slope * u - bent * bend
    step, length = 1e-6 * _STEP_US, float(np.ptp(x))
    scatter = max(float(np.std(left)), step / np.sqrt(12.0))
    # the more steps, the better does their staircase follow the clock
    rounding = step / np.sqrt(12.0) / (1.0 + 2.0 * abs(slope) / step)
    beyond = np.sign(bent) * max(abs(bent) - _BENDS * step, 0.0)
    return Stamps(
        slope / length * 1e6,
        scatter / np.sqrt(float(u @ u)) / length * 1e6,
        rounding / length * 1e6,
        float(beyond * np.sqrt(bend @ bend) / scatter),
        jump,
    )


def _jumps(late_s: Array, tolerance_s: float) -> Array:
    """Jumps (N,) [s] of stamps less pulses that last, and by how much the first stamps are off; else 0.

    A stamp that is wrong by itself is none.
    """
    jumps = np.zeros(late_s.size)
    first = float(np.median(late_s[:_LASTING]))
    if abs(first) > tolerance_s:
        jumps[0] = first
    for k in np.flatnonzero(np.abs(np.diff(late_s)) > tolerance_s)[:_MOST_JUMPS].tolist():
        before = np.median(late_s[max(k + 1 - _LASTING, 0) : k + 1])
        lasting = float(np.median(late_s[k + 1 : k + 1 + _LASTING]) - before)
        if abs(lasting) > tolerance_s:
            jumps[k + 1] = lasting
    return jumps


def stamp_findings(runs: Mapping[str, Stamps], allowed: frozenset[str]) -> Iterator[Finding]:
    """A clock that runs fast or slow, the same in all runs; or stamps that bend.

    Parameters
    ----------
    runs : run id -> Stamps
    allowed : names of effects
    """
    for name, one in runs.items():
        if one.jump_s != 0.0:
            # no clock does that: the odds are as good as certain, whatever its scatter
            yield Finding(
                "unknown", ("clock",), (name,), _CERTAIN, 2.0 * _CERTAIN, {}, 1.0, f"stamps of {name}",
                "link", "time_stamps",
            )  # fmt: skip
    with_rate = {name: one for name, one in runs.items() if np.isfinite(one.ppm_std)}
    if not with_rate:
        return
    each = list(with_rate.values())
    ppm, log_b, snr2 = clock_evidence(each)
    # stamped t / (1 + e): shows -e / (1 + e)
    error = -ppm * 1e-6 / (1.0 + ppm * 1e-6) * 1e6
    std = float(np.hypot(sum(one.ppm_std**-2 for one in each) ** -0.5, min(one.rounding_ppm for one in each)))
    effect = "clock_error" if "clock_error" in allowed else "unknown"
    given = {"ppm": (error, std)} if effect != "unknown" else {}
    yield Finding(effect, ("clock",), ("*",), log_b, snr2, given, 1.0, "stamps", "link", "time_stamps")
    spread = sum((one.ppm - ppm) ** 2 / (one.ppm_std**2 + one.rounding_ppm**2) for one in each)
    bend = sum(one.bend**2 for one in each)
    # the steps of rounding are no white noise: only what is far beyond it counts
    left = max(spread * (len(each) > 1) + bend - 50.0 * len(each), 0.0)
    log_left = 0.5 * left - 0.5 * len(each) * np.log1p(left) - 3.0
    yield Finding(
        "unknown", ("clock",), tuple(with_rate), log_left, left, {}, 1.0, "stamps", "link", "time_stamps"
    )


def clock_evidence(runs: Sequence[Stamps]) -> tuple[float, float, float]:
    """Rate [ppm] that all runs share, ln B of it, and twice the gain in ln likelihood."""
    weight = np.array([one.ppm_std**-2 for one in runs])
    # a longer run's staircase says more of the clock
    whole = np.array([1.0 / (one.ppm_std**2 + one.rounding_ppm**2) for one in runs])
    ppm = np.array([one.ppm for one in runs])
    seen, std = float(weight @ ppm / weight.sum()), float(weight.sum() ** -0.5)
    snr2 = (seen / std) ** 2
    scales = std * np.geomspace(3.0, 1e7, 15)
    logs = -0.5 * np.log1p((scales / std) ** 2) + 0.5 * snr2 / (1.0 + (std / scales) ** 2)
    return float(whole @ ppm / whole.sum()), float(log_mean_exp(logs)), snr2
