"""Coverage of published uncertainties: how often the truth lies within, over many simulated runs.

``noise``: drifts of units of four gyros, each noise by itself, 300 s and 6000 s, with a record that states it
and with one that is silent. The bins are simulated directly.

``combined``: whole runs, the truth drawn from what is stated (GUM-S1: the Monte Carlo that linear propagation
is held against), fitted and budgeted as a reduction does: drift, parameters of the curves, mean rates, within
their expanded uncertainties. The runs are the simulator's or, with ``--by withheld``, those of the withheld
bench's injector, which shares no code with it.
"""

from __future__ import annotations

import argparse
import math
import time
from collections import defaultdict
from collections.abc import Callable, Iterator

import numpy as np
from measure import CALIBRATIONS, REPOSITORY, machine
from numpy.typing import NDArray
from scipy.linalg import toeplitz

from fogreduce.constants import MICROSECONDS_PER_SECOND
from fogreduce.effects.selection import select
from fogreduce.estimate.bins import bin_size
from fogreduce.estimate.coloured import ColouredNoise, combined, unit_forms
from fogreduce.estimate.curve_terms import drift_terms
from fogreduce.estimate.mean_curve import CurveBasis
from fogreduce.estimate.noise_grid import NoiseGrid, likelihood
from fogreduce.estimate.noise_posterior import posteriors
from fogreduce.estimate.propagation import coverage_factor
from fogreduce.estimate.uncertainty import StatedErrors
from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.facts import RunFacts
from fogreduce.metadata.folder import load_calibration, load_run
from fogreduce.metadata.run import Run
from fogreduce.physics.earth_rate import remove_earth_rate
from fogreduce.physics.noise import flicker_covariance
from fogreduce.physics.scale_factor import rate_from_raw
from fogreduce.simulate.draw import draw_uncertainties
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.nominal_noise import NoiseCoefficients
from fogreduce.simulate.plan import facts_of
from fogreduce.stages.budget import Budget, budget_of
from fogreduce.stages.fit import Fit
from fogreduce.stages.fit_report import as_plain
from withheld.chain.campaign import Campaign
from withheld.chain.campaign import run_from as withheld_run
from withheld.chain.campaign import unit_from as withheld_unit
from withheld.chain.injector import World, realistic_world, run_counts

Array = NDArray[np.float64]
#: Times [s] (N,) and readings [raw unit] (n, N) of a run as its capture has them.
Capture = tuple[Array, Array]

GYROS = 4
#: Angle random walk of the published unit [deg/sqrt(h)], about.
WHITE = 0.002
#: Bias instability [deg/h] and rate random walk [deg/h/sqrt(h)] of each noise.
KINDS = {
    "white": (0.0, 0.0),
    "flicker 0.03": (0.03, 0.0),
    "walk 0.1": (0.0, 0.1),
    "walk 1": (0.0, 1.0),
    "walk 10": (0.0, 10.0),
}


def bins_of(noise: ColouredNoise, shape: tuple[int, int], period_s: float, rng: np.random.Generator) -> Array:
    """Bins (runs, bins) of one kind of noise: flicker by its exact covariance, walks in eight steps a bin."""
    runs, bins = shape
    values = rng.normal(size=shape) * math.sqrt(noise.white / period_s)
    if noise.walk:
        steps = rng.normal(size=(runs, 8 * bins)) * math.sqrt(noise.walk * period_s / 8)
        values += np.cumsum(steps, axis=1).reshape(runs, bins, 8).mean(axis=2)
    if noise.flicker:
        covariance = toeplitz(flicker_covariance(math.sqrt(noise.flicker), period_s, bins))
        root = np.linalg.cholesky(covariance + 1e-12 * covariance[0, 0] * np.eye(bins))
        values += rng.normal(size=shape) @ root.T
    return values


