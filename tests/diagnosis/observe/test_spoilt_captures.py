"""Constant gyros, lost records, stamps that jump: said, located, and no more than that."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from bench_lab import ONE_GYRO, RECORD, diagnosed
from test_mixed_runs import campaign

from fogreduce.cli.main import main

RUNS = [("x", 10.0, 20.0, 100.0), ("x", -10.0, 20.0, 100.0), ("y", 10.0, 20.0, 100.0)]
QUIET = {
    **ONE_GYRO,
    "uncertainty": {"bias_V": [1e-5], "turn_on_bias_deg_h": [0.1], "axis_rad": [1e-5]},
    "noise": {"angle_random_walk_deg_sqrt_h": [1e-4], "bias_instability_deg_h": [1e-3]},
}


def rewritten(path: Path, change: Callable[[list[str]], list[str] | None]) -> None:
    """A csv-1 capture whose records (lists of fields) `change` makes others of; None leaves one out."""
    lines = path.read_text().splitlines()
    head = next(k for k, line in enumerate(lines) if line[0].isdigit())
    records = [change(line.split(",")) for line in lines[head:]]
    path.write_text("\n".join(lines[:head] + [",".join(r) for r in records if r is not None]) + "\n")


def capture(bench: Path, run: str) -> Path:
    return bench / "runs" / run / "capture.csv"


def constant(gyro: int, value: str) -> Callable[[list[str]], list[str]]:
    return lambda fields: [*fields[:gyro], value, *fields[gyro + 1 :]]


def places(found: dict[str, Any]) -> list[tuple[str, tuple[str, ...], tuple[str, ...], str]]:
    return [(w["stage"], tuple(w["channels"]), tuple(w["runs"]), w["feature"]) for w in found["where"]]


@pytest.mark.parametrize("value", ["0", "0.0123"])
def test_a_dead_gyro_is_named_and_is_nothing_else(tmp_path, capsys, value) -> None:
    bench = campaign(tmp_path, RECORD, RUNS)
    for run in ("r0", "r1", "r2"):
        rewritten(capture(bench, run), constant(2, value))
    found = diagnosed(tmp_path, bench)
    assert found["verdict"] == "unexplained"
    assert places(found) == [("link", ("gyro2",), ("r0", "r1", "r2"), "repeats")]
    assert [one["judged"] for one in found["constant_gyros"]] == ["dead"] * 3
    assert "gyro2 gives the one count" in capsys.readouterr().err
    assert "a dead gyro" in (tmp_path / "out-bench" / "index.html").read_text()


def test_a_gyro_that_dies_in_one_run(tmp_path) -> None:
    bench = campaign(tmp_path, RECORD, RUNS)
    rewritten(capture(bench, "r1"), constant(1, "0.2"))
    found = diagnosed(tmp_path, bench)
    assert places(found) == [("link", ("gyro1",), ("r1",), "repeats")]


def test_all_gyros_dead(tmp_path) -> None:
    bench = campaign(tmp_path, RECORD, RUNS[:1])
    rewritten(capture(bench, "r0"), lambda fields: [fields[0], *["0"] * 4])
    found = diagnosed(tmp_path, bench)
    assert found["verdict"] == "unexplained"
    assert {(stage, feature) for stage, _, _, feature in places(found)} == {("link", "repeats")}
    assert [one["judged"] for one in found["constant_gyros"]] == ["dead"] * 4


@pytest.mark.parametrize("record", [QUIET, {k: v for k, v in QUIET.items() if k != "noise"}])
def test_a_standstill_below_one_step_is_not_called_dead(tmp_path, record) -> None:
    # Earth's part of at most 15 deg/h is 0.0003 V here
    bench = campaign(tmp_path, record, [("x", 0.0, 20.0, 100.0)], volts_per_count=0.01)
    found = diagnosed(tmp_path, bench)
    assert found["verdict"] == "no_gap"
    assert [one["judged"] for one in found["constant_gyros"]] == ["below_step"]
    assert "nobody can tell" in (tmp_path / "out-bench" / "index.html").read_text()


def test_a_hole_is_said_and_located(tmp_path, capsys) -> None:
    bench = campaign(tmp_path, RECORD, RUNS)
    rewritten(capture(bench, "r1"), lambda f: None if 8.0 <= float(f[0]) < 13.0 else f)
    found = diagnosed(tmp_path, bench)
    assert places(found) == [("link", ("gyro1", "gyro2", "gyro3", "gyro4"), ("r1",), "missing")]
    assert "500 of 2000 records of r1" in capsys.readouterr().err


def test_stamps_that_step_back_are_said_and_located(tmp_path, capsys) -> None:
    bench = campaign(tmp_path, RECORD, RUNS)

    def back(fields: list[str]) -> list[str]:
        time = float(fields[0])
        return [f"{time - 10.0 * (time >= 12.0):.6f}", *fields[1:]]

    rewritten(capture(bench, "r1"), back)
    found = diagnosed(tmp_path, bench)
    assert found["where"]
    assert {(stage, runs) for stage, _, runs, _ in places(found)} == {("link", ("r1",))}
    assert "r1" in capsys.readouterr().err


def _outside(fields: list[str]) -> list[str]:
    return [f"{float(fields[0]) + 3600.0:.6f}", *fields[1:]]


def _one_alone(fields: list[str]) -> list[str] | None:
    return fields if fields[0].startswith("7.3") and float(fields[0]) < 7.305 else None


@pytest.mark.parametrize("change", [_outside, _one_alone])
def test_no_usable_record_is_no_health(tmp_path, capsys, change) -> None:
    bench = campaign(tmp_path, ONE_GYRO, RUNS[:1])
    rewritten(capture(bench, "r0"), change)
    arguments = ["--calibrations", str(tmp_path / "cal"), "--out", str(tmp_path / "out")]
    assert main(["diagnose", str(bench), *arguments]) == 2
    assert "capture.csv" in capsys.readouterr().err
