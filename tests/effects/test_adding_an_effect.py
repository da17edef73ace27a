"""The example of docs/adding-an-effect.md is run as it stands there."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from simulated_runs import facts, profile

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.effects.at import At
from fogreduce.effects.model import Effect, Numbers, Parameter, Stage
from fogreduce.effects.selection import action
from fogreduce.effects.table import EFFECTS
from fogreduce.simulate.forward import ForwardRun

PAGE = Path(__file__).parents[2] / "docs" / "adding-an-effect.md"


def test_the_example_works(monkeypatch: pytest.MonkeyPatch) -> None:
    function, entry = (
        re.sub("(?m)^   ", "", block)
        for block in re.findall("   ```python\n(.*?)   ```", PAGE.read_text(), re.S)
    )
    names = {
        "Array": NDArray[np.float64], "At": At, "Effect": Effect, "Numbers": Numbers, "Parameter": Parameter,
        "SECONDS_PER_HOUR": SECONDS_PER_HOUR, "Stage": Stage, "np": np,
    }  # fmt: skip
    exec(function, names)
    effect = eval(entry, names)
    monkeypatch.setitem(EFFECTS, effect.name, effect)
    run = facts(table={"axis": [1.0, 0.0, 0.0], "profile": profile((10.0, 20.0))})
    added = action("third_harmonic", ["gyro2"], ["a"], {"deg_h": 3600.0, "phase_rad": 0.0}, 4)
    times = np.array([0.0, 6.0, 12.0])  # alpha = 0, 60, 120 deg: cos 3 alpha = 1, -1, 1
    change = ForwardRun(run, None, [added]).readings(times) - ForwardRun(run).readings(times)
    assert change[1] == pytest.approx([1.0, -1.0, 1.0], abs=1e-12)
    assert np.all(change[[0, 2, 3]] == 0.0)
