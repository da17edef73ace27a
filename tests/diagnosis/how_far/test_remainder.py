"""What is left is tested, and what is unknown has kin."""

from __future__ import annotations

import numpy as np
import pytest
from bench_lab import diagnosed, lab, simulated

from fogreduce.diagnosis.how_far.closure import Closure
from fogreduce.diagnosis.how_far.remainder import Remainder, borne_out
from fogreduce.diagnosis.inference.outcome import Verdict
from fogreduce.diagnosis.where.places import Place


def effect(name: str, channel: str, **parameters: float) -> dict:
    return {"effect": name, "channels": [channel], "runs": ["*"], "parameters": parameters}


class _Caused:
    causes = ("one",)


def judged(word: str, fraction: float, std: float, *further: Place) -> Verdict:
    """A verdict of one cause, tested with a closure of `fraction` +- `std` and what is left further."""
    gap, expected = 10000.0, 100.0
    after = expected + (1.0 - fraction) * gap
    closure = Closure("", "", expected + gap, after, expected, 0.0, std * gap)
    remainder = Remainder(0.5 if not further else 1e-6, further, further)
    return borne_out(Verdict(word, 1.0, 0.02, _Caused(), [], ()), closure, remainder)  # type: ignore[arg-type]


def test_explained_is_said_only_of_what_closes_and_leaves_nothing() -> None:
    place = Place("gyro", ("gyro1",), ("r0",), "drift", 5.0, 40.0, 1)
    assert judged("explained", 1.0, 0.01).word == "explained"
    assert judged("partly_explained", 1.0, 0.01).word == "explained"
    assert judged("explained", 0.9, 0.01).word == "partly_explained"
    left = judged("explained", 1.0, 0.01, place)
    assert left.word == "partly_explained"
    assert left.unknown_probability > 0.99


def test_a_warming_of_two_time_constants_resembles_a_warm_up(tmp_path) -> None:
    """Two decays of one gyro are no single effect's shape: unknown, and the page says what comes nearest."""
    lab(tmp_path)
    two = [
        effect("warm_up", "gyro4", deg_h=2.5, tau_s=5.0),
        effect("warm_up", "gyro4", deg_h=1.5, tau_s=60.0),
    ]
    out = diagnosed(tmp_path, simulated(tmp_path, two))
    assert out["verdict"] == "unexplained"
    first = out["resembles"][0]
    assert (first["effect"], first["channels"]) == ("warm_up", ["gyro4"])
    assert 0.5 < first["closes"] < 1.0
    assert 0.0 < first["std"] < 0.1
    assert out["remainder"]["p_value"] < 1e-10
    page = (tmp_path / "out-bench" / "index.html").read_text()
    assert "comes nearest to warm up of gyro4" in page.replace("\n", " ")


@pytest.mark.slow
def test_the_remainder_of_causes_exactly_right_is_noise(tmp_path) -> None:
    """Of twelve campaigns that the catalogue explains exactly, at any strength, what is left is noise: the
    p-value of the statistic farthest out is below 0.01 in at most one (binomial: 2 in 150 studies more).
    """
    found = []
    for k, size in enumerate(np.geomspace(0.5, 50.0, 12).tolist()):
        root = tmp_path / str(k)
        root.mkdir()
        lab(root)
        causes = [
            effect("bias_offset", "gyro1", deg_h=size),
            effect("scale_factor_error", "gyro3", ppm=300.0),
        ]
        out = diagnosed(root, simulated(root, causes, seed=k))
        assert out["verdict"] == "explained"
        assert out["resembles"] == []
        found.append(out["remainder"]["p_value"])
        assert out["remainder"]["significant"] == (found[-1] < 0.01)
    assert np.sum(np.array(found) < 0.01) <= 1
