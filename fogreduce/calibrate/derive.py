"""A calibration record derived from a campaign: the steps, on one screen."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.equations import Product, deg_h_per_raw, products
from fogreduce.calibrate.noise import GyroNoise, gyro_noise
from fogreduce.calibrate.parameters import Parameters, parameters_of
from fogreduce.calibrate.readings import Readings, read_campaign
from fogreduce.calibrate.residuals import Residual, by_rate, over_time
from fogreduce.calibrate.shapes import Shape, fitted_shapes, polynomial
from fogreduce.calibrate.solution import Prior, Solution, solve
from fogreduce.calibrate.turn_on import TurnOn, turn_on_biases
from fogreduce.calibrate.undetermined import Ignorance, Undetermined, run_that_determines, undetermined

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Derivation:
    """What a campaign says of its unit.

    Attributes
    ----------
    readings : list of Readings
    noise : list of GyroNoise
    products : list of Product
    solution : Solution
    parameters : Parameters
    ignorance : Ignorance
        What a direction is called undetermined by.
    undetermined : list of Undetermined
        Empty where the campaign determines all.
    next_run : dict or None
        The run that would determine most of what is open.
    turn_on : list of TurnOn
        Of each gyro in each run.
    shapes : list of Shape
        Departures from a linear scale factor and a constant bias.
    residuals, by_rate, by_rate_polynomial : list of Residual
        Over time; by the rate about the input axis; the same about the solution with a polynomial of the
        scale factor, empty where the campaign does not determine one.
    """

    readings: list[Readings]
    noise: list[GyroNoise]
    products: list[Product]
    solution: Solution
    parameters: Parameters
    ignorance: Ignorance
    undetermined: list[Undetermined]
    next_run: dict[str, Any] | None
    turn_on: list[TurnOn]
    shapes: list[Shape]
    residuals: list[Residual]
    by_rate: list[Residual]
    by_rate_polynomial: list[Residual]


def derive(campaign: Path, calibrations: Path, only: Sequence[str] = ()) -> Derivation:
    """Derive the calibration of a campaign's unit.

    Parameters
    ----------
    campaign, calibrations : Path
        The present record serves as starting point and, where the campaign says nothing, as prior.
    only : run ids
        Empty: all.

    Raises
    ------
    BadInput
        With every fault of the runs.
    """
    return derive_from(read_campaign(campaign, calibrations, only))


def derive_from(readings: list[Readings]) -> Derivation:
    """The same from runs that were read already."""
    n = readings[0].facts.n_gyros
    noise = [gyro_noise(readings, i) for i in range(n)]
    small = products(readings, noise)
    prior = prior_of(readings[0])
    solution = solve(small, n, len(readings), prior)
    ignorance = Ignorance.of(readings[0].record)
    left_open = undetermined(solution, prior.axes, ignorance)
    turn_on = turn_on_biases(small, solution)
    shapes = fitted_shapes(small, solution, prior, has_shape(readings))
    curved = polynomial(small, solution, prior, shapes)
    return Derivation(
        readings,
        noise,
        small,
        solution,
        parameters_of(solution),
        ignorance,
        left_open,
        run_that_determines(left_open, solution, prior.axes, ignorance, readings),
        turn_on,
        shapes,
        over_time(readings, noise, solution, turn_on),
        by_rate(readings, noise, solution),
        [] if curved is None else by_rate(readings, noise, curved),
    )


def prior_of(one: Readings) -> Prior:
    """The present record as a prior."""
    facts, stated = one.facts, one.record.stated_uncertainty
    factors = np.array([deg_h_per_raw(one, i) for i in range(facts.n_gyros)])
    return Prior(facts.axes, facts.bias * factors, np.array(stated.turn_on_bias_deg_h, float))


#: Departures that a derivation looks for by itself.
_LOOKED_FOR = ("asymmetry", "quadratic", "cubic", "temperature_bias", "temperature_scale_factor")


def has_shape(readings: Sequence[Readings]) -> tuple[str, ...]:
    """The departures that the campaign can show: those of temperature need a log."""
    logged = any(one.temperature is not None for one in readings)
    return tuple(name for name in _LOOKED_FOR if logged or not name.startswith("temperature"))
