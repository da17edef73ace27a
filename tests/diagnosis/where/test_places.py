"""Where a gap lies: places of what is there, none of what a great gap hands to others, each once."""

from __future__ import annotations

import numpy as np
import pytest
from bench_lab import diagnosed, lab, simulated

from fogreduce.diagnosis.inference.candidates import Candidates
from fogreduce.diagnosis.inference.evidence import WhitenedResidual
from fogreduce.diagnosis.inference.findings import Finding
from fogreduce.diagnosis.inference.noise_model import Metric
from fogreduce.diagnosis.where.places import Place, document, places


def ramp(gyro: str, size: float) -> dict:
    return {"effect": "bias_ramp", "channels": [gyro], "runs": ["*"], "parameters": {"deg_h_per_h": size}}


def test_a_place_stands_once_with_the_shares_of_all_that_is_there() -> None:
    def place(channel: str, sigma: float, q: float) -> Place:
        return Place("gyro", (channel,), ("r0",), "drift", sigma, q, 1)

    found = document([place("gyro1", 9.0, 60.0), place("gyro2", 5.0, 20.0), place("gyro1", 4.5, 20.0)])
    assert [(p["channels"], p["sigma"]) for p in found] == [(["gyro1"], 9.0), (["gyro2"], 5.0)]
    assert [p["share"] for p in found] == pytest.approx([0.7992, 0.1998])


def test_a_great_gap_at_one_gyro_shows_at_no_other(tmp_path) -> None:
    lab(tmp_path)
    found = diagnosed(tmp_path, simulated(tmp_path, [ramp("gyro2", 400.0)]))
    assert found["where"][0]["sigma"] > 50.0
    assert {name for p in found["where"] for name in p["channels"]} == {"gyro2"}


def test_of_two_gaps_the_lesser_is_still_seen(tmp_path) -> None:
    lab(tmp_path)
    both = [ramp("gyro2", 400.0), ramp("gyro3", 60.0)]
    found = diagnosed(tmp_path, simulated(tmp_path, both))
    assert {name for p in found["where"] for name in p["channels"]} == {"gyro2", "gyro3"}
    places = [(p["stage"], p["channels"], p["runs"], p["feature"]) for p in found["where"]]
    assert len(places) == len({str(p) for p in places})
    assert sum(p["share"] for p in found["where"]) <= 1.0


def test_what_a_line_leaves_in_other_statistics_is_no_place_of_its_own() -> None:
    """By hand: codes a thousandth as strong at the line's gyro are the line's; at another gyro they are not,
    nor is a band half as strong.
    """

    def finding(domain: str, feature: str, gyro: str, snr2: float) -> Finding:
        return Finding("unknown", (gyro,), ("*",), snr2 / 2.0, snr2, {}, 1.0, domain, "electronics", feature)

    there = [
        finding("lines", "line", "gyro1", 1e6),
        finding("codes", "codes", "gyro1", 1e3),
        finding("level", "band", "gyro1", 5e5),
        finding("codes", "codes", "gyro2", 1e3),
    ]
    rows = WhitenedResidual.of(Metric.of(np.zeros((4, 0))), np.zeros(4))
    found = places(rows, Candidates([]), there, lambda _: [], ["r0"])
    assert {(p.channels[0], p.feature) for p in found} == {
        ("gyro1", "line"),
        ("gyro1", "band"),
        ("gyro2", "codes"),
    }
