"""What is unknown stands in the stead of causes that together do what one thing does."""

from __future__ import annotations

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from bench_lab import diagnosed, lab, simulated

from fogreduce.diagnosis import priors
from fogreduce.diagnosis.inference import unknown
from fogreduce.diagnosis.inference.options import Option


@pytest.mark.parametrize(
    ("effect", "channels", "parameters", "place"),
    [
        # a turned mount is an axis off at every gyro, each as one rotation has it
        ("mount_rotation", ["table"], {"mrad": [0.15, 0.2, 0.1]}, "table"),
        # a walk is a smooth process and flicker
        ("rate_random_walk", ["gyro1"], {"deg_h_sqrt_h": 4.0}, "gyro1"),
    ],
)
def test_causes_that_do_together_what_one_thing_does_are_none(
    tmp_path: Path, effect: str, channels: list[str], parameters: dict, place: str
) -> None:
    lab(tmp_path)
    put = [{"effect": effect, "channels": channels, "runs": ["*"], "parameters": parameters}]
    out = diagnosed(tmp_path, simulated(tmp_path, put), "--without", effect)
    assert (out["verdict"], out["causes"]) == ("unexplained", [])
    assert out["where"][0]["channels"] == [place]


@pytest.mark.parametrize(("behind", "wins"), [(0.5 * priors.SPEAKS, True), (1.5 * priors.SPEAKS, False)])
def test_one_unknown_thing_does_not_win_by_being_one_where_the_runs_speak_for_two_causes(
    monkeypatch: pytest.MonkeyPatch, behind: float, wins: bool
) -> None:
    """Causes of 120 in ln evidence and -16 in prior; a family of more numbers less evident, of prior -6."""
    two = SimpleNamespace(score=104.0, fit=SimpleNamespace(log_b=120.0, columns=[0, 1]))
    none = SimpleNamespace(score=0.0, fit=SimpleNamespace(log_b=0.0, columns=[]))
    monkeypatch.setattr(unknown, "_chi2", lambda posterior, here: 0.0)
    fit = SimpleNamespace(candidate=SimpleNamespace(columns=np.zeros((1, 1, 5))), q=0.0)
    family = Option(fit, None, 120.0 - behind, -6.0)
    (found,) = unknown._better_fits([family], SimpleNamespace(best=two), none)
    assert (found.score + priors.LOG_FURTHER > two.score) == wins
