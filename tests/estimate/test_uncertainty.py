"""Stated uncertainties carried to mean rate and drift: by hand, then against draws through the forward
physics."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fogreduce.constants import EARTH_RATE_DEG_S
from fogreduce.effects.selection import select
from fogreduce.estimate.curve_terms import mean_rate_terms
from fogreduce.estimate.mean_curve import CurveBasis
from fogreduce.estimate.uncertainty import RecordCovariance, StatedErrors, departures, stated_covariance
from fogreduce.metadata.facts import RunFacts
from fogreduce.metadata.folder import load_calibration, load_run
from fogreduce.physics.earth_rate import remove_earth_rate
from fogreduce.physics.frames import across
from fogreduce.simulate.draw import draw_uncertainties
from fogreduce.simulate.forward import ForwardRun

W = EARTH_RATE_DEG_S
NONE = StatedErrors(*(np.zeros(3) for _ in range(4)), 0.0, 0.0, 0.0)


def still_at_the_equator(rate: float = 0.0, duration: float = 1000.0) -> RunFacts:
    """Three orthogonal gyros, x up, z north, at the equator: Earth's rate is W along z."""
    run = {
        "run_id": "r",
        "unit": "U",
        "started_at": "2014-05-12T13:00:00Z",
        "site": {"latitude_deg": 0.0},
        "table": {"axis": "x", "profile": [{"rate_deg_s": rate, "duration_s": duration}]},
        "orientation": {"x": "up", "z": "north"},
        "capture": {"sample_rate_hz": 1.0, "volts_per_count": 1e-7, "polarity": [1, 1, 1]},
    }
    calibration = {"H": np.eye(3), "scale_factor_V_per_deg_s": [0.1, 0.1, 0.1], "bias_V": [0.0, 0.0, 0.0]}
    return RunFacts.of(run, calibration)


def mean_errors(facts: RunFacts, stated: StatedErrors) -> np.ndarray:
    """Standard errors of the mean rate about x, y, z [deg/s]."""
    profile = facts.profile
    terms = mean_rate_terms(0.0, profile.end_s, float(np.radians(profile.rate_deg_s[0])))
    return np.sqrt(np.einsum("j,ajk,k->a", terms, stated_covariance(facts, stated, 1), terms))


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"scale_factor_rel": np.full(3, 1e-3)}, [0.0, 0.0, 1e-3 * W]),
        ({"bias": np.array([1e-4, 0.0, 2e-4])}, [1e-3, 0.0, 2e-3]),
        ({"turn_on_bias_deg_h": np.full(3, 3.6)}, [1e-3] * 3),
        ({"axis_rad": np.full(3, 1e-3)}, [1e-3 * W, 1e-3 * W, 0.0]),  # z along Earth's: no first-order part
        ({"azimuth_deg": 1.0}, [0.0, W * np.sin(np.radians(1.0)), 0.0]),
        ({"latitude_deg": 1.0}, [W * np.sin(np.radians(1.0)), 0.0, 0.0]),
        ({"table_rate_ppm": 100.0}, [0.0, 0.0, 0.0]),
    ],
)
def test_at_a_standstill_by_hand(change: dict, expected: list[float]) -> None:
    np.testing.assert_allclose(
        mean_errors(still_at_the_equator(), replace(NONE, **change)), expected, atol=1e-12 * W, rtol=1e-9
    )


def test_a_turning_table_by_hand() -> None:
    """10 deg/s for 36 s, one turn: 100 ppm of the table's rate, 1e-3 of x's scale factor are both 1e-2
    deg/s or so."""
    facts = still_at_the_equator(10.0, 36.0)
    table = mean_errors(facts, replace(NONE, table_rate_ppm=100.0))
    np.testing.assert_allclose(table[0], 1e-3, rtol=1e-9)
    assert table[1:].max() < 2 * np.pi * 1e-4 * W  # Earth's part a turn's 1e-4 off, at most
    scale = mean_errors(facts, replace(NONE, scale_factor_rel=np.array([1e-3, 0.0, 0.0])))
    np.testing.assert_allclose(scale, [1e-2, 0.0, 0.0], atol=1e-15)


