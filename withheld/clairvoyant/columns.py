"""Values of gyros, as functions of time, put into whitened columns over a whole campaign."""

from dataclasses import dataclass

import numpy as np

from withheld.arrays import Array
from withheld.chain.campaign import Run
from withheld.chain.injector import World
from withheld.chain.motion import motion
from withheld.chain.readings import sense
from withheld.chain.temperature import Temperature
from withheld.chain.truth import nominal
from withheld.clairvoyant.blocks import Metric, block_means, fine_times
from withheld.effects.entry import Entry
from withheld.effects.gyro import Scene, Shape


@dataclass(frozen=True)
class NominalRun:
    """A run without anything wrong, on its fine times: motion, scene and readings (k, n) [deg/s]."""

    run: Run
    scene: Scene
    m: Array


def _nominal_runs(world: World) -> list[NominalRun]:
    campaign = world.campaign
    still = nominal(campaign)
    out = []
    for run in campaign.runs:
        t = fine_times(run)
        heat = world.heat[run.run_id]
        logged = Temperature(heat.time_s, heat.electronics_degC, heat.sensor_degC, heat.sensor_degC)
        moving = motion(run, still, (), t)
        m = sense(run, campaign.unit, still, (), logged, moving)
        out.append(NominalRun(run, Scene(moving, logged, campaign.unit.axes), m))
    return out


class Columns:
    """Puts values of one gyro, or of all, into whitened columns."""

    def __init__(self, world: World, inner: Metric) -> None:
        self.world, self.inner = world, inner
        self.runs = _nominal_runs(world)
        self.n = world.campaign.unit.n
        sizes = [[f.shape[0] for f in filters] for filters in inner.filters]
        ends = np.cumsum([size for row in sizes for size in row]).tolist()
        self.start = {
            (r, i): [0, *ends][r * self.n + i] for r in range(len(self.runs)) for i in range(self.n)
        }
        self.rows = ends[-1]

    def place(self, parts: dict[tuple[int, int], Array]) -> Array:
        """Fine values (k, c) [deg/s] by (run, gyro) -> whitened columns (rows, c)."""
        width = next(iter(parts.values())).shape[1]
        column = np.zeros((self.rows, width))
        for (r, i), values in parts.items():
            matrix = self.inner.filters[r][i]
            start = self.start[r, i]
            column[start : start + len(matrix)] = matrix @ block_means(values) * 3600.0
        return column

    def gyro(self, i: int, *entries: Entry, shapes: dict[str, Shape]) -> Array:
        """One column an entry, for gyro i in every run in which the entry acts."""
        parts = {}
        for r, one in enumerate(self.runs):
            values = [
                shapes[e.effect](one.scene, i, one.m[:, i], e) * np.ones(one.scene.t.size)
                if e.acts_in(one.run.run_id)
                else np.zeros(one.scene.t.size)
                for e in entries
            ]
            parts[r, i] = np.stack(values, axis=-1)
        return self.place(parts)

    def moved(self, entries: tuple[Entry, ...]) -> Array:
        """One column an entry of the table's block, by a small finite step."""
        still = nominal(self.world.campaign)
        unit = self.world.campaign.unit
        parts: dict[tuple[int, int], Array] = {}
        for r, one in enumerate(self.runs):
            changes = []
            for entry in entries:
                moving = motion(one.run, still, (entry,), one.scene.t)
                changes.append(sense(one.run, unit, still, (), one.scene.temperature, moving) - one.m)
            for i in range(self.n):
                parts[r, i] = np.stack([change[:, i] for change in changes], axis=-1)
        return self.place(parts)

    def lines(self, frequency_hz: float) -> Array:
        """Sine and cosine on each gyro in each run, (rows, gyros, 2 runs)."""
        columns = np.zeros((self.rows, self.n, 2 * len(self.runs)))
        for r, one in enumerate(self.runs):
            turn = 2 * np.pi * frequency_hz * one.scene.t
            pair = np.stack([np.sin(turn), np.cos(turn)], axis=-1)
            for i in range(self.n):
                columns[:, i, 2 * r : 2 * r + 2] = self.place({(r, i): pair})
        return columns
