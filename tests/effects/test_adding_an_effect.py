"""The example of docs/adding-an-effect.md is run as it stands there."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from bench_lab import lab, simulated
from numpy.typing import NDArray
from simulated_runs import facts, profile

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.diagnosis.diagnose import diagnose
from fogreduce.diagnosis.next.detectable import detectable
from fogreduce.effects.at import At
from fogreduce.effects.design import Design
from fogreduce.effects.model import Effect, Numbers, Parameter, Stage
from fogreduce.effects.selection import action
from fogreduce.effects.table import EFFECTS
from fogreduce.simulate.forward import ForwardRun

PAGE = Path(__file__).parents[2] / "docs" / "adding-an-effect.md"


@pytest.fixture
def effect(monkeypatch: pytest.MonkeyPatch) -> Effect:
    """The example, in the table."""
    function, entry = (
        re.sub("(?m)^   ", "", block)
        for block in re.findall("   ```python\n(.*?)   ```", PAGE.read_text(), re.S)
    )
    names = {
        "Array": NDArray[np.float64], "At": At, "Design": Design, "Effect": Effect, "Numbers": Numbers,
        "Parameter": Parameter, "SECONDS_PER_HOUR": SECONDS_PER_HOUR, "Stage": Stage, "np": np,
    }  # fmt: skip
    exec(function, names)
    added: Effect = eval(entry, names)
    monkeypatch.setitem(EFFECTS, added.name, added)
    return added


def test_the_example_is_simulated(effect: Effect) -> None:
    run = facts(table={"axis": [1.0, 0.0, 0.0], "profile": profile((10.0, 20.0))})
    added = action("third_harmonic", ["gyro2"], ["a"], {"deg_h": 3600.0, "phase_rad": 0.0}, 4)
    times = np.array([0.0, 6.0, 12.0])  # alpha = 0, 60, 120 deg: cos 3 alpha = 1, -1, 1
    change = ForwardRun(run, None, [added]).readings(times) - ForwardRun(run).readings(times)
    assert change[1] == pytest.approx([1.0, -1.0, 1.0], abs=1e-12)
    assert np.all(change[[0, 2, 3]] == 0.0)


@pytest.mark.slow
def test_the_example_is_diagnosed_and_listed_as_detectable(effect: Effect, tmp_path: Path) -> None:
    lab(tmp_path, duration_s=60.0)
    entry = {"effect": effect.name, "channels": ["gyro2"], "runs": ["*"]}
    entry["parameters"] = {"deg_h": 4.0, "phase_rad": 1.0}
    found = diagnose(simulated(tmp_path, [entry]), tmp_path / "cal").document
    assert found["verdict"] == "explained"
    (cause,) = found["causes"]
    assert (cause["effect"], cause["channels"]) == (effect.name, ["gyro2"])
    for name, value in entry["parameters"].items():
        stated = cause["parameters"][name]
        assert abs(stated["value"] - value) < 4.0 * stated["std"]  # once in 16000
    rows = [
        r for r in detectable(tmp_path / "plan", tmp_path / "cal")["effects"] if r["effect"] == effect.name
    ]
    assert {r["channels"][0] for r in rows} == {"gyro1", "gyro2", "gyro3", "gyro4"}
    # far below what was put in and found
    assert all(0.0 < r["amplitude"] < 4.0 for r in rows)
