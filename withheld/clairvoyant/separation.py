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
    return left_in_gram(whole, inner.gram(columns, truth[:, None])[:, 0], inner.gram(columns, columns))


def left_in_gram(whole: float, along: Array, gram: Array) -> float:
    """The same from inner products: difference with itself, with columns (k,), and of columns (k, k)."""
    explained = float(along @ _inverse(gram, np.sqrt(np.diag(gram))) @ along)
    return float(np.sqrt(max(whole - explained, 0.0)))


def separations(
    inner: Metric, truths: Array, keys: list[Key], rivals: list[Rival], spans: list[Array]
) -> list[dict[Key, float]]:
    """For each effect of a campaign the separation that each rival leaves, the smallest over its grid.

    The campaign's other effects stand beside the rival, each with all that it can make at its place; beside
    one of no amplitude (a wrong sign, a swap) they keep their sizes, or a scale factor of -2 would undo it.
    An effect that is in the campaign is nobody's rival there, nor is the same on several gyros at once where
    more than one of them has it.

    Parameters
    ----------
    inner : Metric
        The campaign's inner product.
    truths : (rows, effects)
        Whitened differences that the effects make.
    keys : list of Key
        Their names and places.
    rivals : list of Rival
        As `slow_rivals` gives them.
    spans : list of (rows, k)
        Whitened columns that each effect can make at its place.
    """
    count, ends = truths.shape[1], np.cumsum([0, *(span.shape[1] for span in spans)])
    known = np.concatenate([truths, *spans], axis=1)
    gram = inner.gram(known, known)
    beside = []
    for e in range(count):
        rest = count + np.setdiff1d(np.arange(ends[-1]), np.arange(ends[e], ends[e + 1]))
        inverse = _inverse(gram[np.ix_(rest, rest)], np.sqrt(np.diag(gram)[rest]))
        along = inverse @ gram[rest, e]
        beside.append((rest, inverse, along, float(gram[e, e] - gram[rest, e] @ along)))
    left: list[dict[Key, float]] = [{} for _ in range(count)]
    for rival in rivals:
        if _in_campaign(rival, keys):
            continue
        if rival.fixed:
            for e in range(count):
                left[e][rival.key] = snr(inner, truths[:, e] - rival.columns[:, 0])
            continue
        own, cross = inner.gram(rival.columns, rival.columns), inner.gram(rival.columns, known)
        for e, (rest, inverse, along, whole) in enumerate(beside):
            toward = cross[:, e] - cross[:, rest] @ along
            size = own - cross[:, rest] @ inverse @ cross[:, rest].T
            explained = float(toward @ _inverse(size, np.sqrt(np.diag(own))) @ toward)
            d = float(np.sqrt(max(whole - explained, 0.0)))
            left[e][rival.key] = min(d, left[e].get(rival.key, np.inf))
    return left


def _in_campaign(rival: Rival, keys: list[Key]) -> bool:
    """Whether the campaign's own effects are, or together make, what the rival is."""
    same = [key for key in keys if key[0] == rival.effect and set(key[1]) <= set(rival.channels)]
    return rival.key in keys or len(same) > 1


def _inverse(gram: Array, size: Array) -> Array:
    """Pseudo-inverse of a Gram matrix of columns whose lengths are `size`, or were before others were taken
    out of them; a direction below 1e-9 of the longest is no direction.
    """
    size = np.maximum(size, 1e-150)
    values, vectors = np.linalg.eigh(gram / np.outer(size, size))
    kept = values > 1e-9 * max(1.0, float(values.max(initial=0.0)))
    scaled = vectors[:, kept] / size[:, None]
    result: Array = (scaled / values[kept]) @ scaled.T
    return result
