"""From the solution's unknowns to what a calibration record holds: bias, scale factor and axis of each gyro.

With s = C G, the scale factor is the length of s (its sign that of the present record) and the axis its
direction. The covariance goes along by the derivatives: dC = G . ds, and across the axis dG = ds / C.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from fogreduce.calibrate.solution import Solution
from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.physics.frames import across

Array = NDArray[np.float64]

#: Parameters of a gyro in `GyroParameters.covariance`, in order; the unit is that in brackets.
NAMES = ("bias [deg/h]", "scale factor [relative]", "axis, first across [rad]", "axis, second across [rad]")


@dataclass(frozen=True)
class Parameters:
    """Bias, scale factor and axis of n gyros.

    Attributes
    ----------
    bias_deg_h : (n,) array
        By the derived scale factor.
    scale_ratio : (n,) array
        Derived scale factor over the present record's.
    axes : (n, 3) array
        Unit vectors, G.
    across : (n, 2, 3) array
        The two directions at right angles to each axis in which its pointing error is stated.
    covariance : (4 n, 4 n) array
        Of the parameters in `NAMES`, gyro after gyro.
    """

    bias_deg_h: Array
    scale_ratio: Array
    axes: Array
    across: Array
    covariance: Array

    @property
    def standard_errors(self) -> Array:
        """(n, 4): one standard deviation of each parameter in `NAMES`."""
        return np.sqrt(np.diag(self.covariance)).reshape(-1, 4)


def parameters_of(solution: Solution) -> Parameters:
    """The parameters that a solution gives."""
    layout = solution.layout
    bias, ratio, axes, directions = [], [], [], []
    jacobian = np.zeros((4 * layout.gyros, layout.size))
    for i in range(layout.gyros):
        start, vector = layout.gyro(i).start, layout.vector(i)
        s = solution.values[vector]
        length = float(np.linalg.norm(s))
        axis = s / length
        both = np.array(across(axis))
        relative = length / SECONDS_PER_HOUR
        value = solution.values[start] / relative
        jacobian[4 * i, start] = 1 / relative
        jacobian[4 * i, vector] = -value * axis / length
        jacobian[4 * i + 1, vector] = axis / length
        jacobian[4 * i + 2 : 4 * i + 4, vector] = both / length
        bias.append(value)
        ratio.append(relative)
        axes.append(axis)
        directions.append(both)
    covariance = jacobian @ solution.covariance @ jacobian.T
    return Parameters(np.array(bias), np.array(ratio), np.array(axes), np.array(directions), covariance)
