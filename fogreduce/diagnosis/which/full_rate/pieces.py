"""What short pieces of a stream, each less its straight line and tapered, show of a process: their averaged
spectrum.

A piece's length lets strong lines leak into weak ones; what is expected has that in it, as the captures have.
"""

from __future__ import annotations

from functools import lru_cache, partial
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.diagnosis.observe.full_rate import PIECE, straightened, taper
from fogreduce.effects.at import At, Place
from fogreduce.effects.electronics import low_pass
from fogreduce.physics.noise import flicker_density, walk_density
from fogreduce.simulate.streams import stream

Array = NDArray[np.float64]

FINE = 2048  # frequencies at which a spectrum is taken: longer than a filter's memory and a piece


def filter_gains(tau_ms: Array, rate_hz: float, frequency: Array) -> Array:
    """Power (3, taus, F) of white noise of variance 1 after a first-order low pass, as pieces show it.

    What stands between the noise's samples and the filter is left open by its time constant alone: the
    simulator's own filter, of noise straight from sample to sample; one that takes sample by sample,
    ``y[k] = q y[k-1] + (1 - q) v[k]``, ``q = exp(-dt / tau)``; and one of noise white in continuous time,
    sampled after it, whose correlation is ``q^|k|`` as well, at the level ``(x / 2) coth(x / 2)``,
    ``x = dt / tau``, of what folds back (Astrom and Wittenmark, Computer-Controlled Systems, 1997, ch. 10).
    What leaks from a piece's strong low lines into its weak high ones is in it.

    Parameters
    ----------
    tau_ms : (taus,) array
    rate_hz : float
    frequency : (F,) array
        Lines of the pieces' spectrum, as fractions of the sample rate, one after another.
    """
    x = 1e3 / rate_hz / tau_ms[:, None]
    q = np.exp(-x)
    turn = 2.0 * np.pi * np.fft.fftfreq(FINE)
    one_pole = (1.0 - q) ** 2 / (1.0 + q * q - 2.0 * q * np.cos(turn))
    folded = one_pole * (0.5 * x / np.tanh(0.5 * x))
    powers = np.array([_responses(tau_ms.tobytes(), rate_hz), one_pole, folded])
    return shown_by_pieces(powers, frequency)


def shown_by_pieces(power: Array, frequency: Array) -> Array:
    """What pieces less their straight lines show (..., F) of a spectrum (..., FINE) at even frequencies."""
    gains = np.empty((*power.shape[:-1], len(frequency)))
    starts = np.flatnonzero(np.diff(frequency, prepend=np.inf) <= 0.0).tolist()
    for first, stop in pairwise([*starts, len(frequency)]):
        lines = frequency[first:stop]
        length = round((stop - first - 1) / (lines[-1] - lines[0])) if stop - first > 1 else PIECE
        gains[..., first:stop] = power @ _seen_by(length, lines.tobytes()).T
    return gains


@lru_cache(maxsize=64)
def _responses(tau_ms: bytes, rate_hz: float) -> Array:
    """Power gains (taus, FINE) of the simulator's own low pass at even frequencies all round."""
    responses = []
    for tau in np.frombuffer(tau_ms, np.float64).tolist():
        impulse = np.zeros(FINE)
        impulse[1] = 1.0
        place = Place("", 0, (), 1, partial(stream, 0, "gap"))
        nowhere: Any = None  # a filter looks at nothing but its input
        at = At(place, impulse, 1.0 / rate_hz, nowhere, impulse, None, impulse, impulse)
        responses.append(np.abs(np.fft.fft(low_pass(impulse, {"time_constant_ms": tau}, at))) ** 2)
    return np.array(responses)


@lru_cache(maxsize=8)
def _seen_by(length: int, frequency: bytes) -> Array:
    """How much of each of FINE even frequencies a line of a piece's spectrum shows, (F, FINE)."""
    lines = np.frombuffer(frequency, np.float64)
    waves = taper(length) * np.exp(-2j * np.pi * np.outer(lines, np.arange(length)))
    # a line of the piece less its straight line is the piece times the tapered wave less its own
    windows = straightened(waves.real) + 1j * straightened(waves.imag)
    result: Array = np.abs(np.fft.fft(windows.conj(), FINE)) ** 2 / (length * FINE)
    return result


def shown_drift(rate_hz: float, frequency: Array, flicker: Array | float, walk: Array | float) -> Array:
    """Power (..., F) [(deg/h)^2] in pieces of flicker B [deg/h] and a walk K [deg/h/sqrt(h)], (...,).

    A walk goes by steps from sample to sample: its density is that of the walk in continuous time times
    ``(x / sin x)^2``, ``x = pi f dt``.
    """
    fine = np.abs(np.fft.fftfreq(FINE)[1:]) * rate_hz
    flicker, walk = np.asarray(flicker)[..., None], np.asarray(walk)[..., None]
    steps = np.sinc(fine / rate_hz) ** -2.0
    density = flicker_density(flicker, fine) + walk_density(walk, fine) * steps
    whole = np.concatenate([np.zeros((*density.shape[:-1], 1)), 0.5 * rate_hz * density], axis=-1)
    return shown_by_pieces(whole, frequency)
