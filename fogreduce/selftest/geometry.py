"""The published unit's geometry: parity vector, and what losing a gyro costs."""

from __future__ import annotations

import numpy as np

from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.physics.alignment import gyro_axes
from fogreduce.physics.redundancy import parity_vectors, variance_trace
from fogreduce.selftest.check import Check, printed
from fogreduce.selftest.paper import RECORD

_SOURCE = "the paper's Table 1, by singular values"
_PARITY = ("0.4105", "0.4083", "0.4080", "-0.7059")
_TRACES = {"all four gyros": ("2.495", None), "without gyro 1": ("6.93", 0), "without gyro 2": ("6.99", 1)}
_TRACES |= {"without gyro 3": ("6.98", 2), "without gyro 4": ("3.00", 3)}


def geometry() -> list[Check]:
    """Parity vector and variance traces of H as the record has it."""
    axes = gyro_axes(np.array(CalibrationRecord.from_yaml(RECORD).H))
    parity = parity_vectors(axes)[0]
    checks = [
        printed("Geometry", f"parity vector, gyro {k + 1}", _SOURCE, text, float(parity[k]))
        for k, text in enumerate(_PARITY)
    ]
    for what, (text, gone) in _TRACES.items():
        left = axes if gone is None else np.delete(axes, gone, axis=0)
        checks.append(printed("Geometry", f"variance trace, {what}", _SOURCE, text, variance_trace(left)))
    return checks
