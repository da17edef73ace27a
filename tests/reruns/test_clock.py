"""Results that a clock gave times in the future lie in the past again; inputs from the future are named."""

from __future__ import annotations

import os
import time
from pathlib import Path

from fogreduce.reruns.clock import faults_of_inputs, from_the_future, make_old

DAY_S = 86_400.0


def written(path: Path, in_s: float) -> Path:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("x")
    os.utime(path, (time.time() + in_s,) * 2)
    return path


def test_results_from_the_future_become_older_than_any_input(tmp_path: Path) -> None:
    ahead = [
        written(tmp_path / name, DAY_S) for name in ("a/manifest.json", "a/tables/x.csv", "_summary/all.csv")
    ]
    right = written(tmp_path / "b/manifest.json", -DAY_S)
    before = right.stat().st_mtime_ns
    assert make_old(tmp_path, [tmp_path / "a", tmp_path / "b", tmp_path / "absent"])
    # Not 0, which Snakemake takes for no time at all.
    assert {path.stat().st_mtime for path in ahead} == {DAY_S}
    assert right.stat().st_mtime_ns == before
    assert not make_old(tmp_path, [tmp_path / "a", tmp_path / "b"])


def test_a_clock_that_is_a_little_ahead_is_none_of_our_business(tmp_path: Path) -> None:
    path = written(tmp_path / "a/outputs.json", 2.0)
    assert not from_the_future(path)
    assert not make_old(tmp_path, [tmp_path / "a"])


def test_inputs_from_the_future_are_named(tmp_path: Path) -> None:
    ahead, right = written(tmp_path / "capture.fogcap", DAY_S), written(tmp_path / "run.yaml", -1.0)
    (fault,) = faults_of_inputs([str(ahead), str(right), str(tmp_path / "absent")])
    assert str(fault).startswith(f"{ahead}: found a time in the future, ")
