"""Bandwidth of a gyro by runs in which the table swings, and its response at the swing's frequencies."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.swings import SwingRun
from fogreduce.characterise.quantity import K95, Quantity, undetermined
from fogreduce.characterise.steps import LEAST_COSINE
from fogreduce.characterise.swing_fit import OnePole, Samples, fit_one_pole, fitted
from fogreduce.estimate.swing import RateSteps
from fogreduce.physics.low_pass import bandwidth_hz

Array = NDArray[np.float64]

#: Samples that a rate must hold for: level, edge and what follows it.
LEAST_SAMPLES = 4
_HARMONICS = 8  # rows of the response's table
_NEIGHBOURS = (-5, -4, -3, 3, 4, 5)  # lines beside a harmonic that show noise alone
_NONE = (
    "a run whose table swings (+5 and -5 deg/s for 0.25 s each, ten times and more), its encoder logged; "
    "fogreduce plan writes one"
)


@dataclass(frozen=True)
class Swung:
    """A gyro in a swing: its samples without spurious ones, and the pole that describes them."""

    run: SwingRun
    gyro: int
    samples: Samples
    pole: OnePole


@dataclass(frozen=True)
class Line:
    """Response at a frequency [Hz]: gain, phase [deg], their standard errors; NaN where it is not seen."""

    frequency_hz: float
    gain: float
    gain_std: float
    phase_deg: float
    phase_std_deg: float


def swung_gyros(swings: Sequence[SwingRun]) -> tuple[list[Swung], dict[int, list[str]]]:
    """Each gyro in each swing that can tell its pole; and by gyro why the others cannot."""
    found: list[Swung] = []
    needs: dict[int, list[str]] = {}
    for one in swings:
        for gyro in range(one.facts.n_gyros):
            samples = samples_of(one, gyro)
            if abs(samples.along) < LEAST_COSINE:
                needs.setdefault(gyro, []).append("a swing about an axis that the gyro senses")
                continue
            least = LEAST_SAMPLES * one.step_s
            if one.swing.half_s < least:
                said = f"a swing whose rates hold for {least:.3g} s or more ({LEAST_SAMPLES} samples)"
                needs.setdefault(gyro, []).append(said)
                continue
            fit = fit_one_pole(samples)
            if fit is None:
                needs.setdefault(gyro, []).append("a longer swing: too few samples of it")
            elif not fit[1].seen and fit[1].bound_s is None:
                half = f"{one.swing.half_s:.3g} s"
                said = f"a swing whose rates hold for longer than {half}, until the gyro settles"
                needs.setdefault(gyro, []).append(said)
            else:
                found.append(Swung(one, gyro, *fit))
    return found, needs


def samples_of(one: SwingRun, gyro: int) -> Samples:
    """Samples of a gyro in a swing, its noise as yet taken to be white."""
    along = float(one.facts.axes[gyro] @ one.facts.commanded_signs)
    averaged, half_s = one.facts.is_increment, one.swing.half_s
    return Samples(one.time_s, one.rate[gyro], one.swing.steps, along, half_s, averaged, np.ones(1))


def bandwidth_quantity(gyro: int, swung: Sequence[Swung], needs: Mapping[int, list[str]]) -> Quantity:
    """The best known one of the runs; of runs that show no pole, the highest bound."""
    of = f"gyro{gyro + 1}"
    mine = [one for one in swung if one.gyro == gyro]
    seen = [one for one in mine if one.pole.seen]
    if seen:
        best = min(seen, key=lambda one: one.pole.std_s / one.pole.tau_s)
        tau, std = best.pole.tau_s, best.pole.std_s
        low, high = bandwidth_hz(tau + K95 * std), bandwidth_hz(tau - K95 * std)
        note = f"{_of(best)}; time constant {1e3 * tau:.6g} ms, delay {1e3 * best.pole.delay_s:.4g} ms"
        return Quantity("bandwidth", of, "Hz", bandwidth_hz(tau), low, high, note=note)
    bounds = [(bandwidth_hz(one.pole.bound_s), one) for one in mine if one.pole.bound_s is not None]
    if bounds:
        least, best = max(bounds, key=lambda pair: pair[0])
        note = f"{_of(best)}; no pole is seen: a lower bound (95 %), of a filter of one pole"
        return Quantity("bandwidth", of, "Hz", least, least, note=note)
    return undetermined("bandwidth", of, "Hz", "; ".join(dict.fromkeys(needs.get(gyro, [_NONE]))))


def _of(one: Swung) -> str:
    source = (
        "the encoder's log" if one.run.swing.by_encoder else "the command: the table's own lag counts too"
    )
    return f"run {one.run.facts.run_id}, by {source}"


def response_lines(one: Swung) -> list[Line]:
    """Gain and phase at the fundamental and its odd harmonics, to half the Nyquist frequency.

    The fitted pole's response and what the fit leaves at the frequency, over the table's rate there: what the
    pole makes of higher harmonics, which samples show at lower frequencies, is so taken away.
    """
    swing, samples, pole = one.run.swing, one.samples, one.pole
    if not swing.is_periodic:
        return []
    half = float(swing.change_s[-1] - swing.change_s[0]) / (swing.change_s.size - 1)
    periods = (swing.change_s.size - 1) // 2
    start, duration = float(swing.change_s[0]), 2 * half * periods
    left = samples.rate - fitted(samples, pole)
    inside = np.isfinite(left) & (samples.time_s >= start) & (samples.time_s < start + duration)
    time_s, left = samples.time_s[inside], left[inside]
    lines = []
    for k in range(_HARMONICS):
        frequency = (2 * k + 1) / (2 * half)
        if frequency > 1 / (4 * samples.step_s):
            break
        given = pole.scale * samples.along * _amplitude(swing.steps, start, duration, frequency)
        if samples.averaged:
            given *= np.sinc(frequency * samples.step_s) * np.exp(-1j * np.pi * frequency * samples.step_s)
        turn = 2j * np.pi * frequency
        model = np.exp(-turn * pole.delay_s) / (1 + turn * pole.tau_s)
        near = [_line(time_s, left, frequency + j / duration) for j in _NEIGHBOURS]
        std = math.sqrt(float(np.mean(np.abs(near) ** 2)) / 2) / abs(given)
        response = complex(model + _line(time_s, left, frequency) / given)
        phase, phase_std = math.degrees(np.angle(response)), math.degrees(std / abs(response))
        if not pole.seen:  # then neither is the delay, to less than a sample
            phase = phase_std = math.nan
        lines.append(Line(frequency, abs(response), std, phase, phase_std))
    return lines


def _line(time_s: Array, values: Array, frequency: float) -> complex:
    return complex(np.mean(values * np.exp(-2j * np.pi * frequency * time_s)))


def _amplitude(steps: RateSteps, start: float, duration: float, frequency: float) -> complex:
    """Mean of ``rate exp(-2 pi i f t)`` over the swing, exactly."""
    edge = np.clip(np.append(steps.edge_s, np.inf), start, start + duration)
    turn = 2j * np.pi * frequency
    waves = np.exp(-turn * edge)
    return complex(np.sum(steps.rate_deg_s * (waves[:-1] - waves[1:])) / (turn * duration))
