"""Parity and geometry against the published unit's numbers."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.physics.alignment import gyro_axes
from fogreduce.physics.redundancy import parity_vectors, projection, spans_space, variance_trace

#: The paper's Table 1.
H = np.array(
    [
        [2.891714702786278e-01, 2.892335095117639e-01, 2.876136426324943e-01, 5.017305804843861e-01],
        [-4.639681532136366e-03, 7.052669198527741e-01, -7.041214018909228e-01, -1.744579996672102e-03],
        [8.144462476125298e-01, -4.097230037870795e-01, -4.108263813061506e-01, -8.696722162293962e-04],
    ]
)


def test_the_published_unit_is_an_orthogonal_triad_and_its_diagonal() -> None:
    """Parity vector and variance traces as the issue gives them, to every printed digit."""
    axes = gyro_axes(H)
    assert parity_vectors(axes) == pytest.approx(np.array([[0.4105, 0.4083, 0.4080, -0.7059]]), abs=5e-5)
    assert variance_trace(axes) == pytest.approx(2.495, abs=5e-4)
    without = [variance_trace(np.delete(axes, i, axis=0)) for i in range(4)]
    assert without == pytest.approx([6.93, 6.99, 6.98, 3.00], abs=5e-3)


def test_parity_does_not_see_motion() -> None:
    axes = np.random.default_rng(1).normal(size=(6, 3))
    rows = parity_vectors(axes)
    assert rows.shape == (3, 6)
    assert rows @ axes == pytest.approx(np.zeros((3, 3)), abs=1e-12)
    assert rows @ rows.T == pytest.approx(np.eye(3), abs=1e-12)
    assert parity_vectors(np.eye(3)).shape == (0, 3)


def test_axes_in_a_plane_determine_nothing() -> None:
    flat = np.array([[1.0, 0, 0], [0, 1, 0], [0.6, 0.8, 0]])
    assert not spans_space(flat)
    assert variance_trace(flat) == np.inf
    assert variance_trace(np.eye(3)) == pytest.approx(3.0)
    assert projection(np.eye(3)) == pytest.approx(np.eye(3))
