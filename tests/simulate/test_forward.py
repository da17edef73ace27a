"""The chain forward, held against the reduction's own functions, the paper and hand cases."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from simulated_runs import facts, profile

from fogreduce.metadata.calibration import CalibrationRecord
from fogreduce.metadata.facts import RunFacts
from fogreduce.physics.alignment import axis_rates_from_gyro_rates
from fogreduce.physics.earth_rate import remove_earth_rate
from fogreduce.physics.quantization import raw_from_counts
from fogreduce.physics.scale_factor import rate_from_raw
from fogreduce.physics.table_motion import table_rates
from fogreduce.simulate.forward import ForwardRun
from fogreduce.simulate.nominal_noise import NoiseCoefficients

ROOT = Path(__file__).parents[2]
RUNS = {
    "the paper's": {
        "table": {"axis": [1.0, 0.0, 0.0], "profile": profile((0.06, 600.0))},
        "frame_signs": [1, 1, -1],
    },
    "tilted axis, several rates": {
        "table": {"axis": [0.0, 0.6, 0.8], "profile": profile((10.0, 20.0), (0.0, 5.0), (-0.5, 30.0))},
        "orientation": {"y": "down", "x": "east"},
        "azimuth_deg": 123.0,
        "site": {"latitude_deg": 61.0},
    },
    "standstill": {"table": {"axis": [0.0, 0.0, 1.0], "profile": profile((0.0, 50.0))}},
    "odd rate": {
        "table": {"axis": [1.0, 0.0, 0.0], "profile": profile((3.3, 40.0))},
        "capture": {"sample_rate_hz": 17.3},
    },
}


def reduced(run: RunFacts, volts: np.ndarray, time_s: np.ndarray) -> np.ndarray:
    """Volts to rates x, y, z without Earth's part, by the functions that the reduction uses."""
    rates = rate_from_raw(volts, run.scale_factor, run.bias, run.polarity)
    assert run.projection is not None
    axis_rates = axis_rates_from_gyro_rates(rates, run.projection)
    return remove_earth_rate(axis_rates, run.earth, run.profile.angle_at(time_s))


@pytest.mark.parametrize("name", RUNS)
def test_there_and_back_before_rounding(name: str) -> None:
    run = facts(**RUNS[name])
    forward = ForwardRun(run)
    time_s = np.arange(run.n_expected) / run.sample_rate_hz
    back = reduced(run, forward.volts(forward.readings(time_s)), time_s)
    commanded = table_rates(run.profile, run.table_axis, run.frame_signs, time_s)
    # 1e-12 of the largest rate in the chain, Earth's for the standstill
    largest = max(np.abs(commanded).max(), 0.004)
    assert np.abs(back - commanded).max() < 1e-12 * largest


@pytest.mark.parametrize("name", RUNS)
def test_there_and_back_through_counts(name: str) -> None:
    """Each gyro's rate comes back within half a count."""
    run = facts(**RUNS[name])
    forward = ForwardRun(run)
    blocks = list(forward.blocks())
    counts = np.concatenate([block.counts for block in blocks], axis=1)
    time_us = np.concatenate([block.time_us for block in blocks])
    pulse = np.concatenate([block.pulse for block in blocks])
    assert np.array_equal(pulse, np.arange(run.n_expected))
    assert np.abs(time_us - pulse / run.sample_rate_hz * 1e6).max() <= 0.5
    rates = rate_from_raw(raw_from_counts(counts, run.least_count), run.scale_factor, run.bias, run.polarity)
    exact = forward.readings(pulse / run.sample_rate_hz)
    half = 0.5 * run.least_count / run.scale_factor
    assert np.all(np.abs(rates - exact).max(axis=1) <= half * (1 + 1e-6))


