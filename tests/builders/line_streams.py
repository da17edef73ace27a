"""Streams with lines in them: cosines and white noise."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

RATE, N, NOISE = 100.0, 12000, 6.0
FOUR = np.array([[0.29, 0.0, 0.81], [0.29, 0.71, -0.41], [0.29, -0.7, -0.41], [0.5, 0.0, 0.0]])
FOUR /= np.linalg.norm(FOUR, axis=1)[:, None]


@dataclass
class Facts:
    """What the search for lines asks of a run."""

    run_id: str
    axes: NDArray[np.float64]
    sample_rate_hz: float = RATE
    frame_signs: NDArray[np.float64] = field(default_factory=lambda: np.ones(3))

    @property
    def n_gyros(self) -> int:
        return len(self.axes)

    @property
    def white_noise(self) -> NDArray[np.float64]:
        """Of NOISE deg/h a sample, in deg/sqrt(h)."""
        return np.full(len(self.axes), NOISE / 60.0 / np.sqrt(RATE))


def quiet(seed: int, runs: int = 2, axes: NDArray[np.float64] = FOUR) -> list[NDArray[np.float64]]:
    rng = np.random.default_rng(seed)
    return [NOISE * rng.standard_normal((len(axes), N)) for _ in range(runs)]


def wave(deg_h: float, hz: float, phase: float = 0.0) -> NDArray[np.float64]:
    return deg_h * np.sin(2.0 * np.pi * hz / RATE * np.arange(N) + phase)
