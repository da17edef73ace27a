"""What is done at once or remembered gives what the plain way gives."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from bench_lab import lab, simulated

from fogreduce.diagnosis.inference.candidate import pairs
from fogreduce.diagnosis.inference.candidates import Candidates
from fogreduce.diagnosis.inference.evidence import WhitenedResidual
from fogreduce.diagnosis.inference.noise_model import Metric
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.observe.data import Data, read_data
from fogreduce.diagnosis.which.full_rate.converter import Codes
from fogreduce.effects.selection import action
from fogreduce.simulate.forward import ForwardRun

RAMP = {"effect": "bias_ramp", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h_per_h": 40.0}}


@pytest.fixture(scope="module")
def data(tmp_path_factory) -> Data:
    root: Path = tmp_path_factory.mktemp("lab")
    lab(root, duration_s=40.0)
    return read_data(simulated(root, [RAMP]), root / "cal")


@pytest.fixture(scope="module")
def search(data) -> Search:
    return Search(
        data, frozenset({"bias_ramp", "bias_step", "scale_factor_error", "magnetic_bias", "latency"})
    )


@cache
def columns(rows: int, points: int, k: int, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((rows, points, k))


@pytest.mark.parametrize(("points", "k", "other"), [(1, 4, 2), (7, 1, 1), (5, 2, 3), (3, 5, 4)])
def test_inner_products_point_by_point(points, k, other) -> None:
    x, y = columns(30, points, k), columns(30, points, other, 2)
    np.testing.assert_allclose(pairs(x, y), np.einsum("mjk,mjl->jkl", x, y), rtol=1e-12, atol=1e-12)


def test_a_whitener_is_its_filters_one_by_one(search) -> None:
    whiten = search.problem.whiten
    values = columns(whiten.rows.total, 3, 1)[:, :, 0]
    plain = np.empty_like(values)
    for (i, r), matrix in whiten.filters.items():
        plain[whiten.rows.of(i, r)] = matrix @ values[whiten.rows.of(i, r)]
    np.testing.assert_allclose(whiten(values), plain, rtol=1e-12, atol=1e-12)
    part = whiten.rows.of(1)
    np.testing.assert_allclose(whiten(values[part], part), plain[part], rtol=1e-12, atol=1e-12)


def test_candidates_fitted_together_are_fitted_as_alone(search) -> None:
    further = columns(search.problem.whiten.rows.total, 2, 1)[:, :, 0]
    plain = Metric.of(search.problem.metric.a)
    for metric in (search.problem.metric, search.problem.metric.with_free(further)):
        residual = WhitenedResidual.of(metric, search.problem.y)
        # a metric of its own, that remembers nothing
        bare = WhitenedResidual.of(Metric.of(metric.a) if metric.parent else plain, search.problem.y)
        for candidates in (search.problem.candidates, search.problem.families):
            for fit in candidates.fits(residual):
                alone = bare.fit(fit.candidate)
                assert fit.best == alone.best
                assert fit.log_b == pytest.approx(alone.log_b, rel=1e-7, abs=1e-7)
                assert fit.q == pytest.approx(alone.q, rel=1e-7, abs=1e-7)
                np.testing.assert_allclose(fit.coefficients, alone.coefficients, rtol=1e-5, atol=1e-6)


def test_bundles_keep_the_order(search) -> None:
    candidates = list(search.problem.families)
    fits = Candidates(candidates).fits(WhitenedResidual.of(search.problem.metric, search.problem.y))
    assert all(fit.candidate is one for fit, one in zip(fits, candidates, strict=True))


@pytest.mark.parametrize(
    ("effect", "channel", "parameters"),
    [("scale_factor_error", "gyro1", {"ppm": 50.0}), ("heading_error", "table", {"deg": 0.2})],
)
def test_a_motion_worked_out_before_changes_nothing(data, effect, channel, parameters) -> None:
    one = data.inputs[0]
    acting = [action(effect, [channel], data.run_ids, parameters, data.n)]
    times = one.scene.blocks.time_s
    known = ForwardRun(one.facts, None, acting, turning=one.scene.turning).readings(times)
    np.testing.assert_array_equal(known, ForwardRun(one.facts, None, acting).readings(times))


def test_filters_and_eigenvectors_made_before_are_those_made_anew(data, search) -> None:
    again = Search(data, search.allowed)
    residual = again.state([], again.problem).residual
    first = list(search.problem.processes.findings(residual, search.allowed))
    search._problem(())
    second = list(search._problem(()).processes.findings(residual, search.allowed))
    anew = list(again.problem.processes.findings(residual, search.allowed))
    for one, two, three in zip(first, second, anew, strict=True):
        assert one.log_b == two.log_b
        assert one.log_b == pytest.approx(three.log_b, rel=1e-9)


def test_waves_turned_on_from_stretch_to_stretch() -> None:
    generator = np.random.default_rng(4)
    noise = generator.standard_normal(300)
    codes = Codes(
        np.sort(generator.uniform(-0.9, 0.9, 300)), np.full(300, 40.0), noise, 1e-3, noise, np.zeros(0)
    )
    first, step = 2.0e3, 0.07
    found = codes.scores(first, step, 1100)
    np.testing.assert_allclose(found, codes.score(first + step * np.arange(1100)), rtol=1e-9, atol=1e-9)
