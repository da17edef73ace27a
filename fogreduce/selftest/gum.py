"""The examples H.2 and H.3 of the GUM (JCGM 100:2008), through the package's propagation of uncertainty."""

from __future__ import annotations

import math

import numpy as np

from fogreduce.estimate.propagation import correlations, propagated, standard_uncertainties
from fogreduce.selftest.check import Check, printed

# Table H.2: five sets of simultaneous observations of voltage [V], current [A] and phase [rad].
_OBSERVED = np.array(
    [
        [5.007, 4.994, 5.005, 4.990, 4.999],
        [19.663e-3, 19.639e-3, 19.640e-3, 19.685e-3, 19.678e-3],
        [1.0456, 1.0438, 1.0468, 1.0428, 1.0433],
    ]
)
# Table H.6: a thermometer's readings and corrections [degC]; the reference is 20 degC.
_READING = [21.521, 22.012, 22.512, 23.003, 23.507, 23.999, 24.513, 25.002, 25.503, 26.010, 26.511]
_CORRECTION = [-0.171, -0.169, -0.166, -0.159, -0.164, -0.165, -0.156, -0.157, -0.159, -0.161, -0.160]
#: The GUM's own means give 0.2956; its table says 0.295.
_ROUNDED = "one unit of the last digit: the table's is cut off"
_H2, _H3 = "GUM H.2, tables H.2 to H.4", "GUM H.3, table H.6"


def impedance() -> list[Check]:
    """H.2: resistance, reactance and impedance from correlated means."""
    x = _OBSERVED.mean(axis=1)
    voltage, current, phase = x
    whole = voltage / current
    resistance, reactance = whole * math.cos(phase), whole * math.sin(phase)
    jacobian = np.array(
        [
            [resistance / voltage, -resistance / current, -reactance],
            [reactance / voltage, -reactance / current, resistance],
            [whole / voltage, -whole / current, 0.0],
        ]
    )
    covariance = propagated(jacobian, np.cov(_OBSERVED) / _OBSERVED.shape[1])
    errors, r = standard_uncertainties(covariance).tolist(), correlations(covariance)
    group = "GUM H.2"
    return [
        printed(group, "resistance", _H2, "127.732", resistance, "ohm"),
        printed(group, "reactance", _H2, "219.847", reactance, "ohm"),
        printed(group, "impedance", _H2, "254.260", whole, "ohm"),
        printed(group, "its standard uncertainty", _H2, "0.236", errors[2], "ohm"),
        printed(group, "standard uncertainty of the resistance", _H2, "0.071", errors[0], "ohm"),
        Check(group, "standard uncertainty of the reactance", _H2, 0.295, errors[1], 0.001, _ROUNDED, "ohm"),
        printed(group, "correlation of resistance and reactance", _H2, "-0.588", float(r[0, 1])),
        printed(group, "correlation of resistance and impedance", _H2, "-0.485", float(r[0, 2])),
        printed(group, "correlation of reactance and impedance", _H2, "0.993", float(r[1, 2])),
    ]


def straight_line() -> list[Check]:
    """H.3: a thermometer's calibration curve and its value at 30 degC."""
    columns = np.array([np.ones(len(_READING)), np.array(_READING) - 20.0])
    correction = np.array(_CORRECTION)
    estimator = np.linalg.inv(columns @ columns.T) @ columns
    line = estimator @ correction
    left = correction - line @ columns
    variance = float(left @ left) / (correction.size - 2)
    covariance = propagated(estimator, variance * np.eye(correction.size))
    errors = standard_uncertainties(covariance).tolist()
    at_30 = np.array([[1.0, 10.0]])
    error_30 = float(standard_uncertainties(propagated(at_30, covariance))[0])
    group = "GUM H.3"
    return [
        printed(group, "intercept", _H3, "-0.1712", float(line[0]), "degC"),
        printed(group, "its standard uncertainty", _H3, "0.0029", errors[0], "degC"),
        printed(group, "slope", _H3, "0.00218", float(line[1])),
        printed(group, "its standard uncertainty", _H3, "0.00067", errors[1]),
        printed(group, "their correlation", _H3, "-0.930", float(correlations(covariance)[0, 1])),
        printed(group, "correction at 30 degC", _H3, "-0.1494", float((at_30 @ line)[0]), "degC"),
        printed(group, "its standard uncertainty", _H3, "0.0041", error_30, "degC"),
    ]
