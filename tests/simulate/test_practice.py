"""The practice campaigns, made by an independent simulator from the same contract, held against ours.

The answers are put in, and the residual of each campaign, noise and stated uncertainties allowed for, is one
chi-square. Where /work/shared is absent the tests skip: the campaigns are not part of this repository.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from fogreduce.datasets.readers.fogcap import FogcapReader
from fogreduce.effects.selection import Action, action, select
from fogreduce.effects.table import EFFECTS
from fogreduce.metadata.effects_file import EffectEntry
from fogreduce.physics.noise import LOWEST_FLICKER_HZ, white_density
from fogreduce.physics.quantization import raw_from_counts
from fogreduce.physics.scale_factor import rate_from_raw
from fogreduce.simulate.draw import across
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.plan import Options, Plan, prepare

PRACTICE = Path("/work/shared/practice")
pytestmark = pytest.mark.skipif(not PRACTICE.exists(), reason="the practice campaigns are not here")

BLOCK_S = 4.0
N = 512  # samples a block, at 128 Hz


def block_means(values: np.ndarray, keep: np.ndarray) -> np.ndarray:
    """Means of the samples kept, (n, blocks)."""
    shape = (len(values), -1, N)
    kept = keep.reshape(shape)
    return np.where(kept, values.reshape(shape), 0.0).sum(axis=2) / kept.sum(axis=2)


def residuals(plan: Plan, run_id: str, answers: list[Action]) -> np.ndarray:
    """Measured less predicted [deg/s], block means, (n, blocks); spurious counts left out."""
    facts = plan.facts(run_id)
    run = plan.runs[run_id]
    reader = FogcapReader(plan.folder / "runs" / run_id / run.capture.file)
    counts = np.concatenate([block.counts for block in reader.blocks(65536)], axis=1)
    volts = raw_from_counts(counts, facts.least_count)
    measured = rate_from_raw(volts, facts.scale_factor, facts.bias, facts.polarity)
    plain = Plan(**{**vars(plan), "actions": answers})
    predicted = plain.forward(run_id).readings(np.arange(facts.n_expected) / facts.sample_rate_hz)
    difference = measured - predicted
    scatter = 1.4826 * np.median(np.abs(np.diff(difference, axis=1)), axis=1, keepdims=True) / np.sqrt(2)
    middle = np.median(difference, axis=1, keepdims=True)
    return block_means(difference, np.abs(difference - middle) < 12 * scatter)


def noise_covariance(white: float, flicker: float, blocks: int) -> np.ndarray:
    """Of block means [(deg/s)^2]: the integral of the contract's densities over the mean's response."""
    f = np.geomspace(LOWEST_FLICKER_HZ, 3.0, 60_000)
    density = (flicker / 3600) ** 2 / np.pi * np.sinc(f * BLOCK_S) ** 2  # times f, for d ln f
    step = np.log(f[1] / f[0])
    lags = [step * np.sum(density * np.cos(2 * np.pi * f * BLOCK_S * k)) for k in range(blocks)]
    lags[0] += white_density(white) / (2 * BLOCK_S)
    return np.array(lags)[np.abs(np.subtract.outer(np.arange(blocks), np.arange(blocks)))]


def nuisances(plan: Plan) -> list[tuple[Action, float]]:
    """Every stated uncertainty as an effect of size 1 with its standard deviation."""
    runs, record = list(plan.runs), next(iter(plan.records.values()))
    stated, first = record.stated_uncertainty, next(iter(plan.runs.values()))
    axes = plan.facts(runs[0]).axes
    found = [
        (action("table_rate_error", ["table"], runs, {"ppm": 1.0}, 4), first.table.rate_uncertainty_ppm),
        (
            action("latitude_error", ["table"], runs, {"deg": 1e-3}, 4),
            first.site.latitude_uncertainty_deg / 1e-3,
        ),
    ]
    for run_id, run in plan.runs.items():
        turned = action("heading_error", ["table"], [run_id], {"deg": 1e-2}, 4)
        found.append((turned, run.azimuth_uncertainty_deg / 1e-2))
    for i in range(4):
        gyro = [f"gyro{i + 1}"]
        bias = stated.bias[i] / record.scale_factor[i] * 3600
        found.append((action("bias_offset", gyro, runs, {"deg_h": 1.0}, 4), bias))
        found.append(
            (action("scale_factor_error", gyro, runs, {"ppm": 1.0}, 4), stated.scale_factor_rel[i] * 1e6)
        )
        for direction in across(axes[i]):
            tilted = action("axis_misalignment", gyro, runs, {"mrad": tuple(direction * 1e-2)}, 4)
            found.append((tilted, stated.axis_rad[i] / 1e-5))
        for run_id in runs:
            moved = action("turn_on_bias", gyro, [run_id], {"deg_h": 1.0}, 4)
            found.append((moved, stated.turn_on_bias_deg_h[i]))
    return found


@cache
def chi_squares(name: str, *, with_answers: bool = True) -> tuple[float, list[float]]:
    """p-values of the whole campaign and of each gyro alone."""
    from scipy.stats import chi2

    plan = prepare(PRACTICE / "campaigns" / name, PRACTICE / "calibrations", Options())
    told = json.loads((PRACTICE / "answers.json").read_text())[name]
    known = [EffectEntry.model_validate(entry) for entry in told if entry["effect"] in EFFECTS]
    answers = select(known, list(plan.runs), 4, "answers.json") if with_answers else []
    residual = np.array([residuals(plan, run_id, answers) for run_id in plan.runs])  # run, gyro, block
    runs, gyros, blocks = residual.shape
    times = np.arange(blocks * N // 16) * 16 / 128.0

    def means(run_id: str, extra: list[Action]) -> np.ndarray:
        readings = ForwardRun(plan.facts(run_id), None, extra).readings(times)
        return readings.reshape(gyros, blocks, -1).mean(axis=2)

    plain = {run_id: means(run_id, []) for run_id in plan.runs}
    columns = []
    for effect, sigma in nuisances(plan):
        column = np.zeros(residual.shape)
        for k, run_id in enumerate(plan.runs):
            if run_id in effect.runs:
                column[k] = (means(run_id, [effect]) - plain[run_id]) * sigma
        columns.append(column)
    design = np.array(columns)  # nuisance, run, gyro, block

    stated = next(iter(plan.records.values())).stated_noise
    noise = [
        noise_covariance(n, b, blocks)
        for n, b in zip(stated.angle_random_walk_deg_sqrt_h, stated.bias_instability_deg_h, strict=True)
    ]

    def p_value(chosen: list[int]) -> float:
        y = residual[:, chosen].reshape(-1)
        a = design[:, :, chosen].reshape(len(design), -1)
        covariance = a.T @ a
        for k in range(runs * len(chosen)):
            part = slice(k * blocks, (k + 1) * blocks)
            covariance[part, part] += noise[chosen[k % len(chosen)]]
        return float(chi2.sf(y @ np.linalg.solve(covariance, y), len(y)))

    return p_value([0, 1, 2, 3]), [p_value([i]) for i in range(gyros)]


@pytest.mark.parametrize("name", ["practice-1", "practice-2", "practice-3", "practice-4"])
def test_with_the_answers_put_in_nothing_is_left(name: str) -> None:
    whole, gyros = chi_squares(name)
    assert whole > 0.001
    assert min(gyros) > 0.001 / 4


def test_what_the_catalogue_does_not_name_is_left_at_gyro_1_alone() -> None:
    whole, gyros = chi_squares("practice-5")
    assert whole < 1e-6
    assert gyros[0] < 1e-6
    assert min(gyros[1:]) > 0.001


@pytest.mark.parametrize("name", ["practice-2", "practice-3"])
def test_without_the_answers_something_is_left(name: str) -> None:
    """The chi-square can fail: the same campaigns without what is wrong with them."""
    _, gyros = chi_squares(name, with_answers=False)
    assert min(gyros) < 1e-6
