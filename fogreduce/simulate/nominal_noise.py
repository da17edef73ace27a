"""The noise of a unit's gyros, block after block: what the record states, and what effects add."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.effects.gyro_names import gyro_name
from fogreduce.effects.noise import NoiseLevels
from fogreduce.physics.flicker import FlickerSource
from fogreduce.physics.noise import BLOCK, WalkSource, white_sigma
from fogreduce.simulate.streams import stream

Array = NDArray[np.float64]


@dataclass(frozen=True)
class NoiseCoefficients:
    """N [deg/sqrt(h)], B [deg/h] and K [deg/h/sqrt(h)] of each gyro."""

    white_deg_sqrt_h: Sequence[float]
    flicker_deg_h: Sequence[float]
    walk_deg_h_sqrt_h: Sequence[float]

    @classmethod
    def of(cls, stated_noise: Mapping[str, Any]) -> NoiseCoefficients:
        """From a record's noise as plain data, defaults filled in."""
        return cls(
            stated_noise["angle_random_walk_deg_sqrt_h"],
            stated_noise["bias_instability_deg_h"],
            stated_noise["rate_random_walk_deg_h_sqrt_h"],
        )


class GyroNoise:
    """All gyros' noise in one run; each gyro and process has a stream of its own.

    Parameters
    ----------
    levels : sequence of NoiseLevels
        One a gyro.
    sample_rate_hz : float
    run_id : str
    seed : int
    """

    def __init__(self, levels: Sequence[NoiseLevels], sample_rate_hz: float, run_id: str, seed: int) -> None:
        def generator_of(gyro: int, process: str) -> np.random.Generator:
            return stream(seed, "noise", run_id, gyro_name(gyro), process)

        n = len(levels)
        self._white = [generator_of(i, "white") for i in range(n)]
        self._sigma = [float(white_sigma(level.white_deg_sqrt_h, sample_rate_hz)) for level in levels]
        mixing = np.array([level.mixing for level in levels])
        self._mixing = None if np.array_equal(mixing, np.eye(n)) else mixing
        self._slow: list[tuple[int, float, FlickerSource | WalkSource]] = []
        for i, level in enumerate(levels):
            flicker = [(level.flicker_deg_h, generator_of(i, "flicker")), *level.further_flicker]
            walk = [(level.walk_deg_h_sqrt_h, generator_of(i, "walk")), *level.further_walk]
            for coefficient, generator in flicker:
                if coefficient > 0.0:
                    self._slow.append((i, coefficient, FlickerSource(sample_rate_hz, generator)))
            for coefficient, generator in walk:
                if coefficient > 0.0:
                    self._slow.append((i, coefficient, WalkSource(sample_rate_hz, generator)))

    def next_block(self) -> Array:
        """The next `BLOCK` samples of every gyro [deg/s], (n, BLOCK)."""
        noise = np.empty((len(self._white), BLOCK))
        for row, generator in zip(noise, self._white, strict=True):
            generator.standard_normal(out=row)
        if self._mixing is not None:
            noise = self._mixed(noise)
        for row, sigma in zip(noise, self._sigma, strict=True):
            row *= sigma
        for gyro, coefficient, source in self._slow:
            block = source.next_block()
            block *= coefficient / SECONDS_PER_HOUR
            noise[gyro] += block
        return noise

    def _mixed(self, unit: Array) -> Array:
        """Each gyro's mixture of independent unit noises, term by term: a gyro left alone keeps its bits."""
        assert self._mixing is not None
        mixed = np.zeros_like(unit)
        for row, weights in zip(mixed, self._mixing, strict=True):
            for weight, noise in zip(weights, unit, strict=True):
                if weight != 0.0:
                    row += weight * noise
        return mixed
