"""Causes that together do what one cause of another shape does."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
import yaml
from bench_lab import lab, simulated

from fogreduce.diagnosis.how_far.shapes import departed, without_imitations
from fogreduce.diagnosis.inference.causes import Cause
from fogreduce.diagnosis.inference.outcome import Named, Verdict
from fogreduce.diagnosis.inference.search import Search
from fogreduce.diagnosis.observe.data import read_data
from fogreduce.effects.table import EFFECTS
from fogreduce.metadata.yaml12 import dump_yaml


def logged(root: Path) -> None:
    """A temperature log for each run: 4 degC that the sensor takes up within a minute, and a swing."""
    for folder in sorted((root / "plan" / "runs").iterdir()):
        t = np.arange(0.0, 121.0)
        degC = 25.0 + 4.0 * (1.0 - np.exp(-t / 40.0)) + 0.2 * np.sin(t / 25.0)
        rows = "".join(f"{a:.1f},{b:.4f}\n" for a, b in zip(t, degC, strict=True))
        (folder / "temperature.csv").write_text("time_s,sensor_degC\n" + rows)
        run = yaml.safe_load((folder / "run.yaml").read_text())
        (folder / "run.yaml").write_text(dump_yaml(run | {"temperature": "temperature.csv"}))


@pytest.mark.parametrize(("late_s", "shown"), [(20.0, True), (-20.0, False)])
def test_a_slope_that_a_late_coil_would_make_is_shown_as_one(tmp_path, late_s: float, shown: bool) -> None:
    """``k T(t - s)`` is ``k T - k s dT/dt`` to first order: by hand, a slope of -k s / 60 a minute."""
    lab(tmp_path)
    logged(tmp_path)
    k = 2.0
    put = [
        ("temperature_bias", {"deg_h_per_degC": k}),
        ("temperature_rate_bias", {"deg_h_per_degC_per_min": -k * late_s / 60.0}),
    ]
    effects = [
        {"effect": name, "channels": ["gyro2"], "runs": ["*"], "parameters": values} for name, values in put
    ]
    bench = simulated(tmp_path, effects)
    search = Search(read_data(bench, tmp_path / "cal"), frozenset(EFFECTS))
    causes = [Cause(name, ("gyro2",), ("*",), values, {}, {}) for name, values in put]
    state = search.state(causes, search.problem)
    assert [(p.channels, p.feature) for p in departed(search, state)] == [(("gyro2",), "temperature")] * shown


def judged(*sizes: float) -> Verdict:
    """What is left of causes of gyro1 with sizes of so many standard deviations."""
    names = ("bias_offset", "bias_ramp", "warm_up", "bias_step")
    causes = [
        Cause(name, ("gyro1",), ("*",), {"deg_h": size, "tau_s": 50.0}, {}, {"deg_h": 1.0, "tau_s": 1.0})
        for name, size in zip(names, sizes, strict=False)
    ]
    named = tuple(Named(k, 0.9, 0.9, ()) for k in range(len(causes)))
    state = SimpleNamespace(causes=causes, problem=None)
    search = SimpleNamespace(
        state=lambda kept, problem: SimpleNamespace(causes=kept, problem=problem), options=lambda state: []
    )
    verdict = Verdict("explained", 1.0, 0.01, state, [], named)  # type: ignore[arg-type]
    return without_imitations(search, verdict)  # type: ignore[arg-type]


def test_three_causes_of_no_size_at_one_place_are_none() -> None:
    imitation = judged(0.3, -0.7, 0.2)
    assert (imitation.word, imitation.named, imitation.unknown_probability) == ("unexplained", (), 0.5)
    assert judged(0.3, -0.7, 9.0).word == "explained"
    assert judged(0.3, -0.7).word == "explained"


@pytest.mark.parametrize(("ramp_deg_h_per_h", "left"), [(2.0, 1), (60.0, 2)])
def test_a_smaller_cause_without_a_size_is_a_departure_of_what_a_temperature_drives(
    tmp_path, ramp_deg_h_per_h: float, left: int
) -> None:
    lab(tmp_path)
    logged(tmp_path)
    warm = {"effect": "temperature_bias", "channels": ["gyro2"], "runs": ["*"]}
    bench = simulated(tmp_path, [warm | {"parameters": {"deg_h_per_degC": 2.0}}])
    search = Search(read_data(bench, tmp_path / "cal"), frozenset(EFFECTS))
    causes = [
        Cause("temperature_bias", ("gyro2",), ("*",), {"deg_h_per_degC": 2.0}, {}, {"deg_h_per_degC": 0.1}),
        Cause("bias_ramp", ("gyro2",), ("*",), {"deg_h_per_h": ramp_deg_h_per_h}, {}, {"deg_h_per_h": 90.0}),
    ]
    named = tuple(Named(k, 0.9, 0.9, ()) for k in range(2))
    state = replace(search.state([], search.problem), causes=causes)
    found = without_imitations(search, Verdict("explained", 1.0, 0.01, state, [], named))
    assert (found.word, found.unknown_probability, len(found.named)) == ("explained", 0.01, left)
