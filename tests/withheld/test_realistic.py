"""The realistic mode: same seed, same bytes; everything drawn; nothing leaks from gyro to gyro."""

import time

import numpy as np
import pytest
from bench import COUNTS_PER_DEG_H, campaign, run

from withheld import yaml12
from withheld.chain.campaign import read_campaign, run_document
from withheld.chain.injector import realistic_world, run_bytes, run_counts, write_campaign
from withheld.chain.temperature import realistic
from withheld.chain.truth import draw
from withheld.effects.entry import Entry
from withheld.streams import stream
from withheld.study.designs import DESIGNS, draw_campaign

OF = campaign(run("a", 5.0, temperature=True, table_log=True), run("b", 0.0))


def tree(folder):
    return {
        p.relative_to(folder).as_posix(): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()
    }


def test_same_seed_same_bytes_and_another_seed_others(tmp_path):
    for name, seed in (("one", 7), ("two", 7), ("three", 8)):
        write_campaign(realistic_world(OF, (), seed), tmp_path / name / "c", tmp_path / name / "cal")
    one, two, three = (tree(tmp_path / name) for name in ("one", "two", "three"))
    assert one == two
    assert one["c/runs/a/capture.fogcap"] != three["c/runs/a/capture.fogcap"]
    assert set(one) == {"cal/T-1/1.yaml", *(f"c/runs/{r}/{f}" for r in "ab" for f in
                        ("run.yaml", "capture.fogcap", "temperature.csv")), "c/runs/a/table.csv"}  # fmt: skip


def test_an_effect_on_one_gyro_and_run_leaves_the_others_bytes_alone():
    entry = Entry("bias_step", ("gyro2",), ("b",), {"deg_h": 5.0, "time_s": 3.0})
    plain, more = realistic_world(OF, (), 7), realistic_world(OF, (entry,), 7)
    assert run_bytes(plain, OF.runs[0]) == run_bytes(more, OF.runs[0])
    before, after = run_counts(plain, OF.runs[1])[1], run_counts(more, OF.runs[1])[1]
    assert (before[:, [0, 2]] == after[:, [0, 2]]).all()
    assert (before[:, 1] != after[:, 1]).any()


def test_another_run_changes_no_stream():
    more = campaign(*OF.runs, run("c", 1.0))
    assert run_bytes(realistic_world(OF, (), 7), OF.runs[1]) == run_bytes(
        realistic_world(more, (), 7), more.runs[1]
    )


def test_every_stated_uncertainty_is_drawn_with_its_size():
    draws = [draw(OF, seed, 0.02) for seed in range(400)]
    rel = 5 / np.sqrt(2 * 400)  # five standard errors of a standard deviation
    spread = {
        "scale_factor_rel": (np.std([d.scale_factor_rel[0] for d in draws]), 2e-5),
        "bias_V": (np.std([d.bias_V[1] for d in draws]), 1e-9),
        "axis": (np.std([d.axis_tilt_rad[2, 1] for d in draws]), 2e-5),
        "turn_on": (np.std([d.turn_on_deg_h["b"][0] for d in draws]), 0.05),
        "azimuth": (np.std([d.azimuth_deg["a"] for d in draws]), 0.05),
        "table": (np.std([d.table_ppm for d in draws]), 5.0),
        "latitude": (np.std([d.latitude_deg for d in draws]), 0.001),
    }
    for found, expected in spread.values():
        assert found == pytest.approx(expected, rel=rel)
    assert draws[0].turn_on_deg_h["a"][0] != draws[0].turn_on_deg_h["b"][0]


def test_the_coil_lags_behind_the_log():
    heat = realistic(300.0, np.random.default_rng(1), 24.0)
    assert 0.0 < np.abs(heat.felt_degC - heat.sensor_degC).max() < 0.3
    slope = np.gradient(heat.sensor_degC)[20:-20]
    lag = (heat.sensor_degC - heat.felt_degC)[20:-20]
    assert np.corrcoef(slope, lag)[0, 1] > 0.5


@pytest.mark.parametrize("design", DESIGNS)
@pytest.mark.parametrize("gyros", [3, 4, 6])
def test_metadata_survive_the_files(tmp_path, design, gyros):
    of = draw_campaign("case", design, gyros, stream(1, design), temperature=False)
    short = type(of)(of.name, of.unit, tuple(_shortened(one) for one in of.runs))
    write_campaign(realistic_world(short, (), 1), tmp_path / "case", tmp_path / "cal")
    back = read_campaign(tmp_path / "case", tmp_path / "cal")
    assert back == short
    assert np.array(back.unit.H) @ back.unit.axes == pytest.approx(np.eye(3), abs=1e-9)


def _shortened(one):
    from dataclasses import replace

    return replace(one, profile=tuple((rate, 2.0) for rate, _ in one.profile))


def test_numbers_are_numbers_to_both_yaml_versions(tmp_path):
    import yaml

    (tmp_path / "run.yaml").write_text(yaml12.dump(run_document(OF.runs[0], OF.unit)))
    text = (tmp_path / "run.yaml").read_text()
    assert "volts_per_count: 1.0e-07" in text
    assert isinstance(yaml.safe_load(text)["capture"]["volts_per_count"], float)
    assert yaml12.load(tmp_path / "run.yaml")["capture"]["volts_per_count"] == 1e-7
    (tmp_path / "other.yaml").write_text("a: 1e-07\nb: 12\nc: 2014-05-12T13:00:00Z\nd: 1.\ne: x1\n")
    assert yaml12.load(tmp_path / "other.yaml") == {
        "a": 1e-7,
        "b": 12,
        "c": "2014-05-12T13:00:00Z",
        "d": 1.0,
        "e": "x1",
    }


def test_eight_runs_of_300_s_take_at_most_a_second_and_a_half(tmp_path):
    of = draw_campaign("case", "eight", 4, stream(3, "speed"), temperature=True)
    assert len(of.runs) == 8
    assert {one.duration_s for one in of.runs} == {300.0}
    spent = []
    for attempt in range(3):
        before = time.process_time()
        write_campaign(realistic_world(of, (), attempt), tmp_path / "c", tmp_path / "cal")
        spent.append(time.process_time() - before)
    assert min(spent) < 1.5


def test_the_log_of_the_table_shows_the_ripple(tmp_path):
    entry = Entry("table_rate_ripple", ("table",), ("*",), {"ppm": 2e4, "harmonic": 2, "phase_rad": 0.0})
    of = campaign(run("a", 9.0, 40.0, table_log=True))
    write_campaign(realistic_world(of, (entry,), 1), tmp_path / "c", tmp_path / "cal")
    log = np.loadtxt(tmp_path / "c/runs/a/table.csv", delimiter=",", skiprows=1)
    swing = np.rad2deg(2e4 * 1e-6 / 2) * np.sin(2 * np.deg2rad(9.0 * log[:, 0]))
    assert log[:, 1] - 9.0 * log[:, 0] == pytest.approx(swing, abs=0.01)


def test_a_departure_is_small_and_absent_from_the_exact_shape():
    plain = Entry("bias_offset", ("gyro1",), ("*",), {"deg_h": 100.0})
    wobbling = Entry("bias_offset", ("gyro1",), ("*",), {"deg_h": 100.0},
                     {"wobble": 0.03, "wobble_period_s": 20.0, "wobble_phase_rad": 0.0})  # fmt: skip
    of = campaign(run())
    one, two = (run_counts(realistic_world(of, (e,), 1), of.runs[0])[1][:, 0] for e in (plain, wobbling))
    assert (two - one).std() == pytest.approx(3.0 * COUNTS_PER_DEG_H, rel=0.01)
