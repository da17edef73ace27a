"""Bandwidth by a swing: simulated filters of known time constant, and what a swing cannot tell."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from calibration_bench import BenchRun

from fogreduce.calibrate.derive import derive
from fogreduce.calibrate.readings import read_campaign
from fogreduce.calibrate.swings import SwingRun, at_instants, read_swings
from fogreduce.characterise.bandwidth import bandwidth_quantity, response_lines, swung_gyros
from fogreduce.characterise.quantity import Quantity
from fogreduce.cli.main import main
from fogreduce.errors import BadInput
from fogreduce.estimate.swing import swing_of
from fogreduce.physics.low_pass import of_steps

SQUARE = [(5.0 * (-1) ** k, 0.25) for k in range(120)]
#: Of the slow tests.
SEEDS = 20


def swing_run(run_id: str = "swing", up: str = "x", profile: Any = SQUARE) -> BenchRun:
    return BenchRun(run_id, up, profile, sample_rate_hz=128)


def filters(tau_ms: float) -> list[dict[str, Any]]:
    if tau_ms == 0:
        return []
    parameters = {"time_constant_ms": tau_ms}
    return [{"effect": "low_pass", "channels": ["*"], "runs": ["*"], "parameters": parameters}]


def quantities(swings: list[SwingRun]) -> list[Quantity]:
    swung, needs = swung_gyros(swings)
    return [bandwidth_quantity(gyro, swung, needs) for gyro in range(swings[0].facts.n_gyros)]


def simulated(bench: Any, tau_ms: float, seed: int, runs: Any = None) -> Path:
    options = ["--draw-uncertainties", "--seed", str(seed)]
    campaign: Path = bench.simulate(filters(tau_ms), runs or [swing_run()], options)
    return campaign


def pulls(bench: Any, tau_ms: float, seeds: range) -> list[float]:
    """(Bandwidth less true) over its standard uncertainty, of each gyro."""
    true = 1e3 / (2 * math.pi * tau_ms)
    out = []
    for seed in seeds:
        for one in quantities(read_swings(simulated(bench, tau_ms, seed), bench.calibrations)):
            assert one.value is not None
            assert one.std is not None
            assert one.std < 1e-3 * one.value
            out.append((one.value - true) / one.std)
    return out


@pytest.mark.parametrize("tau_ms", [5.0, 20.0])
def test_a_filter_is_found_within_its_uncertainty(bench: Any, tau_ms: float) -> None:
    """Of eight pulls two or more beyond 2 have a chance of 1 in 20, any beyond 4 of 1 in 2000."""
    found = np.abs(pulls(bench, tau_ms, range(2)))
    assert np.count_nonzero(found > 2) <= 1
    assert found.max() < 4


@pytest.mark.slow
@pytest.mark.parametrize("tau_ms", [5.0, 20.0])
def test_of_many_seeds_ninety_five_in_a_hundred_are_within_two(bench: Any, tau_ms: float) -> None:
    found = np.array(pulls(bench, tau_ms, range(SEEDS)))
    print(f"{tau_ms} ms: {np.count_nonzero(np.abs(found) < 2)} of {found.size}, rms {found.std():.2f}")
    # 76.4 of 80 expected within 2; 71 or fewer have a chance of 1 in 100.
    assert np.count_nonzero(np.abs(found) < 2) >= 72
    assert 0.8 < float(np.sqrt(np.mean(found**2))) < 1.25


def bounds(bench: Any, seeds: range) -> list[Quantity]:
    """Of units whose filter passes all."""
    return [
        one
        for seed in seeds
        for one in quantities(read_swings(simulated(bench, 0.0, seed), bench.calibrations))
    ]


def assert_bounds(found: list[Quantity], most_seen: int) -> None:
    seen = [one for one in found if one.high is not None]
    assert len(seen) <= most_seen
    for one in found:
        assert one.value is not None
        # Above half the sample rate; noise of 3e-5 deg/s beside an edge hides no tail of exp(-13).
        assert 64 < one.value < 500
        assert one.low is not None
        assert one.high is not None or one.low == one.value


def test_without_a_filter_there_is_a_lower_bound(bench: Any) -> None:
    assert_bounds(bounds(bench, range(1)), 0)


@pytest.mark.slow
def test_bounds_hold_over_many_seeds(bench: Any) -> None:
    """True tau 0: every bound holds; a filter that is not there is seen in 1 of 40 on average, here of 40."""
    assert_bounds(bounds(bench, range(10)), 4)  # 5 and more have a chance of 1 in 200


def small_swing(bench: Any, tau_s: float, seed: int, noise: float = 0.02) -> SwingRun:
    """A swing's samples drawn by hand, of a filter before plain sampling: noise as given [deg/s]."""
    one = read_swings(simulated(bench, 5.0, 0), bench.calibrations)[0]
    edge, rate = one.swing.steps.edge_s, one.swing.steps.rate_deg_s
    read = np.outer(
        one.facts.axes @ one.facts.commanded_signs, of_steps(edge, rate, tau_s, one.time_s - 3e-3)
    )
    return replace(one, rate=read + noise * np.random.default_rng(seed).standard_normal(read.shape))


