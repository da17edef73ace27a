"""Departures from a linear scale factor and a constant bias, each fitted beside the linear solution.

IEEE 952: asymmetry is what the scale factor differs by between the two senses; the polynomial in the rate is
its nonlinearity. Temperature terms are those of the sensors' log. Each is fitted alone: together, what one
campaign cannot tell apart would hide behind the other.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fogreduce.calibrate.equations import Product
from fogreduce.calibrate.solution import Prior, Solution, solve
from fogreduce.constants import SECONDS_PER_HOUR

#: Bias by a magnetic field along the gyro's axis.
MAGNETIC = "magnetic"
#: Shape -> (name of the effect or coefficient, unit, what a value of 1 in deg/h stands for in that unit).
UNITS = {
    "asymmetry": ("ppm", 1e6 / SECONDS_PER_HOUR),
    "quadratic": ("ppm per deg/s", 1e6 / SECONDS_PER_HOUR),
    "cubic": ("ppm at 10 deg/s", 100.0 * 1e6 / SECONDS_PER_HOUR),
    "temperature_bias": ("deg/h per degC", 1.0),
    "temperature_scale_factor": ("ppm per degC", 1e6 / SECONDS_PER_HOUR),
    "electronics_bias": ("deg/h per degC", 1.0),
    "warming_bias": ("deg/h per degC/min", 1.0),
    "acceleration_x": ("deg/h per g", 1.0),
    "acceleration_y": ("deg/h per g", 1.0),
    "acceleration_z": ("deg/h per g", 1.0),
    MAGNETIC: ("deg/h per mT", 1.0),
}
#: Fitted together: an acceleration along one axis of the unit is none along another.
ACCELERATION = ("acceleration_x", "acceleration_y", "acceleration_z")
#: A shape is stated where the campaign knows it better than this, in its unit.
_WORST = {
    "asymmetry": 1e4,
    "quadratic": 1e4,
    "cubic": 1e4,
    "temperature_bias": 1e2,
    "temperature_scale_factor": 1e4,
    "electronics_bias": 1e2,
    "warming_bias": 1e3,
    **dict.fromkeys(ACCELERATION, 1e2),
    MAGNETIC: 1e3,
}


@dataclass(frozen=True)
class Shape:
    """A departure of one gyro: value and standard error in `unit`."""

    name: str
    gyro: int
    value: float
    std: float
    unit: str


#: The polynomial of the scale factor beside its linear term.
_POLYNOMIAL = ("quadratic", "cubic")


def polynomial(
    products: Sequence[Product], solution: Solution, prior: Prior, shapes: Sequence[Shape]
) -> Solution | None:
    """The solution with the terms of the polynomial together; None where none of them is determined.

    Parameters
    ----------
    products, solution, prior
        As of the linear solution.
    shapes : sequence of Shape
        Each fitted alone: a term counts where every gyro's is determined.
    """
    gyros = solution.layout.gyros
    terms = tuple(name for name in _POLYNOMIAL if sum(one.name == name for one in shapes) == gyros)
    if not terms:
        return None
    return solve(products, gyros, solution.layout.runs, prior, terms, turn_on=solution.turn_on_deg_h)


def fitted_shapes(
    products: Sequence[Product],
    solution: Solution,
    prior: Prior,
    names: Sequence[str],
    together: bool = False,
) -> list[Shape]:
    """Each shape of every gyro, as far as the campaign determines it: one at a time, or all together."""
    layout = solution.layout
    found = []
    for group in [tuple(names)] if together else [(name,) for name in names]:
        more = solve(products, layout.gyros, layout.runs, prior, group, turn_on=solution.turn_on_deg_h)
        for k, name in enumerate(group):
            unit, factor = UNITS[name]
            for i in range(layout.gyros):
                where = more.layout.gyro(i).start + 4 + k
                std = factor * float(np.sqrt(more.covariance[where, where]))
                if std <= _WORST[name]:
                    found.append(Shape(name, i, factor * float(more.values[where]), std, unit))
    return found
