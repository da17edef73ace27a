"""All quantities of a unit from a campaign, in the order of the report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from fogreduce.calibrate.derive import Derivation, prior_of
from fogreduce.calibrate.shapes import ACCELERATION, MAGNETIC, Shape, fitted_shapes
from fogreduce.characterise.bandwidth import Swung, bandwidth_quantity
from fogreduce.characterise.bias import bias_quantities
from fogreduce.characterise.definitions import Definitions
from fogreduce.characterise.noise import noise_quantities
from fogreduce.characterise.orientation import field_is_stated, orientation_quantities
from fogreduce.characterise.quantity import Quantity
from fogreduce.characterise.scale_factor import scale_factor_quantities
from fogreduce.characterise.temperature import temperature_quantities


def quantities_of(
    found: Derivation,
    choices: Definitions,
    swung: Sequence[Swung] = (),
    needs: Mapping[int, list[str]] | None = None,
) -> list[Quantity]:
    """Every quantity of every gyro, determined or not.

    Parameters
    ----------
    found : Derivation
    choices : Definitions
    swung, needs
        Of the runs that swing, as `fogreduce.characterise.bandwidth.swung_gyros` gives them.
    """
    shapes = report_shapes(found)
    out: list[Quantity] = []
    for gyro in range(found.readings[0].facts.n_gyros):
        out += scale_factor_quantities(found, gyro, shapes, choices)
        out += bias_quantities(found, gyro, shapes, choices)
        out += noise_quantities(found, gyro)
        out += orientation_quantities(found, gyro, shapes)
        out += temperature_quantities(found, gyro, shapes, choices)
        out.append(bandwidth_quantity(gyro, swung, needs or {}))
    return out


def report_shapes(found: Derivation) -> list[Shape]:
    """The departures that the report states: those of the derivation and a few more."""
    logged = any(one.electronics is not None for one in found.readings)
    warmed = any(one.warming is not None for one in found.readings)
    more = (("electronics_bias",) if logged else ()) + (("warming_bias",) if warmed else ())
    prior = prior_of(found.readings[0])
    singly = fitted_shapes(found.products, found.solution, prior, more)
    # A field and the vertical keep their angle: what belongs to either is told apart together only.
    of_place = (*ACCELERATION, MAGNETIC) if field_is_stated(found) else ACCELERATION
    together = fitted_shapes(found.products, found.solution, prior, of_place, together=True)
    return [*found.shapes, *singly, *together]
