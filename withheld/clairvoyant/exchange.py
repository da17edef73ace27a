"""Sets of causes that do what another set does: a turned mounting and three tipped axes for four tipped axes.

A label keeps the inner products of all columns that effects linear in their parameters can make, so that a
scorer can ask whether a set of causes that is not the truth is as good as it.
"""

from typing import Any

import numpy as np

from withheld.arrays import Array
from withheld.clairvoyant.blocks import Metric
from withheld.clairvoyant.rivals import Key, Rival
from withheld.clairvoyant.separation import left_in_gram


def linear_columns(
    inner: Metric, whole: Array, truths: Array, keys: list[Key], rivals: list[Rival]
) -> dict[str, Any]:
    """Inner products for `left_of`: of what all effects make together, then of columns by effect and place.

    Parameters
    ----------
    inner : Metric
    whole : (rows,)
        Whitened difference that all effects make together, in the catalogue's shape.
    truths, keys : (rows, effects) and names and places
        What each effect makes; it stands for those that are not linear.
    rivals : list of Rival
        As `slow_rivals` gives them; those on a grid are left out.

    Returns
    -------
    dict
        `places`: effect, channels, runs and number of columns of each; `gram`: the lower triangle, by rows.
    """
    found: dict[Key, list[Array]] = {}
    for rival in rivals:
        if not rival.fixed:
            found.setdefault(rival.key, []).append(rival.columns)
    spans = {
        key: np.concatenate(parts, axis=1)
        for key, parts in found.items()
        # a crosstalk's parts are its sources; those of others a grid
        if len(parts) == 1 or key[0] == "crosstalk"
    }
    spans |= {key: truth[:, None] for key, truth in zip(keys, truths.T, strict=True) if key not in spans}
    columns = np.concatenate([whole[:, None], *spans.values()], axis=1)
    gram = inner.gram(columns, columns)
    return {
        "places": [[key[0], list(key[1]), list(key[2]), span.shape[1]] for key, span in spans.items()],
        "gram": [[float(f"{v:.9g}") for v in row[: k + 1]] for k, row in enumerate(gram)],
    }


def places(table: dict[str, Any]) -> dict[Key, range]:
    """Where each effect and place has its columns in the table's inner products."""
    ends = np.cumsum([1, *(place[3] for place in table["places"])]).tolist()
    return {
        (effect, tuple(channels), tuple(runs)): range(start, start + width)
        for start, (effect, channels, runs, width) in zip(ends, table["places"], strict=False)
    }


def left_of(table: dict[str, Any], causes: list[Key]) -> float:
    """What free multiples of all that these causes can make leave of what is wrong; all are in `places`."""
    gram = np.zeros((len(table["gram"]), len(table["gram"])))
    for k, row in enumerate(table["gram"]):
        gram[k, : k + 1] = gram[: k + 1, k] = row
    where = places(table)
    chosen = [column for cause in causes for column in where[cause]]
    return left_in_gram(gram[0, 0], gram[chosen, 0], gram[np.ix_(chosen, chosen)])
