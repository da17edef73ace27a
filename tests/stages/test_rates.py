"""rates.csv: good runs pass, and each plausible mistake in run.yaml or record is flagged and named."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from fogreduce.metadata.yaml12 import dump_yaml, load_yaml

TURN = ((10.0, 72.0),)
STEPS = ((10.0, 36.0), (-10.0, 36.0), (0.0, 36.0))


def edited(path: Path, key: str, value: Any) -> None:
    """A YAML file with the value at a dotted key put in, a function of the old value or a value."""
    data = load_yaml(path)
    *parents, last = [int(part) if part.isdigit() else part for part in key.split(".")]
    place = data
    for part in parents:
        place = place[part]
    place[last] = value(place[last]) if callable(value) else value
    path.write_text(dump_yaml(data))


def rates(bench, run: Path) -> list[dict[str, str]]:
    return bench.reduce(run).table("rates")


def verdicts(rows: list[dict[str, str]]) -> dict[tuple[str, str], str]:
    return {(row["axis"], row["segment"]): row["verdict"] for row in rows}


def times(factor: float):
    return lambda values: [factor * value for value in values]


@pytest.mark.parametrize("n", [1, 2, 3, 4, 6])
@pytest.mark.parametrize("profile", [TURN, STEPS, ((0.0, 60.0),), ((0.06, 120.0),)])
def test_a_good_run_is_ok(bench, n: int, profile) -> None:
    """Units of one or two gyros have a row for each gyro in place of x, y, z."""
    rows = rates(bench, bench.run(n=n, profile=profile, sample_rate_hz=16.0))
    assert set(verdicts(rows).values()) == {"ok"}
    names = [f"gyro{i + 1}" for i in range(n)] if n < 3 else list("xyz")
    segments = [str(k + 1) for k in range(len(profile))] + (["all"] if len(profile) > 1 else [])
    assert sorted(verdicts(rows)) == sorted((name, segment) for name in names for segment in segments)
    assert all(row["looks_like"] == "" for row in rows)


def test_the_numbers_of_a_row(bench) -> None:
    """A gyro whose scale factor is 1 % less than stated: 10 deg/s read as 9.9 by three orthogonal gyros."""
    run = bench.run(n=3, profile=TURN, sample_rate_hz=16.0, noise=False)
    record = bench.calibrations / "UNIT-3" / "v1.yaml"
    edited(record, "scale_factor_V_per_deg_s", lambda values: [values[0] / 0.99, *values[1:]])
    row = rates(bench, run)[0]
    got = {name: float(text) for name, text in row.items() if name.endswith(("_s", "_h", "ppm", "sigma"))}
    assert got["commanded_deg_s"] == 10.0
    # Earth's part, -5.928 deg/h on x, is read 1 % less too.
    assert got["measured_deg_s"] == pytest.approx(9.9 + 0.01 * 5.928 / 3600, abs=1e-6)
    assert got["difference_deg_s"] == pytest.approx(got["measured_deg_s"] - 10.0)
    assert got["difference_deg_h"] == pytest.approx(3600 * got["difference_deg_s"])
    assert got["difference_ppm"] == pytest.approx(1e5 * got["difference_deg_s"])
    # The default 100 ppm of 10 deg/s, 1 deg/h of bias and as much of turn-on bias; the rest is less.
    stated = ((10 * 1e-4) ** 2 + 2 * (1 / 3600) ** 2) ** 0.5
    assert got["difference_err_stated_deg_s"] == pytest.approx(stated, rel=0.01)
    assert got["difference_err_deg_s"] >= got["difference_err_stated_deg_s"]
    assert got["difference_sigma"] == pytest.approx(got["difference_deg_s"] / got["difference_err_deg_s"])


RUN_MISTAKES = [
    ("table.profile.0.rate_deg_s", 600.0, "a factor of 60:"),
    ("table.profile.0.rate_deg_s", 10 / 60, "a factor of 60:"),
    ("table.profile.0.rate_deg_s", -10.0, "the other sign: the table"),
    ("table.profile.0.rate_deg_s", 10.1, "a factor of 0.990"),
    ("table.axis", "y", "the rate of axis x"),
    ("table.axis", [-1.0, 0.0, 0.0], "the other sign: the table"),
    ("capture.polarity.0", -1, "the other sign: gyro1"),
    ("capture.polarity", [-1, 1, -1, -1], "the other sign: every gyro"),
    ("frame_signs", [1, 1, 1], "the other sign: axis z"),
    ("site.latitude_deg", 23.2, "a latitude of the other sign"),
    ("azimuth_deg", 90.0, "an azimuth of about 90 deg less"),
    ("azimuth_deg", -40.0, "an azimuth of about 40 deg more"),
    ("orientation", {"x": "up", "z": "east"}, "an azimuth of about 90 deg less"),
    ("orientation", {"x": "north", "z": "up"}, "the orientation x up and z north"),
]


@pytest.mark.parametrize(("key", "value", "words"), RUN_MISTAKES)
def test_mistakes_in_run_yaml(bench, key: str, value: Any, words: str) -> None:
    run = bench.run(profile=TURN, sample_rate_hz=16.0)
    edited(run / "run.yaml", key, value)
    rows = rates(bench, run)
    assert "gross" in verdicts(rows).values()
    assert any(words in row["looks_like"] for row in rows), rows


RECORD_MISTAKES = [
    ("scale_factor_V_per_deg_s", times(3600.0), "a factor of 3600: readings smaller"),
    ("scale_factor_V_per_deg_s", times(57.29577951308232), "a factor of 57.2958"),
    ("scale_factor_V_per_deg_s.2", lambda value: 10 * value, "in the scale factor of gyro3"),
]


@pytest.mark.parametrize(("key", "value", "words"), RECORD_MISTAKES)
def test_mistakes_in_the_record(bench, key: str, value: Any, words: str) -> None:
    run = bench.run(profile=TURN, sample_rate_hz=16.0)
    record = bench.calibrations / "UNIT-4" / "v1.yaml"
    edited(record, key, value)
    rows = rates(bench, run)
    assert any(words in row["looks_like"] for row in rows), rows


def test_biases_of_the_other_sign(bench) -> None:
    """Up to 19 deg/h at a standstill, where the default uncertainties are 1.4 deg/h."""
    run = bench.run(profile=((0.0, 60.0),), sample_rate_hz=16.0)
    edited(bench.calibrations / "UNIT-4" / "v1.yaml", "bias_V", times(-1.0))
    assert any("the other sign: biases" in row["looks_like"] for row in rates(bench, run))


@pytest.mark.parametrize("n", [1, 2])
def test_mistakes_of_units_without_axes(bench, n: int) -> None:
    """One or two gyros: each against the part of the command along its own axis."""
    run = bench.run(n=n, profile=TURN, sample_rate_hz=16.0)
    edited(run / "run.yaml", "capture.polarity.0", -1)
    rows = rates(bench, run)
    assert verdicts(rows)["gyro1", "1"] == "gross"
    assert "the other sign" in rows[0]["looks_like"]
    assert float(rows[0]["measured_deg_s"]) == pytest.approx(-10.0, abs=0.02)


def test_a_gyro_absent_from_the_whole_run(bench) -> None:
    """x, y, z are blank and say why; the other gyros stand by themselves."""

    def without_gyro2(time_us, pulse, counts):
        counts = counts.copy()
        counts[1] = -(2**31)
        return time_us, pulse, counts

    rows = rates(bench, bench.run(profile=TURN, sample_rate_hz=16.0, spoil=without_gyro2))
    assert verdicts(rows) == {
        **{(axis, "1"): "none" for axis in "xyz"},
        **{(gyro, "1"): "ok" for gyro in ("gyro1", "gyro3", "gyro4")},
        ("gyro2", "1"): "none",
    }
    assert {row["looks_like"] for row in rows if row["verdict"] == "none"} == {"no record of gyro2"}


def test_what_no_single_mistake_explains_is_flagged_all_the_same(published) -> None:
    """The published run: 9.53, -11.00 and 14.00 deg/h off (README of the paper), by more than 200 sigma."""
    rows = published.reduced.table("rates")
    assert [row["verdict"] for row in rows] == ["flag"] * 3
    assert [float(row["difference_deg_h"]) for row in rows] == pytest.approx([9.53, -11.0, 14.0], abs=0.02)
    assert all(row["looks_like"] == "" for row in rows)


def test_counts_coarser_than_the_noise_have_errors_that_hold(bench) -> None:
    """A gyro's noise is 1e-5 V: many readings give one count. Nothing is wrong, so nothing is flagged, and no
    drift or mean rate is beyond four of its errors by noise and rounding."""
    capture = {"file": "capture.fogcap", "format": "fogcap-1", "sample_rate_hz": 16.0, "polarity": [1, -1, 1]}
    for step, azimuth in ((5e-5, 20.0), (5e-5, 140.0), (5e-5, 290.0), (2e-4, 20.0), (2e-4, 140.0)):
        capture["volts_per_count"] = step
        run = bench.run(
            n=3, profile=((0.06, 300.0),), sample_rate_hz=16.0, capture=capture, azimuth_deg=azimuth
        )
        reduced = bench.reduce(run)
        for row in reduced.table("drift"):
            assert abs(float(row["drift_deg_h"])) < 4 * float(row["drift_err_coloured_deg_h"])
        for row in reduced.table("rates"):
            assert row["verdict"] == "ok"
            assert abs(float(row["difference_deg_s"])) < 4 * float(row["difference_err_noise_deg_s"])
