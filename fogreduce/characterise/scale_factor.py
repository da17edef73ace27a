"""Scale factor in IEEE's sense: slope, nonlinearity, asymmetry, hysteresis, repeatability, threshold."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.shapes import Shape
from fogreduce.characterise.definitions import Definitions
from fogreduce.characterise.left_open import scale_factor_is_open
from fogreduce.characterise.quantity import Quantity, largest_error, normal, not_negative, undetermined
from fogreduce.characterise.spread import spread_of_values
from fogreduce.characterise.steps import Steps, line, scale_factor_of, staircases, steps_of
from fogreduce.constants import SECONDS_PER_HOUR

Array = NDArray[np.float64]

_PPM = 1e6
_FEWEST_RATES = 4  # two degrees of freedom about a straight line
_READING = 0.1  # of full scale, from which on a part of the reading makes sense
#: A step tells whether a gyro answers where its reading is known to this part of what is expected.
_TELLS = 0.25
_LARGE = 10.0  # times the smallest input: steps that fix the line


def scale_factor_quantities(
    found: Derivation, gyro: int, shapes: list[Shape], choices: Definitions
) -> list[Quantity]:
    """All that the scale factor of a gyro has."""
    of = f"gyro{gyro + 1}"
    steps = steps_of(found, gyro, shapes)
    return [
        _scale_factor(found, gyro, of),
        _nonlinearity(steps, of, choices),
        _asymmetry(shapes, gyro, of),
        _hysteresis(steps, of),
        _repeatability(steps, of),
        *_thresholds(steps, of),
    ]


def _scale_factor(found: Derivation, gyro: int, of: str) -> Quantity:
    facts = found.readings[0].facts
    unit = f"{facts.raw_unit.name}/(deg/s)"
    relative = float(found.parameters.standard_errors[gyro, 1])
    if scale_factor_is_open(found, gyro):
        needs = "a run at a rate of some deg/s both ways about x, y and z, and a standstill"
        return undetermined("scale_factor", of, unit, needs)
    value = float(facts.scale_factor[gyro] * found.parameters.scale_ratio[gyro])
    return normal("scale_factor", of, unit, value, abs(value) * relative)


def _nonlinearity(steps: list[Steps], of: str, choices: Definitions) -> Quantity:
    """Largest departure from the straight line, of full scale or of the reading."""
    best: Quantity | None = None
    for one in staircases(steps, _FEWEST_RATES):
        residual, covariance = line(one)
        std = np.sqrt(np.diag(covariance))
        if choices.nonlinearity == "full_scale":
            scale = np.full(residual.size, one.full_scale)
        else:
            large = np.abs(one.expected) >= _READING * one.full_scale
            residual, std, scale = residual[large], std[large], np.abs(one.expected[large])
        value, half = float(np.max(np.abs(residual) / scale)), largest_error(std / scale)
        note = f"run {one.run}, {one.rate.size} steps up to {np.abs(one.rate).max():g} deg/s"
        quantity = not_negative("nonlinearity", of, "ppm", value * _PPM, half * _PPM, note)
        if best is None or (quantity.std or 0) < (best.std or 0):
            best = quantity
    needs = "a run with at least four rates about an axis that the gyro senses (a staircase)"
    return best or undetermined("nonlinearity", of, "ppm", needs)


def _asymmetry(shapes: list[Shape], gyro: int, of: str) -> Quantity:
    """2 (K+ - K-) / (K+ + K-): with K+- = K (1 +- a), 2 a."""
    for one in shapes:
        if one.name == "asymmetry" and one.gyro == gyro:
            return normal("asymmetry", of, "ppm", 2 * one.value, 2 * one.std)
    needs = "rates in both senses and a standstill (or two rates of each sense) within a run"
    return undetermined("asymmetry", of, "ppm", needs)


def _hysteresis(steps: list[Steps], of: str) -> Quantity:
    """Largest difference between readings at a rate reached from below and from above, of full scale."""
    best: Quantity | None = None
    for one in staircases(steps, 2):
        rows = []
        for rate in np.unique(one.rate):
            up, down = ((one.rate == rate) & (one.approached == way) for way in (1, -1))
            if up.any() and down.any():
                rows.append(up / up.sum() - down / down.sum())
        if not rows:
            continue
        difference = np.array(rows)
        off = difference @ (one.reading - one.expected)
        std = np.sqrt(np.diag(difference @ one.covariance @ difference.T))
        scale = one.full_scale / _PPM
        value, half = float(np.abs(off).max()) / scale, largest_error(std) / scale
        quantity = not_negative("hysteresis", of, "ppm", value, half, f"run {one.run}, {len(rows)} rates")
        if best is None or (quantity.std or 0) < (best.std or 0):
            best = quantity
    needs = "a run that reaches the same rate from a lower and from a higher one (a staircase up and down)"
    return best or undetermined("hysteresis", of, "ppm", needs)


def _repeatability(steps: list[Steps], of: str) -> Quantity:
    """Scatter of the scale factor between runs about the same axis."""
    by_axis: dict[str, list[tuple[float, float]]] = {}
    for one in steps:
        slope = scale_factor_of(one)
        if slope is not None:
            by_axis.setdefault(one.axis, []).append(slope)
    most = max(by_axis.values(), key=len, default=[])
    spread = spread_of_values([value for value, _ in most], [std for _, std in most])
    if spread is None:
        needs = "three runs or more, power cycled between them, each with two rates about the same axis"
        return undetermined("scale_factor_repeatability", of, "ppm", needs)
    value, low, high = (part * _PPM for part in (spread.value, spread.low, spread.high))
    note = f"{len(most)} runs"
    return Quantity("scale_factor_repeatability", of, "ppm", value, low, high, note=note)


def _thresholds(steps: list[Steps], of: str) -> list[Quantity]:
    """Threshold and dead band: between the largest input that is not answered and the smallest that is."""
    quantities = []
    tested = [pair for one in steps for pair in _answers(one)]
    for name, part, factor in (("threshold", 0.5, 1.0), ("dead_band", 0.1, 2.0)):
        if not tested:
            needs = "a run with steps of small rates beside two large ones, down to the threshold looked for"
            quantities.append(undetermined(name, of, "deg/h", needs))
            continue
        silent = [size for size, answer in tested if answer < part]
        below = max(silent, default=0.0)
        above = min((size for size, answer in tested if size > below), default=None)
        if above is None:
            needs = f"larger inputs: none up to {below:.3g} deg/h was answered"
            quantities.append(undetermined(name, of, "deg/h", needs))
            continue
        low, high = factor * below, factor * above
        note = "between two inputs tested; Earth's part is in them" if silent else "every input was answered"
        quantities.append(Quantity(name, of, "deg/h", (low + high) / 2, low, high, note=note))
    return quantities


def _answers(one: Steps) -> list[tuple[float, float]]:
    """Small inputs of a run [deg/h], and what part of what is expected the gyro gave."""
    size = np.abs(one.expected)
    large = size >= _LARGE * max(float(size.min()), 1e-9)
    small = np.flatnonzero(~large & (size < 0.05 * SECONDS_PER_HOUR))
    if np.unique(np.round(one.expected[large], 3)).size < 2 or small.size == 0:
        return []
    columns = np.column_stack((np.ones(one.rate.size), one.expected))
    from_large = np.zeros((2, one.rate.size))
    from_large[:, large] = np.linalg.pinv(columns[large])
    rows = np.eye(one.rate.size) - columns @ from_large
    off = rows @ (one.reading - one.expected)
    std = np.sqrt(np.diag(rows @ one.covariance @ rows.T))
    return [(float(size[k]), float(1 + off[k] / one.expected[k])) for k in small if std[k] < _TELLS * size[k]]
