"""`fogreduce curve`: Levenberg-Marquardt beside the linear fit, on a small run and on the published one."""

import re
from pathlib import Path

import pytest

from fogreduce.cli.main import main

REPOSITORY = Path(__file__).parents[2]
NUMBERS = re.compile(r"^  (\w+) +(\S+) +(?:(\S+) +)?(\S+)$")


@pytest.fixture
def reduced(small_lab, capsys):
    assert main(small_lab.reduce()) == 0
    capsys.readouterr()
    return small_lab


def rows(text: str) -> list[tuple[str, float, float, float]]:
    """Parameter, value, standard error (0: held), the linear fit's value, of every row printed."""
    found = [match.groups() for line in text.splitlines() if (match := NUMBERS.match(line))]
    return [
        (name, float(value), float(error or 0), float(linear))
        for name, value, error, linear in found
        if name != "parameter"
    ]


def test_equal_to_the_linear_fit(reduced, capsys):
    """With c held the two agree to 1e-9 relative: every axis, every parameter, c itself without an error."""
    assert main(["curve", str(reduced.out)]) == 0
    found = rows(capsys.readouterr().out)
    assert [name for name, *_ in found] == [
        "a_deg_s",
        "b_deg_s",
        "c_rad_s",
        "d_rad",
        "e_deg_s2",
        "sigma_deg_s",
    ] * 3
    for name, value, error, linear in found:
        assert value == pytest.approx(linear, rel=1e-9), name
        assert (error == 0) == (name[0] in "cs")


def test_one_gyro_and_a_free_rate(reduced, capsys):
    """The table turns at 10 deg/s in name only (no Earth's rate in these counts): c may go where it likes."""
    assert main(["curve", str(reduced.out), "--channel", "gyro2", "--free-rate"]) == 0
    said = capsys.readouterr().out
    assert "gyro2, segment 1 (0 to 60 s, 10 deg/s): 960 records, c free" in said
    found = {name: (value, error) for name, value, error, _ in rows(said)}
    assert found["c_rad_s"][1] > 0
    assert found["sigma_V"][0] == pytest.approx(300e-7, rel=0.1)  # the noise put in: 300 counts of 1e-7 V


def test_segments_and_a_standstill(small_lab, capsys):
    """Two rates and a stand: each segment on its own, without a sine where the table stands."""
    steps = [{"rate_deg_s": rate, "duration_s": 20.0} for rate in (30.0, 0.0, -30.0)]
    small_lab.write_run({"table.profile": steps})
    assert main(small_lab.reduce()) == 0
    capsys.readouterr()
    assert main(["curve", str(small_lab.out), "--channel", "x", "--free-rate"]) == 0
    blocks = capsys.readouterr().out.split("x, segment ")[1:]
    names = [[name[0] for name, *_ in rows(block)] for block in blocks]
    assert names == [list("abcdes"), list("aes"), list("abcdes")]
    assert "c held" in blocks[1]


def test_channel_that_is_not_there(reduced, capsys):
    assert main(["curve", str(reduced.out), "--channel", "gyro5"]) == 2
    expected = "--channel: found gyro5; expected one of x, y, z, gyro1, gyro2, gyro3, gyro4\n"
    assert capsys.readouterr().err == expected


def test_results_that_are_not_there(tmp_path, capsys):
    assert main(["curve", str(tmp_path)]) == 2
    expected = f"{tmp_path}/manifest.json: found no such file; expected the run's manifest\n"
    assert capsys.readouterr().err == expected


def test_curve_that_cannot_be_fitted(small_lab, capsys):
    """Gyro 3 never answers, so x, y and z have no record: said, and exit status 1."""
    from small_lab import header, records

    silent = records()
    silent["counts"][:, 2] = -(2**31)
    small_lab.write_capture(header(), silent.tobytes())
    assert main(small_lab.reduce()) == 0
    capsys.readouterr()
    assert main(["curve", str(small_lab.out), "--channel", "x"]) == 1
    said = capsys.readouterr()
    assert "the records do not determine a mean curve" in said.out
    assert said.err == f"{small_lab.out}: 1 curves could not be fitted\n"


def test_published_run_at_full_size(tmp_path, capsys):
    """768 000 records of the reconstructed published run, x, y, z and gyro 1: 1e-9 relative."""
    calibrations = ["--calibrations", str(REPOSITORY / "calibrations")]
    made, out = tmp_path / "published", tmp_path / "out"
    assert (
        main(["simulate", str(REPOSITORY / "campaigns" / "published"), *calibrations, "--out", str(made)])
        == 0
    )
    assert main(["reduce", str(made / "runs" / "x-one-turn"), *calibrations, "--out", str(out)]) == 0
    capsys.readouterr()
    for channel in ([], ["--channel", "gyro1"]):
        assert main(["curve", str(out), *channel]) == 0
        for name, value, _, linear in rows(capsys.readouterr().out):
            assert value == pytest.approx(linear, rel=1e-9), name
