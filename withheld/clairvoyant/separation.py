"""How far the best rivals fall short of the truth, on block means.

With S the covariance of noise and stated uncertainties, the signal-to-noise ratio of a difference d is
sqrt(d' S^-1 d).  A rival with columns X leaves min over b of (d - X b)' S^-1 (d - X b); its root is the
separation.  What else is wrong in the same campaign is profiled out by standing among the rival's columns.
"""

import numpy as np

from withheld.arrays import Array
from withheld.clairvoyant.blocks import Metric
from withheld.clairvoyant.rivals import Key, Rival


def snr(inner: Metric, truth: Array) -> float:
    """Of one whitened difference (rows,)."""
    column = truth[:, None]
    return float(np.sqrt(max(inner.gram(column, column)[0, 0], 0.0)))


def left_by(inner: Metric, truth: Array, columns: Array) -> float:
    """What free multiples of whitened columns (rows, k) leave of a whitened difference (rows,)."""
    whole = float(inner.gram(truth[:, None], truth[:, None])[0, 0])
    gram, along = inner.gram(columns, columns), inner.gram(columns, truth[:, None])[:, 0]
    size = np.sqrt(np.maximum(np.diag(gram), 1e-300))
    # Columns scaled to length one; a direction below 1e-9 of the longest is no direction.
    explained = float(
        (along / size) @ np.linalg.pinv(gram / np.outer(size, size), rcond=1e-9) @ (along / size)
    )
    return float(np.sqrt(max(whole - explained, 0.0)))


def separations(
    inner: Metric, truth: Array, own: Key, rivals: list[Rival], others: Array | None = None
) -> dict[Key, float]:
    """Separation that each rival leaves, the smallest over its grid.

    Parameters
    ----------
    inner : Metric
        The campaign's inner product.
    truth : (rows,)
        Whitened difference that the effect makes.
    own : Key
        The effect's own name and place, which is no rival of itself.
    rivals : list of Rival
        As `slow_rivals` gives them.
    rivals : list of Rival
        As `slow_rivals` gives them.
    others : (rows, k), optional
        Differences that the campaign's other effects make.
    """
    left: dict[Key, float] = {}
    for rival in rivals:
        if rival.key == own:
            continue
        if rival.fixed:
            remaining = truth - rival.columns[:, 0]
            d = snr(inner, remaining) if others is None else left_by(inner, remaining, others)
        else:
            columns = rival.columns if others is None else np.concatenate([rival.columns, others], axis=1)
            d = left_by(inner, truth, columns)
        left[rival.key] = min(d, left.get(rival.key, np.inf))
    return left