def noise_study(units: int, seed: int) -> None:
    """Print the coverage of drift by noise, each kind by itself."""
    print(f"drift of single gyros, {units} units of {GYROS}, white noise of {WHITE} deg/sqrt(h) in all")
    for duration_s in (300.0, 6000.0):
        size = bin_size(round(128 * duration_s), 128.0, 1 << 20)
        period_s, bins = size / 128.0, round(128 * duration_s) // size
        basis = CurveBasis.of(0.0, duration_s, 0.06)
        columns = basis.columns((np.arange(bins) + 0.5) * period_s)
        terms = drift_terms(0.0, duration_s, basis.rate_rad_s) / duration_s
        row = terms @ basis.to_theta @ np.linalg.inv(columns @ columns.T) @ columns
        forms, grid = unit_forms(row[None], period_s), NoiseGrid.of(duration_s, period_s)
        for name, (flicker, walk) in KINDS.items():
            noise = ColouredNoise((60 * WHITE) ** 2, flicker**2, walk**2 / 3600)
            rng = np.random.default_rng([seed, round(duration_s)])
            values = bins_of(noise, (units * GYROS, bins), period_s, rng)
            actual = math.sqrt(combined(forms, noise)[0, 0])
            for record in ("states it", "is silent"):
                stated = [np.full(GYROS, noise.flicker), np.full(GYROS, noise.walk)]
                stated = stated if record == "states it" else [None, None]
                errors, within = [], []
                for unit in values.reshape(units, GYROS, bins):
                    known = posteriors(grid, likelihood(grid, columns, unit, period_s), *stated)
                    for value, gyro in zip(unit, known, strict=True):
                        variance = float(combined(forms, gyro.mean)[0, 0])
                        factor = coverage_factor(variance, gyro.variance_of(forms[:, 0, 0]))
                        errors.append(math.sqrt(variance))
                        within.append(abs(value @ row) < factor * errors[-1])
                covered, ratio = 100 * np.mean(within), np.mean(errors) / actual
                said = f"{duration_s:6.0f} s  {name:13s} record {record:10s}"
                print(f"{said} covered {covered:5.1f} %  mean error / actual {ratio:.2f}", flush=True)


def simulated(run: Run, record: CalibrationRecord, facts: RunFacts, seed: int) -> Iterator[Capture]:
    """A run by the simulator, with noise and without, truth drawn from what is stated."""
    drawn = select(draw_uncertainties([run], record, facts.axes, seed), [run.run_id], GYROS, "drawn")
    coefficients = NoiseCoefficients.of(record.stated_noise.model_dump())
    for forward in (
        ForwardRun(facts, coefficients, actions=drawn, seed=seed),
        ForwardRun(facts, actions=drawn, seed=seed),
    ):
        blocks = list(forward.blocks())
        counts = np.hstack([block.counts for block in blocks])
        time_s = np.concatenate([block.time_us for block in blocks]) / MICROSECONDS_PER_SECOND
        yield time_s, counts * facts.least_count


def injected(run: Run, record: CalibrationRecord, facts: RunFacts, seed: int) -> Iterator[Capture]:
    """The same by the withheld injector; its noise is of the size that the record states."""
    plain = record.model_dump(mode="json")
    plain["noise"] = record.stated_noise.model_dump()
    plain["uncertainty"] = record.stated_uncertainty.model_dump()
    one = withheld_run(run.model_dump(mode="json", by_alias=True))
    drawn = realistic_world(Campaign("coverage", withheld_unit(plain), (one,)), (), seed, noise_level_rel=0.0)
    for noisy in (True, False):
        stamps_us, counts = run_counts(World(drawn.campaign, drawn.truth, (), drawn.heat, seed, noisy), one)
        yield stamps_us / MICROSECONDS_PER_SECOND, counts.T * facts.least_count


MAKERS: dict[str, Callable[[Run, CalibrationRecord, RunFacts, int], Iterator[Capture]]] = {
    "simulator": simulated,
    "withheld": injected,
}


