"""The search over sets of a small regression whose best set is known."""

from __future__ import annotations

import numpy as np

from fogreduce.diagnosis.inference.candidate import Candidate
from fogreduce.diagnosis.inference.hierarchy import Kind
from fogreduce.diagnosis.inference.noise_model import Metric
from fogreduce.diagnosis.inference.regression import Entry, Member, Option, Regression
from fogreduce.diagnosis.inference.sets import SetSearch

ROWS, GYROS = 60, 4
SCALES = np.array([0.3, 1.0, 3.0, 10.0])
MOUNT = GYROS


def mounted(turned: float, tipped: float) -> Regression:
    """Axes of four gyros, two components each, and a mounting that moves them all; noise of 0.1."""
    rng = np.random.default_rng(5)
    axes = np.linalg.qr(rng.standard_normal((ROWS, 2 * GYROS)))[0] / 0.1
    mount = axes @ rng.standard_normal((2 * GYROS, 3))
    y = mount @ np.full(3, turned) + axes @ (tipped * rng.standard_normal(2 * GYROS))
    y += rng.standard_normal(ROWS)
    blocks = [axes[:, 2 * i : 2 * i + 2] for i in range(GYROS)] + [mount]
    options, entries, start = [], [], 0
    for entry, block in enumerate(blocks):
        name, seat = ("mount_rotation", "table") if entry == MOUNT else ("axis_misalignment", f"gyro{entry}")
        k = block.shape[1]
        one = Candidate(
            name, (seat,), ("*",), slice(0, ROWS), block[:, None, :], ({},), ("mrad",) * k, np.ones((1, k))
        )
        variances = np.repeat(SCALES[:, None] ** 2, k, axis=1)
        logs = np.full(len(SCALES), -np.log(len(SCALES)))
        options.append(Option(entry, one, 0, np.arange(start, start + k), 0.0, variances, logs))
        entries.append(Entry(Kind(name, 1 if entry == MOUNT else GYROS, True), (name, (seat,), ("*",), "")))
        start += k
    columns = np.column_stack(blocks)
    return Regression.of(Metric.of(np.zeros((ROWS, 0))), y, columns, options, entries)


def found(turned: float, tipped: float) -> frozenset[int]:
    """Entries of the best set that the search comes to from all axes tipped far."""
    search = SetSearch(mounted(turned, tipped))
    return search.entries(search.best([Member(i, 3) for i in range(GYROS)]).members)


def test_what_several_do_together_and_one_could_is_that_one_and_what_is_left_of_them() -> None:
    """A mounting turned by 5 about each axis, gyros tipped by 1: as good a fit without it, all tipped far."""
    assert found(5.0, 1.0) == {0, 1, 2, 3, MOUNT}


def test_axes_that_have_little_in_common_need_no_mounting() -> None:
    assert found(0.0, 3.0) == {0, 1, 2, 3}
