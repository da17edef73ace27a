"""The turn-on bias of each gyro in each run, given the solution, and how well its readings fit.

The best linear unbiased predictor: what is left of the run's mean, shrunk by how much of it noise may be.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from fogreduce.calibrate.equations import Product
from fogreduce.calibrate.solution import Solution, of_unknowns


@dataclass(frozen=True)
class TurnOn:
    """A gyro in a run.

    Attributes
    ----------
    run, gyro : int
    deg_h, std_deg_h : float
        Turn-on bias and its standard deviation, the solution taken as exact.
    chi2, freedom : float
        Of the readings about solution and turn-on bias, by the noise within the run.
    """

    run: int
    gyro: int
    deg_h: float
    std_deg_h: float
    chi2: float
    freedom: float


def turn_on_biases(products: Sequence[Product], solution: Solution) -> list[TurnOn]:
    """Of every gyro in every run."""
    found = []
    for one in products:
        small = of_unknowns(one, solution.layout, solution.values)
        to = np.append(-solution.change[small.where], 1.0)  # reading less what the solution makes of it
        left = small.gram @ to
        square = float(to @ left)
        ones, mean = float(small.gram[0, 0]), float(left[0])
        precision = ones + solution.turn_on_deg_h[one.gyro] ** -2
        bias = mean / precision
        chi2 = square - 2 * bias * mean + bias**2 * ones
        found.append(TurnOn(one.run, one.gyro, bias, float(precision**-0.5), chi2, float(one.bins - 1)))
    return found