def test_a_spurious_sample_and_holes_do_no_harm(bench: Any) -> None:
    one = small_swing(bench, 5e-3, 1)
    rate = one.rate.copy()
    rate[:, 777] = 40.0
    rate[:, 1000:1003] = np.nan
    rate[0, ::50] = np.nan
    for found in quantities([replace(one, rate=rate)]):
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - 1 / (2 * math.pi * 5e-3)) < 4 * found.std


def test_gain_and_phase_are_those_of_the_filter(bench: Any) -> None:
    swung, _ = swung_gyros([small_swing(bench, 5e-3, 1)])
    for one in swung:
        lines = response_lines(one)
        assert [line.frequency_hz for line in lines] == pytest.approx([2.0 * (2 * k + 1) for k in range(8)])
        for line in lines:
            turn = 2 * math.pi * line.frequency_hz
            true = np.exp(-1j * turn * 3e-3) / (1 + 1j * turn * 5e-3)
            assert abs(line.gain - abs(true)) < 4 * line.gain_std
            assert abs(line.phase_deg - math.degrees(np.angle(true))) < 4 * line.phase_std_deg


def test_readings_of_increments_are_means_over_their_interval(bench: Any) -> None:
    """The same filter, 5 ms, through samples that are means: taken as plain ones they would be off."""
    one = small_swing(bench, 5e-3, 1)
    edge, rate = one.swing.steps.edge_s, one.swing.steps.rate_deg_s
    fine = one.time_s[:, None] - one.step_s * (np.arange(400) + 0.5) / 400
    # off the edges' grid, so that the mean over an interval has an edge within it
    mean = of_steps(edge, rate, 5e-3, (fine - 3e-3).ravel()).reshape(fine.shape).mean(axis=1)
    read = np.outer(one.facts.axes @ one.facts.commanded_signs, mean)
    read += 0.01 * np.random.default_rng(2).standard_normal(read.shape)
    facts = replace(one.facts, captured_in="deg")
    for found in quantities([replace(one, rate=read, facts=facts)]):
        assert found.value is not None
        assert found.std is not None
        assert abs(found.value - 1 / (2 * math.pi * 5e-3)) < 4 * found.std


def test_what_a_swing_cannot_tell_names_the_one_that_could(bench: Any) -> None:
    one = small_swing(bench, 5e-3, 1)
    across = replace(one.facts, table_axis=np.array([0.0, 1.0, 0.0]))  # gyro4 lies along x
    assert "about an axis that the gyro senses" in quantities([replace(one, facts=across)])[3].needs
    fast = swing_of(replace(one.facts.profile, duration_s=one.facts.profile.duration_s / 20), None)
    assert fast is not None
    assert "hold for 0.0313 s" in quantities([replace(one, swing=fast)])[0].needs
    slow = small_swing(bench, 30.0, 1, noise=0.1)
    assert "hold for longer than 0.25 s" in quantities([slow])[0].needs
    assert "table swings" in bandwidth_quantity(0, [], {}).needs


