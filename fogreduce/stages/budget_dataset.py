"""Dataset ``budget``: published values with their uncertainty components as variables beside them.

The attributes are obsarray's convention, so that its readers propagate further: `unc_comps` on a measurand
names its components; `err_corr_1_dim`, `err_corr_1_form` and `err_corr_1_params` on a component say how its
errors are correlated along segments and axes, `pdf_shape` how they are distributed. CF's
`ancillary_variables` says the same to who knows CF alone.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from fogreduce.datasets.store import DatasetWriter
from fogreduce.datasets.templates import Variable
from fogreduce.estimate.propagation import correlations
from fogreduce.stages.budget import JOINT, PARTS, Budget, Value
from fogreduce.stages.setup import Setup

Array = NDArray[np.float64]

#: With more segments the dataset has the whole run alone: a correlation of all of them would be too large.
_MOST_SEGMENTS = 20
#: A part of this share of the combined uncertainty, and less, is left out.
_NEGLIGIBLE = 1e-6
#: A correlation this near to 0 or 1 is that.
_ROUNDING = 1e-9

_LONG_NAMES = {
    "a": "offset of the mean curve",
    "p": "b sin d of the mean curve",
    "q": "b cos d of the mean curve",
    "e": "slope of the mean curve",
    "drift": "drift by the paper's offset rule",
    "integral": "plain integral of the rate, Earth's part taken away",
    "mean_rate": "mean rate, Earth's part taken away",
}
_CF_UNITS = {"deg": "degree", "deg/s": "degree s-1", "deg/h": "degree h-1", "deg/s/s": "degree s-2"}
_OF_PARTS = {
    "noise": "noise",
    "calibration_record": "the calibration record",
    "turn_on": "turn-on bias",
    "azimuth": "the azimuth",
    "latitude": "the latitude",
    "table_rate": "the table's rate",
}


def write_budget(setup: Setup, budget: Budget) -> None:
    """Write the dataset; a unit of one or two gyros has the curves of its gyros alone."""
    numbers = sorted({value.segment for value in budget.values.values() if isinstance(value.segment, int)})
    segments: list[int | str] = [*numbers] if len(numbers) <= _MOST_SEGMENTS else []
    if len(numbers) > 1:
        segments.append("all")
    variables: list[Variable] = []
    values: dict[str, Array] = {}
    coordinates = {"segment": [str(segment) for segment in segments]}
    for dim, channels, quantities in (
        ("axis", setup.axes, JOINT),
        ("gyro", setup.gyros, JOINT[:4]),
    ):
        if not channels:
            continue
        coordinates[dim] = channels
        for quantity in quantities:
            found = [[budget.values.get((quantity, name, each)) for name in channels] for each in segments]
            if any(value is not None for row in found for value in row):
                of = _Measurand(budget, quantity, dim, segments, channels, found)
                of.add(variables, values)
    for dim, channels in (("axis", setup.axes), ("gyro", setup.gyros)):
        labels = [f"{segment} {channel}" for segment in segments for channel in channels]
        if any(f"{dim}_value" in variable.dims for variable in variables):
            coordinates |= {f"{dim}_value": labels, f"{dim}_value_2": labels}
    sizes = {name: len(labels) for name, labels in coordinates.items()}
    with DatasetWriter(
        setup.dataset("budget"), sizes, coordinates, variables, setup.attributes, setup.storage
    ) as writer:
        for name, array in values.items():
            writer.write(name, 0, array)


class _Measurand:
    """One quantity over segments and channels, and what its uncertainty comes from."""

    def __init__(
        self,
        budget: Budget,
        quantity: str,
        dim: str,
        segments: Sequence[int | str],
        channels: Sequence[str],
        found: Sequence[Sequence[Value | None]],
    ) -> None:
        self._budget, self._quantity, self._dim = budget, quantity, dim
        self._segments, self._channels = segments, channels
        self._flat = [value for row in found for value in row]
        self._name = quantity if dim == "axis" else f"gyro_{quantity}"

    def add(self, variables: list[Variable], values: dict[str, Array]) -> None:
        """Add the measurand, its components and their correlations."""
        dims = ("segment", self._dim)
        unit = next(value.unit for value in self._flat if value is not None)
        units = _CF_UNITS.get(unit, unit)
        groups = self._budget.groups
        sizes = {
            part: [math.nan if v is None else v.part(groups, part) for v in self._flat] for part in PARTS
        }
        parts = [part for part in PARTS if self._counts(part, sizes[part])]
        components = [f"u_{part}_{self._name}" for part in parts]
        said: dict[str, object] = {"long_name": _LONG_NAMES[self._quantity], "units": units}
        listed = {"unc_comps": components, "ancillary_variables": " ".join(components)}
        variables.append(Variable(self._name, dims, "<f8", said | listed))
        values[self._name] = self._array([np.nan if v is None else v.value for v in self._flat])
        for part, component in zip(parts, components, strict=True):
            correlation = self._noise() if part == PARTS[0] else self._sources(part)
            form, matrix = _form_of(correlation), f"err_corr_{part}_{self._name}"
            alike = (name for name in values if "err_corr" in name and _same(values[name], correlation))
            matrix = next(alike, matrix)
            attributes = {
                "long_name": f"standard uncertainty of {said['long_name']} by {_OF_PARTS[part]}",
                "units": units,
                "pdf_shape": "gaussian",
                "err_corr_1_dim": list(dims),
                "err_corr_1_form": form,
                "err_corr_1_params": [matrix] if form == "err_corr_matrix" else "",
                "err_corr_1_units": "",
            }
            variables.append(Variable(component, dims, "<f8", attributes))
            values[component] = self._array(sizes[part])
            if form == "err_corr_matrix" and matrix not in values:
                squared = f"{self._dim}_value", f"{self._dim}_value_2"
                about = {"long_name": f"correlation of the errors of {component}", "units": "1"}
                variables.append(Variable(matrix, squared, "<f8", about))
                values[matrix] = correlation

    def _sizes(self, part: str) -> list[float]:
        """What a part adds to each value."""
        return [math.nan if v is None else v.part(self._budget.groups, part) for v in self._flat]

    def _counts(self, part: str, sizes: Sequence[float]) -> bool:
        """Whether a part is more than rounding in any of the values."""
        return part == PARTS[0] or any(
            value is not None and size > _NEGLIGIBLE * value.combined
            for value, size in zip(self._flat, sizes, strict=True)
        )

    def _array(self, flat: Sequence[float]) -> Array:
        return np.array(flat, np.float64).reshape(len(self._segments), len(self._channels))

    def _sources(self, part: str) -> Array:
        """Correlation by the sources of a part, each of which moves all values together."""
        chosen = [k for k, group in enumerate(self._budget.groups) if group == part]
        moved = [np.zeros(len(chosen)) if v is None else v.sources[chosen] for v in self._flat]
        return _filled(correlations(np.array(moved) @ np.array(moved).T))

    def _noise(self) -> Array:
        """Correlation by noise.

        Between channels that within a segment, mean over the segments; between segments none; between a
        segment and the whole run the segment's share of the whole.
        """
        channels, segments = len(self._channels), len(self._segments)
        rows = np.array([0.0 if v is None else v.noise for v in self._flat]).reshape(segments, channels)
        found = []
        for k, segment in enumerate(self._segments):
            covariance = np.diag(rows[k] ** 2)
            for i, one in enumerate(self._channels):
                for j, two in enumerate(self._channels[i + 1 :], i + 1):
                    covariance[i, j] = self._budget.noise.get((self._quantity, one, two, segment), 0.0)
                    covariance[j, i] = covariance[i, j]
            found.append(_filled(correlations(covariance)))
        between_segments = np.eye(segments)
        if segments > 1 and self._segments[-1] == "all" and self._quantity in JOINT[4:]:
            shares = (rows[:-1] ** 2).sum(axis=1)
            share = np.sqrt(shares / shares.sum()) if shares.sum() > 0 else 0.0 * shares
            between_segments[-1, :-1] = between_segments[:-1, -1] = share
        whole: Array = np.kron(between_segments, np.mean(np.array(found), axis=0)).astype(np.float64)
        return whole


def _filled(correlation: Array) -> Array:
    """A correlation matrix, values without any error as if by themselves."""
    filled = np.where(np.isnan(correlation), 0.0, correlation)
    np.fill_diagonal(filled, 1.0)
    return filled


def _same(one: Array, other: Array) -> bool:
    return one.shape == other.shape and float(np.abs(one - other).max()) < _ROUNDING


def _form_of(correlation: Array) -> str:
    """Obsarray's name of a correlation."""
    if np.abs(correlation - np.eye(len(correlation))).max() < _ROUNDING:
        return "random"
    if np.abs(correlation - 1.0).max() < _ROUNDING:
        return "systematic"
    return "err_corr_matrix"
