"""`reduction.complete_records: false`: records with missing gyros count, and count as they should."""

from __future__ import annotations

import numpy as np
import pytest

from fogreduce.estimate.curve_terms import drift_terms
from fogreduce.estimate.uncertainty import StatedErrors
from fogreduce.metadata.folder import load_calibration, load_run
from fogreduce.physics.earth_rate import remove_earth_rate
from fogreduce.physics.scale_factor import rate_from_raw
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.nominal_noise import NoiseCoefficients
from fogreduce.stages.fit import Fit
from fogreduce.stages.project import Projection

MISSING = np.int32(-2147483648)
EVERY = {"complete_records": False}


def losing(fraction, seed=7):
    def spoil(time_us, pulse, counts):
        struck = np.random.default_rng(seed).random(counts.shape) < fraction
        return time_us, pulse, np.where(struck, MISSING, counts)

    return spoil


def drifts(reduced, rule):
    rows = [row for row in reduced.table("drift_by_records") if row["rule"] == rule]
    return (
        np.array([float(row["drift_deg_h"]) for row in rows]),
        np.array([float(row["drift_err_deg_h"]) for row in rows]),
        [int(row["records"]) for row in rows],
    )


def test_both_rules_stand_side_by_side_and_the_ways_agree(bench) -> None:
    """One pass and stage after stage give the same bytes; the whole record's error is hardly exceeded."""
    run = bench.run(profile=[(3.0, 120.0)], spoil=losing(0.01))
    reduced, staged = bench.reduce(run, EVERY), bench.reduce_by_stages(run, EVERY)
    for name in ("drift", "rate_fit", "drift_by_records"):
        path = f"tables/{name}.csv"
        assert (reduced.out / path).read_bytes() == (staged.out / path).read_bytes()
    drift, error, records = drifts(reduced, "every")
    _, complete_error, complete_records = drifts(reduced, "complete")
    assert records == [7680 - n for n in [records_lost(reduced)] * 3]
    assert all(n < 7680 * 0.97 for n in complete_records)
    assert (error < complete_error).all()
    bench.capture(run)  # the same noise, nothing lost
    whole, whole_error, _ = drifts(bench.reduce(run, EVERY), "every")
    # One seed's scatter estimate moves the error by 1/sqrt(2 x 7680), so 1.02 holds with room.
    assert (error / whole_error < 1.02).all()
    assert drift == pytest.approx(whole, abs=4 * np.sqrt(0.02) * whole_error.max())


def records_lost(reduced) -> int:
    """Records of two answers or fewer, from the dataset's flags."""
    import h5py

    with h5py.File(reduced.dataset("calibrate")) as file:
        return int(np.count_nonzero((file["gyro_flag"][:] != 0).sum(axis=0) >= 2))


def test_the_default_is_the_papers_rule(bench) -> None:
    run = bench.run(profile=[(3.0, 60.0)], spoil=losing(0.01))
    reduced = bench.reduce(run)
    assert {row["rule"] for row in reduced.table("drift_by_records")} == {"complete"}
    drift, _, _ = drifts(reduced, "complete")
    assert drift == pytest.approx([float(row["drift_deg_h"]) for row in reduced.table("drift")])


def test_a_gyro_silent_from_the_middle_on_is_no_step(bench) -> None:
    """Biases that disagree by 20 deg/h: without account of it the rate would step by as much."""

    def spoil(time_us, pulse, counts):
        counts = counts.copy()
        counts[1] += np.int32(round(20 / 3600 * 0.079 / 1e-7))
        counts[1, counts.shape[1] // 2 :] = MISSING
        return time_us, pulse, counts

    reduced = bench.reduce(bench.run(profile=[(3.0, 120.0)], spoil=spoil), EVERY)
    drift, error, records = drifts(reduced, "every")
    assert records == [7680] * 3
    assert (np.abs(drift) < 5 * error).all()


def drift_of(facts, stated, rates, flags, complete_records):
    """Drift of x, y, z [deg/h] and its white error, from gyro rates (4, N) and their flags."""
    time_s = np.arange(rates.shape[1]) / facts.sample_rate_hz
    missing = np.where(flags > 0, np.nan, rates)
    axis = Projection(facts, complete_records).block(missing, flags, np.rint(time_s * 1e6).astype(int))
    axis = remove_earth_rate(axis, facts.earth, facts.profile.angle_at(time_s))
    channels = [*(f"gyro{i}" for i in range(1, 5)), "x", "y", "z"]
    fit = Fit(facts, channels, time_s.size, 65536, stated, 0.5, complete_records)
    fit.add(time_s, flags.any(axis=0).astype(np.uint8), flags, missing, axis)
    terms = drift_terms(0.0, facts.profile.end_s, fit.segments[0].basis.rate_rad_s)
    curves = [fit.segments[0].axes.fit(k) for k in range(3)]
    per_hour = 3600 / facts.profile.end_s
    return np.array([(terms @ c.theta, np.sqrt(terms @ c.covariance @ terms)) for c in curves]) * per_hour


@pytest.mark.slow
def test_one_per_cent_missing_leaves_the_drift_unbiased_and_its_error_within_2_per_cent(bench) -> None:
    """200 seeds, biases that disagree by 1 deg/h, white and flicker noise."""
    run = bench.run(profile=[(0.6, 600.0)], sample_rate_hz=16.0)
    facts = bench.facts(run)
    record, _ = load_calibration(bench.calibrations, "UNIT-4@v1")
    stated = StatedErrors.of(load_run(run), record)
    noise = NoiseCoefficients.of(record.stated_noise.model_dump())
    generator = np.random.default_rng(0)
    found = []
    for seed in range(200):
        counts = np.hstack([block.counts for block in ForwardRun(facts, noise, seed=seed).blocks()])
        rates = rate_from_raw(counts * 1e-7, facts.scale_factor, facts.bias, facts.polarity)
        rates += generator.normal(0, 1, (4, 1)) / 3600
        flags = (generator.random(rates.shape) < 0.01).astype(np.uint8)
        found.append(
            [drift_of(facts, stated, rates, flag, complete_records=False) for flag in (0 * flags, flags)]
        )
    whole, lossy = np.moveaxis(np.array(found), 1, 0)
    assert (lossy[..., 1].mean(axis=0) / whole[..., 1].mean(axis=0) <= 1.02).all()
    actual = np.sqrt((lossy[..., 0] ** 2).mean(axis=0) / (whole[..., 0] ** 2).mean(axis=0))
    assert (actual <= 1.02).all()
    moved = lossy[..., 0] - whole[..., 0]
    assert (np.abs(moved.mean(axis=0)) < 3 * moved.std(axis=0) / np.sqrt(200)).all()


def test_a_dead_gyro_does_not_enter_x_y_z(bench, capsys) -> None:
    """Constant from first to last record: no x, y, z by the paper's rule, else from the other three."""

    def spoil(time_us, pulse, counts):
        counts = counts.copy()
        counts[2] = 1234
        return time_us, pulse, counts

    run = bench.run(profile=[(3.0, 120.0)], spoil=spoil)
    reduced = bench.reduce(run)
    assert all(row["drift_deg_h"] == "" for row in reduced.table("drift"))
    assert "dead gyro" in capsys.readouterr().err
    rates = bench.reduce(run, EVERY).table("rates")
    assert [float(row["measured_deg_s"]) for row in rates] == pytest.approx([3.0, 0.0, 0.0], abs=2e-3)
