"""A filter of one pole, ``tau y' = v - y``: its response to samples, to rates that step, and its bandwidth.

The gain is ``1 / sqrt(1 + (2 pi f tau)^2)``: it falls by 3 dB (to ``1 / sqrt(2)``) at ``1 / (2 pi tau)``.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def bandwidth_hz(tau_s: float) -> float:
    """Frequency [Hz] at which the response has fallen by 3 dB; and tau [s] of a bandwidth."""
    return 1.0 / (2.0 * math.pi * tau_s)


def of_samples(v: Array, step_s: float, tau_s: float, before: tuple[float, float] | None = None) -> Array:
    """The response at samples (N,) of a v that is straight between them.

    ``y[k] = q y[k-1] + (g - q) v[k-1] + (1 - g) v[k]``, q = exp(-dt / tau), g = (1 - q) tau / dt.

    Parameters
    ----------
    v : (N,) array
    step_s : float
        Time between samples [s].
    tau_s : float
        Time constant [s], above 0.
    before : (float, float), optional
        y and v of the sample before; without it y has settled on v[0].
    """
    x = step_s / tau_s
    q, g = math.exp(-x), -math.expm1(-x) / x
    y, last = (v[0], v[0]) if before is None else before
    driven = (1.0 - g) * v
    driven[0] += (g - q) * last
    driven[1:] += (g - q) * v[:-1]
    return first_order(driven, q, y)


def first_order(driven: Array, q: Array | float, start: float) -> Array:
    """``y[k] = q[k] y[k - 1] + driven[k]``, y[-1] = `start`, without a loop over samples.

    By doubling: after the pass of lag d, each sample holds the sum over its last 2 d drives; passes end when
    what is kept of a drive d samples ago is nothing beside 1. `q` is one number or one a sample, (N,).
    """
    y = driven.copy()
    kept = np.asarray(q)
    y[0] += kept.flat[0] * start
    lag = 1
    while lag < len(y):
        late = kept[lag:] if kept.ndim else kept
        if late.max() <= 1e-20:
            break
        y[lag:] += late * y[:-lag].copy()
        kept = np.concatenate((kept[:lag], late * kept[:-lag])) if kept.ndim else kept * kept
        lag = 2 * lag
    return y


def of_steps(edge_s: Array, v: Array, tau_s: float, time_s: Array) -> Array:
    """The response at any times (N,) of a v that steps: v[k] holds from edge_s[k] on.

    Between edges ``y = v[k] - D[k] exp(-(t - edge[k]) / tau)``, D[k] = D[k-1] exp(-dt / tau) + v[k] - v[k-1];
    y has settled on v[0] at the first edge.

    Parameters
    ----------
    edge_s, v : (k,) arrays
        Rising edges [s], and the value from each on.
    tau_s : float
        Time constant [s], above 0.
    time_s : (N,) array
    """
    decay = np.exp(-np.diff(edge_s, prepend=edge_s[0]) / tau_s)
    behind = first_order(np.diff(v, prepend=v[0]), decay, 0.0)
    at = np.maximum(np.searchsorted(edge_s, time_s, side="right") - 1, 0)
    since = np.maximum(time_s - edge_s[at], 0.0)
    response: Array = v[at] - behind[at] * np.exp(-since / tau_s)
    return response
