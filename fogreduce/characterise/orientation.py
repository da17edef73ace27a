"""What shows where orientations differ: misalignment, acceleration and magnetic sensitivity."""

from __future__ import annotations

import numpy as np

from fogreduce.calibrate.derive import Derivation
from fogreduce.calibrate.shapes import ACCELERATION, MAGNETIC, Shape
from fogreduce.characterise.left_open import axis_is_open
from fogreduce.characterise.quantity import Quantity, normal, undetermined

_MRAD = 1e3


def orientation_quantities(found: Derivation, gyro: int, shapes: list[Shape]) -> list[Quantity]:
    """Of a gyro."""
    of = f"gyro{gyro + 1}"
    return [
        *_misalignment(found, gyro, of),
        *_acceleration(shapes, gyro, of),
        _magnetic(found, shapes, gyro, of),
    ]


def _misalignment(found: Derivation, gyro: int, of: str) -> list[Quantity]:
    """Axis less that of the present record, along two directions at right angles to it."""
    parameters = found.parameters
    nominal = found.readings[0].facts.axes[gyro]
    nominal = nominal / np.linalg.norm(nominal)
    quantities = []
    for k, direction in enumerate(parameters.across[gyro]):
        x, y, z = np.round(direction, 2) + 0.0  # no sign of a zero
        part = f"{of}, towards [{x:.2f}, {y:.2f}, {z:.2f}]"
        std = float(parameters.standard_errors[gyro, 2 + k])
        if axis_is_open(found, gyro, k):
            needs = "turns both ways about the other two axes (two mountings more)"
            quantities.append(undetermined("misalignment", part, "mrad", needs))
            continue
        value = float(direction @ (parameters.axes[gyro] - nominal))
        quantities.append(normal("misalignment", part, "mrad", value * _MRAD, std * _MRAD))
    return quantities


def _acceleration(shapes: list[Shape], gyro: int, of: str) -> list[Quantity]:
    """Bias by 1 g along each axis of the unit, where the attitudes tell it from the bias."""
    fitted = {one.name: one for one in shapes if one.gyro == gyro and one.name in ACCELERATION}
    quantities = []
    for name in ACCELERATION:
        part = f"{of}, {name[-1]}"
        if name in fitted:
            one = fitted[name]
            quantities.append(normal("acceleration_sensitivity", part, "deg/h/g", one.value, one.std))
        else:
            needs = f"standstills with {name[-1]} up and {name[-1]} down, and across"
            quantities.append(undetermined("acceleration_sensitivity", part, "deg/h/g", needs))
    return quantities


def field_is_stated(found: Derivation) -> bool:
    """Whether every run states the magnetic field: one that does not may have any."""
    return all(one.run.site.magnetic_field_uT is not None for one in found.readings)


def _magnetic(found: Derivation, shapes: list[Shape], gyro: int, of: str) -> Quantity:
    """Bias by 1 mT along the gyro's input axis, as the effect `magnetic_bias` has it."""
    for one in shapes:
        if one.name == MAGNETIC and one.gyro == gyro:
            return normal("magnetic_sensitivity", of, "deg/h/mT", one.value, one.std)
    needs = "standstills in attitudes that turn the gyro's axis along the field and against it"
    if not field_is_stated(found):
        needs += "; site: {magnetic_field_uT: [east, north, up]} in the run.yaml of every run"
    return undetermined("magnetic_sensitivity", of, "deg/h/mT", needs)