def test_a_hand_case() -> None:
    """Pole, x up, standing: w is Earth's rate along x; raw volts follow from Tables 1 to 3 alone.

    G's first column is what each gyro sees of x; H G = 1, so sum_i H[0][i] M_i = W.
    """
    run = facts(site={"latitude_deg": 90.0}, table={"axis": [1.0, 0.0, 0.0], "profile": profile((0.0, 1.0))})
    readings = ForwardRun(run).readings(np.zeros(1))[:, 0]
    w = math.degrees(7.2921151467e-5)
    assert run.projection is not None
    assert run.projection @ readings == pytest.approx([w, 0.0, 0.0], abs=1e-15)
    volts = ForwardRun(run).volts(readings[:, None])[:, 0]
    # gyro 2's polarity is -1: v = -(C M + B)
    assert volts[1] == pytest.approx(
        -(8.964439238881419e-02 * readings[1] + 6.398748539807179e-04), rel=1e-14
    )


def test_noise_of_x_y_z_from_four_independent_gyros() -> None:
    """The paper's README of numbers: 2.72e-4, 3.02e-4, 4.02e-4 deg/s a sample (100 000 samples: 0.22 %)."""
    record = CalibrationRecord.from_yaml(ROOT / "calibrations" / "TETRA-01" / "2012a.yaml")
    run = facts(table={"axis": [1.0, 0.0, 0.0], "profile": profile((0.0, 800.0))})
    noise = NoiseCoefficients.of(record.stated_noise.model_dump())
    counts = np.concatenate([block.counts for block in ForwardRun(run, noise).blocks()], axis=1)
    volts = raw_from_counts(counts, run.least_count)
    rates = reduced(run, volts, np.arange(run.n_expected) / run.sample_rate_hz)
    # successive differences see the white noise alone
    sigma = np.std(np.diff(rates, axis=1), axis=1) / math.sqrt(2)
    assert sigma == pytest.approx([2.72e-4, 3.02e-4, 4.02e-4], rel=0.012)


def test_the_record_itself_is_the_papers() -> None:
    """33.4, 25.3, 29.6, 30.6 microvolts a sample at 128 Hz, from Table 4's errors; C of Table 2."""
    record = CalibrationRecord.from_yaml(ROOT / "calibrations" / "TETRA-01" / "2012a.yaml")
    white = np.array(record.stated_noise.angle_random_walk_deg_sqrt_h)
    volts = white / 60 * math.sqrt(128) * np.array(record.scale_factor)
    assert volts == pytest.approx([33.4e-6, 25.3e-6, 29.6e-6, 30.6e-6], rel=1e-5)


def test_any_number_of_gyros() -> None:
    """One gyro along z, given by axes in place of H."""
    from simulated_runs import run_data

    data = run_data(
        site={"latitude_deg": 90.0},
        table={"axis": [1.0, 0.0, 0.0], "profile": profile((10.0, 5.0))},
        orientation={"z": "up", "x": "east"},
        capture={"polarity": [1]},
    )
    calibration = {"axes": [[0.0, 0.0, 1.0]], "scale_factor_V_per_deg_s": [1.0], "bias_V": [0.0]}
    (block,) = ForwardRun(RunFacts.of(data, calibration)).blocks()
    assert block.counts.shape == (1, 640)
    assert block.counts[0, 0] == round(math.degrees(7.2921151467e-5) * 1e7)


def test_memory_stays_flat() -> None:
    """A record four times as long needs no more memory (traced; the blocks are not kept)."""
    import tracemalloc

    noise = NoiseCoefficients([0.002] * 4, [0.03] * 4, [0.0] * 4)
    peaks = []
    for seconds in (500.0, 2000.0):
        run = facts(table={"axis": [1.0, 0.0, 0.0], "profile": profile((0.06, seconds))})
        tracemalloc.start()
        for _ in ForwardRun(run, noise).blocks():
            pass
        peaks.append(tracemalloc.get_traced_memory()[1])
        tracemalloc.stop()
    assert peaks[1] < 1.05 * peaks[0]
    assert peaks[1] < 30e6
