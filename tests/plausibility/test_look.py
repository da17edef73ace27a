"""Captures with one thing wrong each: `check` and `reduce` name it, good ones pass without a word."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from fogreduce.cli.main import main

HALF = {"sample_rate_hz": 100.0, "profile": [(10.0, 20.0)]}
CSV = {**HALF, "file_format": "csv-1"}


def kept(chosen, t, p, c):
    return t[chosen], p[chosen], c[:, chosen]


def constant(t, p, c):
    c = c.copy()
    c[1, 500:1000] = 2**31 - 1
    return t, p, c


def one_doubled(t, p, c):
    t = t.copy()
    t[700] = t[699]
    return t, p, c


def silent(t, p, c):
    c = c.copy()
    c[1] = -(2**31)
    return t, p, c


def spinning_up(t, p, c):
    """The table takes 2 s to reach its rate: all gyros' counts about their standing ones."""
    part = np.minimum(t / 2e6, 1.0)
    return t, p, np.rint(c * part).astype(np.int32)


WARNED = {
    "whole seconds": (CSV, lambda t, p, c: (t // 10**6 * 10**6, p, c), "steps of 1 s, 1980 equal"),
    "jitter": (
        CSV,
        lambda t, p, c: (t + np.random.default_rng(0).integers(-5000, 5000, t.size), p, c),
        "jitter of 0.0028",
    ),
    "a rate off by 1 %": (
        CSV,
        lambda t, p, c: ((t / 1.01).astype(np.int64), p, c),
        "found 100; expected 101 Hz",
    ),
    "a doubled stamp": (CSV, one_doubled, "1 record with the stamp of the one before"),
    "a step back": (
        CSV,
        lambda t, p, c: (t - (p >= 1000) * 10**7, p, c),
        "a step back of 10 s at record 1000",
    ),
    "a hole": (CSV, partial(kept, np.r_[0:500, 1000:2000]), "a hole of 5 s (500 records) at 5 s"),
    "half a file": (HALF, partial(kept, np.r_[0:990]), "990 records, 1010 lost (50.5 %)"),
    "a first stamp far from 0": (CSV, lambda t, p, c: (t + 5 * 10**6, p, c), "capture.time_zero"),
    "a jump": (HALF, lambda t, p, c: (t + (p >= 800) * 2_500_000, p, c), "1200 of 2000 stamps that disagree"),
    "a rail": (HALF, constant, "gyro2: found 50"),
    "an absent gyro": (HALF, silent, "gyro2: found no reading in the whole run"),
    "a table that spins up": (HALF, spinning_up, "until the table turned at 10 deg/s"),
}


def run_both(bench, run, capsys) -> list[tuple[int, str]]:
    """Exit status and standard error of check and reduce."""
    said = []
    for words in (["check", run], ["reduce", run, "--out", bench.root / "out"]):
        status = main([str(word) for word in (*words, "--calibrations", bench.calibrations)])
        said.append((status, capsys.readouterr().err))
    return said


@pytest.mark.parametrize("name", WARNED)
def test_what_is_wrong_is_named(bench, capsys, name: str) -> None:
    options, spoil, words = WARNED[name]
    for status, error in run_both(bench, bench.run(spoil=spoil, **options), capsys):
        assert status == 0
        assert any(line.startswith("warning: ") and words in line for line in error.splitlines()), error
    assert "\nwarning," in (bench.root / "out" / "tables" / "warnings.csv").read_text()


REFUSED = {
    "all late by an hour": (HALF, lambda t, p, c: (t + 3600 * 10**6, p, c), "stamps from 3600 to 3619.99 s"),
    "all late by 5 s": (HALF, lambda t, p, c: (t + 5 * 10**6, p, c), "disagree with the records' numbers"),
    "Unix time": (CSV, lambda t, p, c: (t + 1_399_899_600 * 10**6, p, c), "Unix time); expected 0 to 20 s"),
    "GPS time": (CSV, lambda t, p, c: (t + 1_083_934_816 * 10**6, p, c), "GPS time); expected 0 to 20 s"),
    "half the rate": (HALF, lambda t, p, c: (2 * t, p, c), "found 100; expected 50 Hz"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_what_cannot_be_used_is_refused(bench, capsys, name: str) -> None:
    options, spoil, words = REFUSED[name]
    for status, error in run_both(bench, bench.run(spoil=spoil, **options), capsys):
        assert status == 2
        assert words in error
        assert len(error.splitlines()) == 1
    assert not (bench.root / "out").exists()


@pytest.mark.parametrize("seed", range(6))
def test_good_runs_are_not_warned_of(bench, capsys, seed: int) -> None:
    profile = [[(10.0, 20.0)], [(0.0, 30.0)], [(3.0, 20.0), (-6.0, 20.0), (0.0, 20.0)]][seed % 3]
    file_format = ("fogcap-1", "csv-1")[seed % 2]
    run = bench.run(f"r{seed}", profile=profile, seed=seed, file_format=file_format)
    for status, error in run_both(bench, run, capsys):
        assert (status, error) == (0, "")


def test_logs_of_another_run_or_of_a_part(bench, capsys) -> None:
    folder = bench.campaign / "runs" / "r1"
    folder.mkdir(parents=True)
    (folder / "temperature.csv").write_text("time_s,electronics_degC,sensor_degC\n0,20,21\n")
    run = bench.run(temperature="temperature.csv", **HALF)
    for rows, words in (
        ("1747053000,20,21\n1747053010,20,21\n", "Unix time"),
        ("0,20,21\n8,20,21\n", "a part of the run"),
        ("100,20,21\n900,20,21\n", "the log of another run?"),
    ):
        (run / "temperature.csv").write_text("time_s,electronics_degC,sensor_degC\n" + rows)
        assert main(["check", str(run), "--calibrations", str(bench.calibrations)]) == 0
        assert words in capsys.readouterr().err


def test_an_encoder_of_another_profile(bench, capsys) -> None:
    run = bench.run(encoder=lambda t: 9.0 * t, **HALF)
    assert main(["check", str(run), "--calibrations", str(bench.calibrations)]) == 0
    assert "found 9 deg/s in segment 1; expected 10 deg/s" in capsys.readouterr().err
