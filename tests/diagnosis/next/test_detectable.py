"""What a planned campaign would show: against hand cases, against scaling laws, against simulation."""

from __future__ import annotations

import csv
import json
import shutil

import numpy as np
import pytest
from bench_lab import ONE_GYRO, lab, simulated

from fogreduce.cli.main import main
from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.next.detectable import detectable, groups
from fogreduce.diagnosis.next.detectable_row import Row, crossing, threshold
from fogreduce.diagnosis.observe.data import read_data
from fogreduce.effects.table import EFFECTS
from fogreduce.errors import BadInput


def rows(found: dict, effect: str) -> list[dict]:
    return [row for row in found["effects"] if row["effect"] == effect]


def test_crossing() -> None:
    assert crossing(lambda x: x * x - 9.0, 1e-3, 1e3) == pytest.approx(3.0)
    assert crossing(lambda x: -1.0, 1e-3, 1e3) is None


def test_groups_are_connected() -> None:
    a, b, c = (
        Row(name, ("gyro1",), ("*",), "", None, True, {}, rivals)
        for name, rivals in (
            ("bias_offset", ("scale_factor_error gyro1",)),
            ("scale_factor_error", ()),
            ("dropouts", ()),
        )
    )
    assert groups([a, b, c]) == [["bias_offset gyro1", "scale_factor_error gyro1"]]


def test_the_command_needs_no_captures_and_writes_tables_and_a_page(tmp_path, capsys) -> None:
    lab(tmp_path)
    arguments = ["diagnose", str(tmp_path / "plan"), "--calibrations", str(tmp_path / "cal"), "--detectable"]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 0
    printed = capsys.readouterr().out
    assert "bias_ramp" in printed
    found = json.loads((tmp_path / "out" / "detectable.json").read_text())
    # every name of the catalogue is either there or said not to show, and why
    named = {row["effect"] for row in found["effects"]}
    assert named | set(found["not_shown"]) == set(EFFECTS)
    assert "smooth random drift" in found["not_shown"]["temperature_bias"]
    with (tmp_path / "out" / "detectable.csv").open() as file:
        assert len(list(csv.DictReader(file))) == len(found["effects"])
    assert (tmp_path / "out" / "detectable.html").read_text().startswith("<!DOCTYPE html>")
    # a standstill, both senses and three axes tell a bias from a scale factor
    (offset,) = [row for row in rows(found, "bias_offset") if row["channels"] == ["gyro1"]]
    assert "scale_factor_error gyro1" not in offset["not_told_from"]
    # a line and a share of missing answers, by hand: so many standard deviations, so many hits
    assert 3.0 < rows(found, "dropouts")[0]["amplitude"] * 6 * 64 * 120 < 20.0


def test_one_run_at_one_rate_tells_little_apart(tmp_path) -> None:
    lab(tmp_path)
    found = detectable(tmp_path / "plan", tmp_path / "cal", only=("r0",))
    (offset,) = [row for row in rows(found, "bias_offset") if row["channels"] == ["gyro1"]]
    assert {"scale_factor_error gyro1", "turn_on_bias gyro1 in r0"} <= set(offset["not_told_from"])


def test_a_higher_probability_takes_more_and_longer_runs_less(tmp_path) -> None:
    lab(tmp_path / "a")
    lab(tmp_path / "b", duration_s=480.0)
    often, seldom, longer = (
        detectable(tmp_path / place / "plan", tmp_path / place / "cal", probability, only=("r0", "r1"))
        for place, probability in (("a", 0.99), ("a", 0.6), ("b", 0.6))
    )
    for name in ("bias_ramp", "dropouts", "periodic_interference", "common_noise"):
        sizes = [rows(found, name)[0]["amplitude"] for found in (often, seldom, longer)]
        assert sizes[0] > sizes[1] > sizes[2], name
    # rounding to whole microseconds is no chance: a clock that adds up to a half or so in a run is seen
    sizes = [rows(found, "clock_error")[0]["amplitude"] for found in (often, seldom, longer)]
    assert sizes[0] == sizes[1] == pytest.approx(4.0 * sizes[2], rel=1e-6)
    assert 0.4 < sizes[0] * 120.0 < 0.8


def test_one_gyro(tmp_path) -> None:
    lab(tmp_path, record=ONE_GYRO)
    found = detectable(tmp_path / "plan", tmp_path / "cal")
    assert found["not_shown"]["crosstalk"] == "needs a second gyro"
    assert rows(found, "bias_ramp")[0]["seen"]


@pytest.mark.parametrize(("option", "value"), [("probability", 1.0), ("snr", 0.1), ("without", ("bias",))])
def test_bad_options_are_named(tmp_path, option, value) -> None:
    lab(tmp_path)
    with pytest.raises(BadInput, match=option):
        detectable(tmp_path / "plan", tmp_path / "cal", **{option: value})


def test_the_threshold_is_even_odds() -> None:
    # one of forty names, one of four gyros, three to seven for a gap
    assert threshold(0.25) == pytest.approx(np.log(4.0 * 40.0 * 7.0 / 3.0))


@pytest.mark.slow
@pytest.mark.parametrize(
    "effect", ["bias_ramp", "scale_factor_asymmetry", "dropouts", "periodic_interference"]
)
def test_at_the_stated_amplitude_the_stated_share_is_seen(tmp_path, effect) -> None:
    lab(tmp_path)
    found = detectable(tmp_path / "plan", tmp_path / "cal", probability=0.9)
    row = rows(found, effect)[0]
    parameters = {row["parameter"]: row["amplitude"]}
    if effect == "periodic_interference":
        parameters["frequency_hz"] = 7.3
    entry = {"effect": effect, "channels": row["channels"], "runs": ["*"], "parameters": parameters}
    seen = 0
    for seed in range(20):
        bench = simulated(tmp_path, [entry], "bench", 500 + seed)
        search = Search(read_data(bench, tmp_path / "cal"), frozenset(EFFECTS))
        options = search.options(search.state([], search.problem))
        seen += bool(np.logaddexp.reduce([option.score for option in options]) + priors.LOG_GAP > 0.0)
        shutil.rmtree(bench)
    # of 20 at 0.9: fewer than 14 once in 400 times
    assert seen >= 14
