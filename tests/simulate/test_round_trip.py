"""reduce(simulate(run)) through the commands, and the chain there and back for runs drawn at random."""

from __future__ import annotations

import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from simulated_runs import SCALE, H, facts, profile

from fogreduce.cli.main import main
from fogreduce.physics.alignment import axis_rates_from_gyro_rates
from fogreduce.physics.earth_rate import remove_earth_rate
from fogreduce.physics.scale_factor import rate_from_raw
from fogreduce.physics.table_motion import table_rates
from fogreduce.simulate.forward import ForwardRun

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def reduced(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Bundled runs, 30 s of each, simulated without noise and reduced: datasets by run id."""
    folder = tmp_path_factory.mktemp("round-trip")
    runs = ("1-x-plus", "4-y-minus", "5-z-plus", "7-x-slow", "8-still")
    for run_id in runs:
        here = folder / "campaign" / "runs" / run_id
        shutil.copytree(ROOT / "campaigns" / "three-axes" / "runs" / run_id, here)
        text = (here / "run.yaml").read_text().replace("duration_s: 300", "duration_s: 30")
        (here / "run.yaml").write_text(text)
    calibrations = ["--calibrations", str(ROOT / "calibrations")]
    out = folder / "out"
    assert main(["simulate", str(folder / "campaign"), *calibrations, "--out", str(out), "--no-noise"]) == 0
    found = {}
    for run_id in runs:
        results = folder / run_id
        assert main(["reduce", str(out / "runs" / run_id), *calibrations, "--out", str(results)]) == 0
        found[run_id] = results / "datasets" / "remove_earth.nc"
    return found


@pytest.mark.parametrize(
    ("run_id", "commanded"),
    [
        ("1-x-plus", (10.0, 0.0, 0.0)),
        ("4-y-minus", (0.0, -10.0, 0.0)),
        ("5-z-plus", (0.0, 0.0, 10.0)),
        ("7-x-slow", (0.5, 0.0, 0.0)),
        ("8-still", (0.0, 0.0, 0.0)),
    ],
)
def test_the_commanded_rate_comes_back(
    reduced: dict[str, Path], run_id: str, commanded: tuple[float, float, float]
) -> None:
    """Within what half a count of every gyro makes of x, y, z: sum over gyros of |H| 0.5 1e-7 V / C.

    Beside it, time stamps are whole microseconds: Earth's part moves by its rate of turn times 0.5 us.
    """
    with h5py.File(reduced[run_id]) as dataset:
        rates, flags = dataset["axis_rate"][:], dataset["flag"][:]
    assert rates.shape == (3, 30 * 128)
    assert not flags.any()
    half_count = np.abs(H) @ (0.5e-7 / np.array(SCALE))
    stamp = 0.00418 * np.radians(10.0) * 0.5e-6
    assert np.all(np.abs(rates - np.array(commanded)[:, None]).max(axis=1) <= half_count + stamp)


directions = st.tuples(*[st.floats(-1.0, 1.0)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)
signs = st.sampled_from([-1, 1])


@settings(max_examples=40, deadline=None)
@given(
    axis=directions,
    rates=st.lists(st.floats(-100.0, 100.0), min_size=1, max_size=4),
    latitude=st.floats(-90.0, 90.0),
    azimuth=st.floats(0.0, 360.0),
    frame_signs=st.tuples(signs, signs, signs),
    polarity=st.tuples(signs, signs, signs, signs),
    orientation=st.sampled_from(
        [{"x": "up", "z": "north"}, {"z": "down", "x": "east"}, {"y": "west", "z": "south"}]
    ),
)
def test_any_run_comes_back_before_rounding(
    axis: tuple[float, float, float],
    rates: list[float],
    latitude: float,
    azimuth: float,
    frame_signs: tuple[int, int, int],
    polarity: tuple[int, int, int, int],
    orientation: dict[str, str],
) -> None:
    run = facts(
        table={"axis": list(axis), "profile": profile(*((rate, 1.7) for rate in rates))},
        site={"latitude_deg": latitude},
        azimuth_deg=azimuth,
        frame_signs=list(frame_signs),
        orientation=orientation,
        capture={"polarity": list(polarity)},
    )
    forward = ForwardRun(run)
    time_s = np.arange(run.n_expected) / run.sample_rate_hz
    volts = forward.volts(forward.readings(time_s))
    readings = rate_from_raw(volts, run.scale_factor, run.bias, run.polarity)
    assert run.projection is not None
    axis_rates = axis_rates_from_gyro_rates(readings, run.projection)
    back = remove_earth_rate(axis_rates, run.earth, run.profile.angle_at(time_s))
    commanded = table_rates(run.profile, run.table_axis, run.frame_signs, time_s)
    largest = max(np.abs(commanded).max(), 0.004)
    assert np.abs(back - commanded).max() < 1e-12 * largest
