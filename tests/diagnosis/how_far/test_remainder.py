"""What is left is tested, and what is unknown has kin."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from bench_lab import RECORD, diagnosed, lab, simulated

from fogreduce.diagnosis.how_far.closure import Closure
from fogreduce.diagnosis.how_far.remainder import Remainder, borne_out
from fogreduce.diagnosis.inference.outcome import Verdict
from fogreduce.diagnosis.where.places import Place


def effect(name: str, channel: str, **parameters: float) -> dict:
    return {"effect": name, "channels": [channel], "runs": ["*"], "parameters": parameters}


class _Caused:
    causes = ("one",)


def judged(word: str, fraction: float, std: float, *further: Place, unknown: float = 0.02) -> Verdict:
    """A verdict of one cause, tested with a closure of `fraction` +- `std` and what is left further."""
    gap, expected = 10000.0, 100.0
    after = expected + (1.0 - fraction) * gap
    closure = Closure("", "", expected + gap, after, expected, std)
    remainder = Remainder(0.5 if not further else 1e-6, further, further)
    return borne_out(Verdict(word, 1.0, unknown, _Caused(), [], ()), closure, remainder)  # type: ignore[arg-type]


def test_explained_is_said_only_of_what_closes_and_leaves_nothing() -> None:
    place = Place("gyro", ("gyro1",), ("r0",), "drift", 5.0, 40.0, 1)
    assert judged("explained", 1.0, 0.01).word == "explained"
    assert judged("partly_explained", 1.0, 0.01).word == "explained"
    assert judged("explained", 0.9, 0.01).word == "partly_explained"
    left = judged("explained", 1.0, 0.01, place)
    assert left.word == "partly_explained"
    assert left.unknown_probability > 0.99


def test_what_is_explained_is_not_unknown() -> None:
    assert judged("partly_explained", 1.0, 0.01, unknown=1.0).unknown_probability < 0.01
    # the lower end of what may be called explained: an even chance, no more
    assert judged("partly_explained", 0.96, 0.01, unknown=1.0).unknown_probability == 0.5
    assert judged("explained", 1.0, 0.01, unknown=1e-4).unknown_probability <= 1e-4


def test_what_is_left_and_is_no_noise_must_be_as_little_as_departures_of_shape_leave() -> None:
    def tested(fraction: float, std: float, p: float, departed: float) -> str:
        closure = Closure("", "", 1000.0, 1000.0 * (1.0 - fraction), 0.0, std)
        closure = replace(closure, departed=departed)
        verdict = Verdict("explained", 1.0, 0.02, _Caused(), [], ())  # type: ignore[arg-type]
        return borne_out(verdict, closure, Remainder(p, (), ())).word

    # the interval of 0.887 +- 0.044 ends at 0.973: as noise it may pass, as a departure of 0.6 % it may not
    assert tested(0.887, 0.044, 0.2, 0.003) == "explained"
    assert tested(0.887, 0.044, 1e-4, 0.003) == "partly_explained"
    # of a step that takes its time, as much may be left as is ever called explained
    assert tested(0.887, 0.044, 1e-4, 0.3) == "explained"
    assert tested(0.887, 0.040, 1e-4, 0.3) == "partly_explained"
    assert tested(0.99, 0.004, 1e-9, 0.0) == "explained"


def drifted(campaign: Path, gyro: int, deg_h: Callable[[np.ndarray], np.ndarray]) -> None:
    """Add a drift to a gyro (from 0) of all captures, which no effect of the simulator makes."""
    for path in campaign.glob("runs/*/capture.fogcap"):
        raw = path.read_bytes()
        width = [("stamp", "<u8"), ("pulse", "<u4"), ("count", "<i4", (4,))]
        records = np.frombuffer(raw[64:], dtype=np.dtype(width)).copy()
        counts = deg_h(np.arange(len(records)) / 64.0) / 3600.0 / 1e-7
        counts *= RECORD["scale_factor_V_per_deg_s"][gyro]
        records["count"][:, gyro] += np.rint(counts).astype(int)
        path.write_bytes(raw[:64] + records.tobytes())


def test_a_slow_drift_of_another_shape_is_not_explained(tmp_path: Path) -> None:
    """A drift with the square of time, of which a ramp closes nine tenths."""
    lab(tmp_path, duration_s=300.0)
    campaign = simulated(tmp_path, [])
    drifted(campaign, 3, lambda t: 0.6 * (t / 300.0) ** 2)
    out = diagnosed(tmp_path, campaign)
    assert [c["effect"] for c in out["causes"]] == ["bias_ramp"]
    assert out["closure"]["fraction"] < 0.96
    assert out["verdict"] == "partly_explained"
    assert out["unknown_probability"] > 0.9


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
