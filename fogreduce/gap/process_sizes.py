"""Evidence of a random process of one unknown size, averaged over sizes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fogreduce.gap.capture import RunInput
from fogreduce.gap.evidence import Field, log_mean_exp
from fogreduce.gap.family import diagonal
from fogreduce.gap.noise_model import Whitener, process_covariance

Array = NDArray[np.float64]

_LOWEST, _HIGHEST, STEPS = 1.5, 3000.0, 40
_SOME = 1e-6  # of the largest variance: what is below it is none


def size_logs(d: Array, runs: Array, z2: Array) -> tuple[Array, Array]:
    """Squared sizes (sizes,) of a process, and ln B of each, (sizes, ...).

    Parameters
    ----------
    d : (D,) array
        Variances of the whitened process of unit size in its eigenvectors.
    runs : (D,) array
        How many runs share each.
    z2 : (D, ...) array
        Squared residuals there, summed over those runs.
    """
    # sizes from where the process would hardly show to where it drowns everything
    order = 1.0 / max(float(np.sqrt(np.sum(runs * d**2))), 1e-300)
    a2 = order * np.geomspace(_LOWEST, _LOWEST * _HIGHEST, STEPS)
    grown = a2[:, None] * d
    none = (np.log1p(grown) @ runs).reshape(-1, *(1,) * (z2.ndim - 1))
    return a2, np.asarray(0.5 * ((grown / (1.0 + grown)) @ z2 - none))


def whole_evidence(
    field: Field,
    whiten: Whitener,
    inputs: Sequence[RunInput],
    i: int,
    kind: str,
    readings: Sequence[Array] | None = None,
) -> float:
    """Ln B of a smooth process in the metric of all stated uncertainties, the runs' means in it.

    Parameters
    ----------
    field : Field
        Residual and metric.
    whiten : Whitener
    inputs : runs
    i : int
        Gyro.
    kind : str
        Of the process, as `process_covariance` has it.
    readings : (blocks,) arrays or None
        What it goes with in each run.
    """
    parts: list[Array] = []
    known: dict[tuple[int, float], Array] = {}
    for r, one in enumerate(inputs):
        blocks = one.scene.blocks
        key = (blocks.count, blocks.length_s)
        if key not in known:
            values, vectors = np.linalg.eigh(process_covariance(kind.removeprefix("gain "), 1.0, blocks))
            some = values > _SOME * values[-1]
            known[key] = vectors[:, some] * np.sqrt(values[some])
        modes = known[key] if readings is None else known[key] * readings[r][:, None]
        parts.append(whiten.filters[i, r] @ modes)
    columns, rows = diagonal(parts), whiten.rows.of(i)
    cross = field.metric.a[rows].T @ columns
    b = columns.T @ field.y[rows] - cross.T @ field.shrunk
    d, vectors = np.linalg.eigh(columns.T @ columns - cross.T @ (field.metric.shrink @ cross))
    some = d > _SOME * d[-1]
    z2 = (vectors[:, some].T @ b) ** 2 / d[some]
    return float(log_mean_exp(size_logs(d[some], np.ones(int(some.sum())), z2)[1]))