def test_instants_are_the_line_through_stamps_of_whole_microseconds() -> None:
    pulse = np.array([0, 1, 2, 4, 5, 3, 6, 7])
    stamp = np.round(pulse * 7812.5 + 100).astype(np.int64)
    time_s, values = at_instants(pulse, stamp, np.delete(np.arange(8.0), [])[None, :])
    np.testing.assert_allclose(time_s, (np.arange(8) * 7812.5 + 100) * 1e-6, atol=3e-7)
    assert values[0].tolist() == [0.0, 1.0, 2.0, 5.0, 3.0, 4.0, 6.0, 7.0]


def test_a_swing_stays_out_of_what_wants_constant_rates(bench: Any, tmp_path: Path) -> None:
    """All quantities but the bandwidth are the same with it as without it; a swing alone is refused."""
    steady = [
        BenchRun(name, "x", [(rate, 24.0)], sample_rate_hz=128) for name, rate in (("1", 5.0), ("2", -5.0))
    ]
    campaign = simulated(bench, 5.0, 0, [*steady, swing_run()])
    place = ["--calibrations", str(bench.calibrations)]
    documents = []
    for name, more in (("with", []), ("without", ["--only-runs", "1,2"])):
        assert main(["report", str(campaign), *place, "--out", str(tmp_path / name), *more]) == 0
        documents.append(json.loads((tmp_path / name / "report.json").read_text()))
    swung, plain = ([q for q in d["quantities"] if q["quantity"] != "bandwidth"] for d in documents)
    assert swung == plain
    bandwidth = [q for q in documents[0]["quantities"] if q["quantity"] == "bandwidth"]
    assert all(q["low_95"] < 1e3 / (10 * math.pi) < q["high_95"] for q in bandwidth)
    assert len(documents[0]["response"]) == 4 * 8
    assert [run["run"] for run in documents[0]["runs"]] == ["1", "2", "swing"]
    page = (tmp_path / "with" / "index.html").read_text()
    assert "Response to a swing" in page
    assert "Response to a swing" not in (tmp_path / "without" / "index.html").read_text()
    with pytest.raises(BadInput, match="only runs that swing"):
        derive(campaign, bench.calibrations, ["swing"])


def test_standstills_beside_a_swing_in_a_run_count(bench: Any) -> None:
    profile = [(0.0, 20.0), *SQUARE[:40], (0.0, 20.0)]
    campaign = simulated(bench, 5.0, 0, [swing_run("both", profile=profile)])
    (readings,) = read_campaign(campaign, bench.calibrations)
    assert not ((readings.time_s > 19) & (readings.time_s < 31)).any()
    assert readings.time_s.size > 30
    (one,) = quantities(read_swings(campaign, bench.calibrations))[:1]
    assert one.value is not None
    assert one.std is not None
    assert abs(one.value - 1 / (2 * math.pi * 5e-3)) < 4 * one.std


def test_an_encoder_that_swings_about_the_command_is_compared_with(bench: Any) -> None:
    """The command stands still, the encoder's rows of 5 ms hold the square wave."""
    campaign = simulated(bench, 5.0, 0)
    folder = campaign / "runs" / "swing"
    run = yaml.safe_load((folder / "run.yaml").read_text())
    time_s = np.arange(0, 30.0001, 0.005)
    angle = np.interp(time_s, 0.25 * np.arange(121), np.cumsum([0.0] + [rate * 0.25 for rate, _ in SQUARE]))
    rows = (f"{t:.3f},{a:.9f}\n" for t, a in zip(time_s, angle, strict=True))
    (folder / "table.csv").write_text("time_s,angle_deg\n" + "".join(rows))
    run["table"]["profile"] = [{"rate_deg_s": 0.0, "duration_s": 30.0}]
    run["table_log"] = "table.csv"
    (folder / "run.yaml").write_text(yaml.safe_dump(run))
    with pytest.raises(BadInput, match="only runs that swing"):
        read_campaign(campaign, bench.calibrations)
    for one in quantities(read_swings(campaign, bench.calibrations)):
        assert one.value is not None
        assert one.std is not None
        assert "encoder" in one.note
        assert abs(one.value - 1 / (2 * math.pi * 5e-3)) < 4 * one.std
