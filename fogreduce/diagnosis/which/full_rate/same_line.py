"""Lines of runs of several sample rates: one that all of them show is named once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from fogreduce.diagnosis.which.full_rate.line import Line

#: Standard deviations within which two frequencies, or two amplitudes, are one.
_SAME = 4.0


def once_each(lines: Sequence[Line], run_ids: Sequence[str]) -> list[Line]:
    """Lines with those of other runs at the same frequency, of the same channels and size, joined to one.

    Parameters
    ----------
    lines : sequence of Line
        Of groups of runs, each with the ids of its group.
    run_ids : sequence of str
        All runs.
    """
    out: list[Line] = []
    for line in lines:
        k = next((k for k, other in enumerate(out) if _same(line, other)), None)
        if k is None:
            out.append(line)
        else:
            out[k] = _joined(out[k], line)
    return [replace(line, runs=("*",)) if set(line.runs) == set(run_ids) else line for line in out]


def _same(one: Line, other: Line) -> bool:
    if one.channels != other.channels or not (
        one.taken and other.taken and one.catalogued and other.catalogued
    ):
        return False
    if set(one.runs) & set(other.runs):
        return False
    hz, deg_h = np.hypot(one.hz_std, other.hz_std), np.hypot(one.std, other.std)
    return bool(abs(one.hz - other.hz) < _SAME * hz and abs(one.deg_h - other.deg_h) < _SAME * deg_h)


def _joined(one: Line, other: Line) -> Line:
    """Two lines as one: means of their numbers, weighed by their variances; their evidence together."""
    weights, frequencies = np.array([[one.std, other.std], [one.hz_std, other.hz_std]]) ** -2.0
    axis = one.axis
    if one.axis is not None and other.axis is not None:
        axes = np.array([one.axis, other.axis])
        axes[1] *= np.sign(axes[0] @ axes[1]) or 1.0
        mean = weights @ axes
        axis = tuple(round(float(v), 6) for v in mean / np.linalg.norm(mean))
    return replace(
        one,
        runs=(*one.runs, *other.runs),
        hz=float(frequencies @ [one.hz, other.hz] / frequencies.sum()),
        hz_std=float(frequencies.sum() ** -0.5),
        deg_h=float(weights @ [one.deg_h, other.deg_h] / weights.sum()),
        std=float(weights.sum() ** -0.5),
        axis=axis,
        log_b=one.log_b + other.log_b,
        gain=one.gain + other.gain,
        share=one.share + other.share,
        degrees=one.degrees + other.degrees,
        by_run={**one.by_run, **other.by_run},
    )
