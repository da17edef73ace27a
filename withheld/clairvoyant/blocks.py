"""Readings without noise on blocks of about one second, and the inner product in which they count."""

from dataclasses import dataclass, replace

import numpy as np

from withheld.arrays import Array
from withheld.chain.campaign import Campaign, Run
from withheld.chain.electronics import converted, filtered, volts
from withheld.chain.injector import World
from withheld.chain.readings import readings
from withheld.chain.truth import nominal
from withheld.clairvoyant.covariance import whitening
from withheld.effects.entry import Entry, select

PER_BLOCK = 8
MOST_BLOCKS = 400


def block_count(run: Run) -> tuple[int, float]:
    """Blocks of a run and their length [s]: one second, longer where a run would have more than 400, or where
    a second holds no sample.
    """
    length = max(1.0, run.duration_s / MOST_BLOCKS, 1.0 / run.sample_rate_hz)
    return max(int(run.duration_s // length), 1), length


def fine_times(run: Run) -> Array:
    """Eight times in the middle of eighths of each block, (8 blocks,) [s]."""
    blocks, length = block_count(run)
    return (np.arange(blocks * PER_BLOCK) + 0.5) * length / PER_BLOCK


def block_means(values: Array) -> Array:
    """Means over each block's eight values, (blocks, ...)."""
    result: Array = values.reshape(-1, PER_BLOCK, *values.shape[1:]).mean(axis=1)
    return result


def decoded(world: World, run: Run, t: Array, step_s: float) -> Array:
    """What the reduction would make of the noiseless chain, (k, n) [deg/h].

    Rounding, lines and a converter's error are left out: those belong to the full rate.
    """
    unit = world.campaign.unit
    slow = tuple(e for e in world.entries if e.effect not in ("adc_nonlinearity", "periodic_interference"))
    m = readings(run, unit, world.truth, slow, world.heat[run.run_id], t)
    v = converted(run, slow, filtered(run, slow, volts(run, unit, world.truth, m), step_s))
    for e in select(slow, run.run_id, "channel_swap"):
        one, other = e.gyros()[0], int(e.parameters["with"][4:]) - 1
        v[:, [one, other]] = v[:, [other, one]]
    for e in select(slow, run.run_id, "polarity_error"):
        v[:, e.gyros()] *= -1.0
    result: Array = (np.array(run.polarity) * v - np.array(unit.bias)) / np.array(unit.scale_factor) * 3600.0
    return result


def campaign_blocks(world: World) -> list[Array]:
    """Block means of every run, each (blocks, n) [deg/h]."""
    out = []
    for run in world.campaign.runs:
        t = fine_times(run)
        out.append(block_means(decoded(world, run, t, t[1] - t[0])))
    return out


def difference(world: World, entries: tuple[Entry, ...], beside: tuple[Entry, ...] = ()) -> list[Array]:
    """What `entries` change, beside others that are there anyway: each run (blocks, n) [deg/h]."""
    having = campaign_blocks(replace(world, entries=beside + entries))
    lacking = campaign_blocks(replace(world, entries=beside))
    return [a - b for a, b in zip(having, lacking, strict=True)]


@dataclass(frozen=True)
class Metric:
    """An inner product in which nominal noise and the stated uncertainties count as noise.

    `filters[r][i]` whitens gyro i's blocks of run r; `nuisances` (rows, q) are one-sigma columns, whitened;
    `shrink` = (1 + A'A)^-1.  By Woodbury, x' S^-1 y = x'y - (A'x)' shrink (A'y) for whitened x and y.
    """

    filters: list[list[Array]]
    nuisances: Array
    shrink: Array

    def white(self, runs: list[Array]) -> Array:
        """Block values of every run, each (blocks, n, ...) -> whitened rows (rows, ...)."""
        rows = []
        for filters, values in zip(self.filters, runs, strict=True):
            rows += [matrix @ values[:, i] for i, matrix in enumerate(filters)]
        return np.concatenate(rows)

    def gram(self, x: Array, y: Array) -> Array:
        """Inner products of whitened columns, (columns of x, columns of y)."""
        return x.T @ y - (self.nuisances.T @ x).T @ (self.shrink @ (self.nuisances.T @ y))


def _nuisance_columns(world: World) -> list[list[Array]]:
    """One-sigma changes of the noiseless chain, as lists of runs (blocks, n) [deg/h]: scale factors, biases
    and axes a gyro each, azimuth a run each, table and latitude; turn-on biases stand in the noise.
    """
    campaign = world.campaign
    unit, runs = campaign.unit, campaign.runs
    still = replace(world, truth=nominal(campaign), entries=())
    base = campaign_blocks(still)
    ones = np.ones(unit.n)

    def change(**fields: object) -> list[Array]:
        moved = campaign_blocks(replace(still, truth=replace(still.truth, **fields)))  # type: ignore[arg-type]
        return [a - b for a, b in zip(moved, base, strict=True)]

    together = [
        change(scale_factor_rel=np.array(unit.scale_factor_rel)),
        change(bias_V=np.array(unit.bias_sd)),
        change(axis_tilt_rad=np.outer(unit.axis_rad, [1.0, 0.0])),
        change(axis_tilt_rad=np.outer(unit.axis_rad, [0.0, 1.0])),
    ]
    # These were moved for all gyros at once; each gyro's own part is a column.
    columns = [
        [values * (np.arange(unit.n) == i) for values in one] for one in together for i in range(unit.n)
    ]
    turned = change(azimuth_deg={run.run_id: run.azimuth_uncertainty_deg for run in runs})
    columns += [[values * (r == k) * ones for k, values in enumerate(turned)] for r in range(len(runs))]
    columns.append(change(table_ppm=runs[0].rate_uncertainty_ppm))
    columns.append(change(latitude_deg=runs[0].latitude_uncertainty_deg))
    return columns


def noise_terms(campaign: Campaign, i: int) -> tuple[float, float, float, float]:
    """White, flicker, random walk and turn-on bias of gyro i, as the record states them."""
    unit = campaign.unit
    return (
        unit.arw_deg_sqrt_h[i], unit.instability_deg_h[i], unit.rrw_deg_h_sqrt_h[i], unit.turn_on_deg_h[i],
    )  # fmt: skip


def metric(world: World) -> Metric:
    """The inner product for one campaign."""
    campaign = world.campaign
    filters = [
        [whitening(*block_count(run), *noise_terms(campaign, i)) for i in range(campaign.unit.n)]
        for run in campaign.runs
    ]
    plain = Metric(filters, np.zeros((0, 0)), np.zeros((0, 0)))
    columns = _nuisance_columns(world)
    stacked = [np.stack([column[r] for column in columns], axis=-1) for r in range(len(campaign.runs))]
    nuisances = plain.white(stacked)
    shrink = np.asarray(np.linalg.inv(np.eye(nuisances.shape[1]) + nuisances.T @ nuisances), dtype=float)
    return Metric(filters, nuisances, shrink)
