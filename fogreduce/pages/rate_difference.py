"""The rate about each axis less the commanded one over a run [deg/h]: the first figure of the run's page."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from markupsafe import Markup
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.pages import svg
from fogreduce.pages.numbers import number, plus_minus
from fogreduce.pages.zoom import Line, lines
from fogreduce.stages.angles import less_commanded
from fogreduce.stages.read_bins import Columns, columns_of, read_bins
from fogreduce.stages.setup import Setup

Array = NDArray[np.float64]

#: Columns of the drawn figure, for a screen and for a phone; and of the one that zooms.
_DRAWN, _DRAWN_SLIM, _ZOOMED = 240, 120, 1200


@dataclass(frozen=True)
class RateDifference:
    """The figure: drawn for a screen, drawn for a phone, the data to zoom; and the length of a bin [s]."""

    wide: Markup
    slim: Markup
    zoom: Markup
    bin_s: float


def rate_difference(
    folder: Path, fit: Mapping[str, Any], overview: Mapping[str, Any]
) -> RateDifference | None:
    """Bins of x, y, z less the commanded rate; None where a unit has no such axes or its bins are gone.

    Parameters
    ----------
    folder : Path
        The run's results.
    fit : mapping
        reports/fit.json.
    overview : mapping
        See `fogreduce.pages.overview`.

    Raises
    ------
    BadInput
        datasets/bins.nc is damaged or of another version than the manifest.
    """
    setup = Setup.read(folder)
    if not setup.axes or not setup.dataset("bins").is_file():
        return None
    _, axes = read_bins(setup)
    assert axes is not None
    bin_s, guard_s = float(fit["bin_s"]), float(setup.parameters["edge_guard_s"])
    levels = [overview["offset"].get(name, {}) for name in axes.names]
    found = []
    for k in range(len(axes.names)):
        sign = float(setup.facts.commanded_signs[k])
        rate = less_commanded(fit["segments"], sign, axes.time_s, axes.mean[k], bin_s, guard_s)
        found.append(rate * SECONDS_PER_HOUR)
    if not any(np.isfinite(values).any() for values in found):
        return None

    def gathered(most: int) -> list[Columns]:
        return [
            columns_of(axes.time_s, values, values, values, axes.count[k], most)
            for k, values in enumerate(found)
        ]

    words = _words(axes.names, levels)

    def drawn(most: int, width: float) -> Markup:
        panels = [
            svg.Band(name, "deg/h", columns, level.get("value"))
            for name, columns, level in zip(axes.names, gathered(most), levels, strict=True)
        ]
        return svg.bands(panels, words, width)

    return RateDifference(
        drawn(_DRAWN, svg.WIDE),
        drawn(_DRAWN_SLIM, svg.SLIM),
        _zoom(axes.names, gathered(_ZOOMED), levels),
        bin_s,
    )


def _words(names: Sequence[str], levels: Sequence[Mapping[str, float | None]]) -> str:
    said = "; ".join(
        f"{name} {plus_minus(level.get('value'), level.get('error')) or 'unknown'}"
        for name, level in zip(names, levels, strict=True)
    )
    return f"Rate less the commanded one over the run; means in deg/h, with the error by noise: {said}."


def _zoom(
    names: Sequence[str], columns: Sequence[Columns], levels: Sequence[Mapping[str, float | None]]
) -> Markup:
    parts = []
    for name, part, level in zip(names, columns, levels, strict=True):
        mean = level.get("value")
        words = "" if mean is None else f"mean {number(mean)}"
        parts.append(Line(f"{name} [deg/h]", part.mean, part.lowest, part.highest, mean, words))
    return lines("time [s]", columns[0].time_s, parts)
