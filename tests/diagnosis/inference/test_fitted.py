"""Stated errors of fitted parameters: residuals with noise, uncertainties and departures, fitted again."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.departures import WANDERS, departures, wandering
from fogreduce.diagnosis.inference.fitted import refined
from fogreduce.diagnosis.inference.model import simulated
from fogreduce.diagnosis.inference.noise_model import Metric, nuisances, whitener
from fogreduce.diagnosis.observe.capture import RunInput, read_inputs

DRAWS = 40


@pytest.fixture(scope="module")
def inputs(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> list[RunInput]:
    """Three runs about x, without captures, with a log of a wandering temperature."""
    root = tmp_path_factory.mktemp("campaign")
    shutil.copy(repository / "campaigns" / "three-axes" / "campaign.yaml", root)
    for k, name in enumerate(("1-x-plus", "2-x-minus", "7-x-slow")):
        folder = root / "runs" / name
        shutil.copytree(repository / "campaigns" / "three-axes" / "runs" / name, folder)
        (folder / "capture.fogcap").touch()
        t = np.arange(301.0)
        warm = 20.0 + 0.5 * np.sin(2 * np.pi * t / 250.0 + k) + 0.002 * t
        rows = [f"{s:.0f},26.0,{value:.4f}" for s, value in zip(t, warm, strict=True)]
        header = "time_s,electronics_degC,sensor_degC"
        (folder / "temperature.csv").write_text("\n".join([header, *rows]) + "\n")
    return read_inputs(root, repository / "calibrations")


def cause(effect: str, **theta: float) -> Cause:
    """An effect of gyro 2 in all runs."""
    return Cause(effect, ("gyro2",), ("*",), theta, {}, {})


@pytest.mark.parametrize(
    "truth",
    [
        cause("scale_factor_error", ppm=400.0),
        cause("bias_ramp", deg_h_per_h=60.0),
        cause("temperature_bias", deg_h_per_degC=4.0),
        cause("warm_up", deg_h=1.0, tau_s=40.0),
    ],
    ids=lambda c: c.effect,
)
def test_nineteen_of_twenty_parameters_lie_within_two_standard_deviations(
    inputs: list[RunInput], truth: Cause
) -> None:
    generator = np.random.default_rng(5)
    n = inputs[0].facts.n_gyros
    sizes = [np.full((n, one.scene.blocks.count), 128.0) for one in inputs]
    white = whitener(inputs, sizes, np.ones(n))
    columns = white(nuisances(inputs))
    metric = Metric.of(columns)
    nominal = white.rows.stacked([one.scene.block_means() for one in inputs])
    change = simulated(inputs, [truth], white.rows) - nominal
    act = truth.action([one.facts.run_id for one in inputs], n)
    shapes = departures(inputs, [act], 0, white.rows)
    pulls = []
    for _ in range(DRAWS):
        real = change + shapes @ generator.standard_normal(shapes.shape[1])
        y = white(real[:, None])[:, 0] + generator.standard_normal(len(real))
        y = y + columns @ generator.standard_normal(columns.shape[1])
        start = replace(truth, theta={k: 1.2 * v for k, v in truth.theta.items()})
        found = refined(inputs, [start], white, nominal, metric, y).causes[0]
        pulls += [(found.theta[k] - v) / found.std[k] for k, v in truth.theta.items()]
    assert np.mean(np.abs(pulls) < 2.0) > 0.88
    # and no wider than they need be
    assert np.std(pulls) > 0.6


def test_a_wandering_size_wanders_by_what_it_is_said_to(inputs: list[RunInput]) -> None:
    sizes = [np.full((4, one.scene.blocks.count), 128.0) for one in inputs]
    rows = whitener(inputs, sizes, np.ones(4)).rows
    ones = np.ones(rows.total)
    spread = np.sqrt(np.sum(wandering(inputs, ones, rows) ** 2, axis=1))
    np.testing.assert_allclose(spread, WANDERS, rtol=1e-9)


def test_a_tip_along_the_axis_is_not_claimed_to_be_known(inputs: list[RunInput]) -> None:
    x, y, _ = np.eye(3)
    tip = Cause(
        "axis_misalignment",
        ("gyro1",),
        ("*",),
        {"tip[0]": 0.3, "tip[1]": 0.4},
        {},
        {"tip[0]": 0.01, "tip[1]": 0.01},
        (x, y),
    )
    std = tip.stated()["mrad"]["std"]
    np.testing.assert_allclose(std[:2], [0.01, 0.01])
    assert std[2] > 0.5