def test_sources_are_counted_and_ordered() -> None:
    """Five of each gyro, then azimuth, latitude and table."""
    facts = still_at_the_equator()
    found = departures(
        facts, replace(NONE, latitude_deg=1.0, bias=np.array([0.0, 1e-4, 0.0])), np.arange(3.0)
    )
    assert found.shape == (18, 3, 3)
    assert np.flatnonzero(np.abs(found).max(axis=(1, 2)) > 1e-12).tolist() == [6, 16]


@pytest.mark.parametrize("run_id", ["1-x-plus", "7-x-slow", "8-still"])
def test_against_draws_through_the_forward_physics(repository, run_id: str) -> None:
    """400 draws of everything, as ``simulate --draw-uncertainties`` makes them, reduced nominally and fitted.

    The scatter is known to 1 / sqrt(800) = 3.5 %; four of that. Means and slopes are compared, x, y, z.
    """
    run = load_run(repository / "campaigns/three-axes/runs" / run_id, need_capture=False)
    record, _ = load_calibration(repository / "calibrations", run.calibration)
    facts = RunFacts.of_models(run, record)
    stop = facts.profile.end_s
    time_s = stop * (np.arange(600) + 0.5) / 600
    basis = CurveBasis.of(0.0, stop, float(facts.profile.rate_deg_s[0]))
    columns = basis.columns(time_s)
    to_theta = basis.to_theta @ np.linalg.inv(columns @ columns.T) @ columns
    commanded = np.outer(facts.commanded_signs, facts.profile.rate_at(time_s))
    terms = mean_rate_terms(0.0, stop, basis.rate_rad_s)
    means = []
    for seed in range(400):
        drawn = draw_uncertainties([run], record, facts.axes, seed)
        readings = ForwardRun(facts, actions=select(drawn, [run.run_id], 4, "drawn")).readings(time_s)
        rates = remove_earth_rate(facts.projection @ readings, facts.earth, facts.profile.angle_at(time_s))
        means.append((rates - commanded) @ to_theta.T @ terms)
    stated = mean_errors(facts, StatedErrors.of(run, record))
    np.testing.assert_allclose(np.std(means, axis=0) / stated, 1.0, atol=4 / np.sqrt(800))


def test_a_records_covariance_stands_in_for_its_standard_deviations(repository) -> None:
    """Diagonal, it gives the same covariance; with bias and scale factor of each gyro in full correlation, at
    a standstill, where both are offsets, the gyros' parts add up instead of in squares."""
    run = load_run(repository / "campaigns/three-axes/runs/8-still", need_capture=False)
    record, _ = load_calibration(repository / "calibrations", run.calibration)
    facts, plain = RunFacts.of_models(run, record), StatedErrors.of(run, record)
    plain = replace(plain, turn_on_bias_deg_h=np.zeros(4), azimuth_deg=0.0, latitude_deg=0.0)
    sizes = np.array(
        [plain.scale_factor_rel, plain.bias / facts.scale_factor * 3600, plain.axis_rad, plain.axis_rad]
    ).T.ravel()
    names = ("scale_factor_rel", "bias_deg_h", "axis1_rad", "axis2_rad")
    stated = {
        "parameters": [f"gyro{i + 1}.{name}" for i in range(4) for name in names],
        "axis_directions": [d.tolist() for axis in facts.axes for d in across(axis)],
        "matrix": np.diag(sizes**2).tolist(),
    }
    diagonal = replace(plain, record=RecordCovariance.of_plain(stated, 4))
    np.testing.assert_allclose(
        stated_covariance(facts, diagonal, 1), stated_covariance(facts, plain, 1), rtol=1e-9, atol=1e-30
    )
    matrix = np.diag(sizes**2)
    for i in range(4):
        matrix[4 * i, 4 * i + 1] = matrix[4 * i + 1, 4 * i] = sizes[4 * i] * sizes[4 * i + 1]
    joined = replace(plain, record=RecordCovariance.of_plain(stated | {"matrix": matrix.tolist()}, 4))
    moved = departures(facts, plain, np.zeros(1))[:20, :, 0].reshape(4, 5, 3)
    both = moved[:, 0] + moved[:, 1]
    by_hand = (both**2).sum(axis=0) + (moved[:, 2:4] ** 2).sum(axis=(0, 1))
    np.testing.assert_allclose(stated_covariance(facts, joined, 1)[:, 0, 0], by_hand, rtol=1e-6)
    partly = {"parameters": ["gyro1.bias_deg_h"], "axis_directions": [], "matrix": [[1.0]]}
    assert RecordCovariance.of_plain(partly, 4) is None
