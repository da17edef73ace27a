"""Red flags on standard error of `reduce` and of the last stage; good runs are silent."""

from __future__ import annotations

import re
from pathlib import Path

from fogreduce.cli.main import main

TURN = ((10.0, 36.0),)


def reduced(bench, run: Path, out: Path) -> int:
    told = ("--calibrations", str(bench.calibrations), "--out", str(out))
    return main(["reduce", str(run), *told])


def test_a_good_run_says_nothing_of_rates(bench, tmp_path, capsys) -> None:
    assert reduced(bench, bench.run(profile=TURN, sample_rate_hz=16.0), tmp_path / "out") == 0
    assert "red flag" not in capsys.readouterr().err


def test_a_wrong_sign_is_said(bench, tmp_path, capsys) -> None:
    run, out = bench.run(profile=TURN, sample_rate_hz=16.0), tmp_path / "out"
    text = (run / "run.yaml").read_text()
    (run / "run.yaml").write_text(text.replace("polarity: [1, -1", "polarity: [-1, -1"))
    assert text != (run / "run.yaml").read_text()
    assert reduced(bench, run, out) == 0
    err = capsys.readouterr().err
    assert "red flag: made-up/r1: x, segment 1: mean rate" in err
    assert "deg/s, commanded 10 (\u2212" in err
    assert not re.search(r"[ (]-\d", err)  # no hyphen for a minus
    assert "looks like the other sign: gyro1 (capture.polarity)" in err
    assert main(["stage", "drift", "--out", str(out)]) == 0
    assert capsys.readouterr().err == err


def test_an_absent_gyro_is_said(bench, tmp_path, capsys) -> None:
    def without_gyro3(time_us, pulse, counts):
        counts = counts.copy()
        counts[2] = -(2**31)
        return time_us, pulse, counts

    run = bench.run(profile=TURN, sample_rate_hz=16.0, spoil=without_gyro3)
    assert reduced(bench, run, tmp_path / "out") == 0
    lines = [line for line in capsys.readouterr().err.splitlines() if line.startswith("red flag: ")]
    assert lines[0] == "red flag: made-up/r1: x, segment 1: no rate: no record of gyro3"
    assert len(lines) == 4
    assert "rates.csv" in lines[3]