def budgets(
    run_id: str, noise: tuple[float, float], runs: int, seed: int, by: str
) -> Iterator[tuple[Budget, Budget]]:
    """Of runs: the budget of each, and that of the same run without noise, whose raw curves are the truth of
    the gyros' fits.
    """
    run = load_run(REPOSITORY / "campaigns/three-axes/runs" / run_id, need_capture=False)
    capture = run.capture.model_copy(update={"sample_rate_hz": 2.0, "volts_per_count": 1e-9})
    run = run.model_copy(update={"capture": capture})
    record, _ = load_calibration(CALIBRATIONS, run.calibration)
    sizes = dict(
        zip(
            ("angle_random_walk_deg_sqrt_h", "bias_instability_deg_h", "rate_random_walk_deg_h_sqrt_h"),
            ((size,) * GYROS for size in (WHITE, *noise)),
            strict=True,
        )
    )
    record = record.model_copy(update={"noise": record.noise.model_copy(update=sizes)})
    facts, stated = facts_of(run, record), StatedErrors.of(run, record)
    gyros, axes = [f"gyro{i + 1}" for i in range(GYROS)], ["x", "y", "z"]

    def budget(time_s: Array, raw: Array) -> Budget:
        rates = facts.projection @ rate_from_raw(raw, facts.scale_factor, facts.bias, facts.polarity)
        rates = remove_earth_rate(rates, facts.earth, facts.profile.angle_at(time_s))
        fit = Fit(facts, gyros + axes, time_s.size, 65536, stated, 0.5)
        none = np.zeros(raw.shape, np.uint8)
        fit.add(time_s, none[0], none, raw, rates)
        plain = as_plain(fit.fits(fit.bins()), [], fit.bin_s)
        return budget_of(facts, stated, plain, gyros, axes)

    for k in range(runs):
        noisy, quiet = (budget(*capture) for capture in MAKERS[by](run, record, facts, seed + k))
        yield noisy, quiet


def truth_of(commanded: float, duration_s: float, quantity: str) -> float:
    """Of an axis, Earth's part taken away: the commanded rate and nothing else."""
    return {"a": commanded, "mean_rate": commanded, "integral": commanded * duration_s}.get(quantity, 0.0)


def combined_study(runs: int, seed: int, by: str) -> None:
    """Print the coverage of combined uncertainties, noises and designs together and by noise."""
    designs = ("1-x-plus", "7-x-slow", "8-still")
    kinds = {name: KINDS[name] for name in ("white", "flicker 0.03", "walk 1")}
    each = math.ceil(runs / len(designs) / len(kinds))
    print(f"combined, {each * len(designs) * len(kinds)} runs by the {by}: {', '.join(designs)}, each noise")
    within: dict[tuple[str, str], list[bool]] = defaultdict(list)
    for kind, noise in kinds.items():
        for design in designs:
            run = load_run(REPOSITORY / "campaigns/three-axes/runs" / design, need_capture=False)
            record, _ = load_calibration(CALIBRATIONS, run.calibration)
            facts = facts_of(run, record)
            rate = facts.commanded_signs * facts.profile.rate_deg_s[0]
            for found, quiet in budgets(design, noise, each, seed, by):
                for (quantity, channel, _), value in found.values.items():
                    if channel in "xyz":
                        if quantity in ("b", "d", "accumulated_error"):
                            continue
                        true = truth_of(float(rate["xyz".index(channel)]), facts.profile.end_s, quantity)
                        name = f"axis {quantity}"
                    else:
                        if (quantity, channel, 1) not in quiet.values:
                            continue  # no sine to have a phase
                        true = quiet.values[quantity, channel, 1].value
                        name = f"gyro {quantity}"
                    off = abs(value.value - true)
                    off = min(off, 2 * math.pi - off) if quantity == "d" else off
                    within[kind, name].append(off < value.factor * value.combined)
                    within["all", name].append(within[kind, name][-1])
            print(f"  {kind}, {design}: done {time.strftime('%H:%M:%S')}", flush=True)
    for name in sorted({name for _, name in within}):
        shares = "  ".join(f"{kind} {100 * np.mean(within[kind, name]):5.1f}" for kind in ("all", *kinds))
        print(f"{name:16s} {shares}   ({len(within['all', name])} values)")


def main() -> None:
    """Both studies, or one."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("study", choices=("noise", "combined"))
    parser.add_argument("--runs", type=int, default=200, help="units of each noise, or runs in all")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--by", choices=tuple(MAKERS), default="simulator", help="what makes combined runs")
    options = parser.parse_args()
    print(machine())
    if options.study == "noise":
        noise_study(options.runs, options.seed)
    else:
        combined_study(options.runs, options.seed, options.by)


if __name__ == "__main__":
    main()
