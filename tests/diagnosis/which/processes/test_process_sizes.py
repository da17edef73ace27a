"""Sizes of a process that are tried: from where it would hardly show to where it drowns everything."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.diagnosis.which.processes.sizes import size_logs


@pytest.mark.parametrize("size", [3.0, 3e2, 3e4])
def test_a_process_of_any_size_has_its_most_likely_one_among_those_tried(size: float) -> None:
    """Powers as the process makes them, six runs of 300 eigenvectors whose variances fall as a walk's do."""
    d, runs = 1.0 / np.arange(1.0, 301.0) ** 2, np.full(300, 6.0)
    variance = 1.0 + size**2 * d
    z2 = variance * np.sum(np.random.default_rng(1).standard_normal((6, 300)) ** 2, axis=0)
    a2, logs = size_logs(d, runs, z2)
    best = int(np.argmax(logs))
    assert 0 < best < len(a2) - 1
    # neighbours are 1.22 apart in variance; 1,800 powers give the size to some 2 %
    assert np.sqrt(a2[best]) == pytest.approx(size, rel=0.15)
