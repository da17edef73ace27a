"""From readings to counts: volts, polarity, noise, filters, converters, in the contract's order."""

import numpy as np

from withheld.arrays import Array, Counts
from withheld.chain.campaign import Run, Unit
from withheld.chain.truth import Truth
from withheld.effects.entry import Entry, select

LARGEST_COUNT = 2147483647


def interference(run: Run, unit: Unit, entries: tuple[Entry, ...], t: Array) -> Array:
    """`periodic_interference`, (k, n) [deg/s]; departure `drift_hz_per_s`: the line's frequency drifts."""
    total = np.zeros((t.size, unit.n))
    for e in select(entries, run.run_id, "periodic_interference"):
        frequency = e.number("frequency_hz") + 0.5 * e.departure.get("drift_hz_per_s", 0.0) * t
        line = e.number("deg_h") / 3600.0 * np.sin(2 * np.pi * frequency * t + e.phase_rad(run.run_id))
        for i in e.gyros():
            total[:, i] += line * e.wobble(t)
    return total


def first_order(v: Array, step_s: float, tau_s: float) -> Array:
    """A first-order low-pass, exact for a signal that is straight between samples; it starts settled on v[0].

    y' = (v - y) / tau over one step in which v goes straight from v[k-1] to v[k]:
    y[k] = q y[k-1] + (g - q) v[k-1] + (1 - g) v[k],   q = exp(-step/tau), g = (1 - q) tau/step.
    """
    from scipy.signal import lfilter

    q = np.exp(-step_s / tau_s)
    g = (1.0 - q) * tau_s / step_s
    filtered, _ = lfilter([1.0 - g, g - q], [1.0, -q], v - v[0], zi=np.zeros(1))
    result: Array = v[0] + filtered
    return result


def filtered(run: Run, entries: tuple[Entry, ...], v: Array, step_s: float) -> Array:
    """`low_pass` on volts (k, n); departure `second_pole`: another at that share of the time constant."""
    v = v.copy()
    for e in select(entries, run.run_id, "low_pass"):
        tau = e.number("time_constant_ms") * 1e-3
        for i in e.gyros():
            v[:, i] = first_order(v[:, i], step_s, tau)
            if e.departure.get("second_pole", 0.0):
                v[:, i] = first_order(v[:, i], step_s, tau * e.departure["second_pole"])
    return v


def converted(run: Run, entries: tuple[Entry, ...], v: Array) -> Array:
    """`adc_nonlinearity`, then `saturation`, on volts (k, n).

    Departures: `second_harmonic`, a share of twice the converter's frequency; `knee`, above the limit volts
    still rise at that share of the slope.
    """
    v = v.copy()
    for e in select(entries, run.run_id, "adc_nonlinearity"):
        for i in e.gyros():
            turn = 2 * np.pi * v[:, i] / e.number("period_volts")
            shape = np.sin(turn) + e.departure.get("second_harmonic", 0.0) * np.sin(2.0 * turn)
            v[:, i] += e.number("volts") * shape
    for e in select(entries, run.run_id, "saturation"):
        for i in e.gyros():
            limit = e.number("volts")
            clipped = np.clip(v[:, i], -limit, limit)
            v[:, i] = clipped + e.departure.get("knee", 0.0) * (v[:, i] - clipped)
    return v


def volts(run: Run, unit: Unit, truth: Truth, m: Array) -> Array:
    """`v_i = polarity_i (C_i M_i + B_i)` with the scale factors and biases that were drawn, (k, n)."""
    scale = np.array(unit.scale_factor) * (1.0 + truth.scale_factor_rel)
    return np.array(run.polarity) * (scale * m + (np.array(unit.bias) + truth.bias_V))


def noise_volts(run: Run, unit: Unit, noise_deg_s: Array) -> Array:
    """Noise and interference [deg/s] as volts."""
    result: Array = np.array(run.polarity) * np.array(unit.scale_factor) * noise_deg_s
    return result


def counts(run: Run, entries: tuple[Entry, ...], v: Array) -> Counts:
    """Rounding, kept to +-2147483647, then `lost_bits`, (k, n) int64."""
    whole = np.clip(np.rint(v / run.volts_per_count), -LARGEST_COUNT, LARGEST_COUNT).astype(np.int64)
    for e in select(entries, run.run_id, "lost_bits"):
        for i in e.gyros():
            whole[:, i] &= ~((1 << int(e.parameters["bits"])) - 1)
    return whole
