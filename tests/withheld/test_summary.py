"""Rows, intervals and reliabilities."""

import numpy as np
import pytest
from labels import cause, diagnosis, effect, label

from withheld.score.judge import judge
from withheld.score.summary import clairvoyant_share, reliability, summarise
from withheld.score.wilson import Share
from withheld.study.protocol import Thresholds

T = Thresholds()


@pytest.mark.parametrize(
    ("k", "n", "low", "high"),
    # Newcombe, Statistics in Medicine 17 (1998) 857, table I, method 3
    [(81, 263, 0.2553, 0.3662), (15, 148, 0.0624, 0.1605), (0, 20, 0.0, 0.1611), (1, 29, 0.0061, 0.1718)],
)
def test_wilson_s_interval_against_published_values(k, n, low, high):
    assert Share(k, n).interval == pytest.approx((low, high), abs=5e-5)


def test_a_share_of_none_says_so():
    assert Share(0, 0).text() == "0 of 0"
    assert Share(0, 0).value is None
    assert Share(3, 4).text() == "3 of 4 (30.1-95.4 %)"


def test_reliability_of_a_calibrated_and_of_an_overconfident_answer():
    rng = np.random.default_rng(1)
    stated = rng.uniform(0, 1, 4000)
    fair = reliability([(float(p), bool(rng.random() < p)) for p in stated])
    bold = reliability([(0.9 + 0.1 * float(p), bool(rng.random() < 0.6)) for p in stated])
    assert fair["error"] < 2 * fair["expected_error"]
    assert bold["error"] > 0.3
    assert sum(b["n"] for b in fair["bins"]) == 4000
    assert reliability([])["error"] is None


def test_the_clairvoyant_is_sure_of_what_is_loud_and_apart():
    def seen(snr, best):
        truth = effect("bias_ramp", "gyro1", snr=snr, best=best)
        return clairvoyant_share([judge(label("single", truth), diagnosis("no_gap"), T)], T)

    assert seen(20.0, 12.0) == pytest.approx((1.0, 1.0), abs=1e-6)
    assert seen(20.0, 0.0) == pytest.approx((1.0, 0.5), abs=1e-6)
    assert seen(4.0, 12.0)[0] == pytest.approx(0.5)


def row(summary, title, name):
    table = next(t for t in summary["tables"] if t["title"] == title)
    found = next(r for r in table["rows"] if r["row"] == name)
    return found["k"], found["n"]


def test_a_small_study_by_hand():
    ramp = effect("bias_ramp", "gyro2", deg_h_per_h=2.0, snr=10.0)
    odd = effect("sawtooth_bias", "gyro1", snr=16.0)
    right = diagnosis("explained", cause("bias_ramp", "gyro2", deg_h_per_h=(2.1, 0.1)), closure=(0.98, 0.01))
    outcomes = [
        judge(label("nothing"), diagnosis("no_gap", gap=0.1), T, 2.0),
        judge(label("nothing"), diagnosis("unexplained"), T, 4.0),
        judge(label("single", ramp, oracle=0.99), right, T, 3.0),
        judge(label("single", ramp), diagnosis("explained", cause("latency", "gyro2")), T),
        judge(label("stranger", odd), diagnosis("explained", cause("latency", "gyro2")), T),
        judge(label("stranger", odd), None, T),
    ]
    summary = summarise(outcomes, T)
    assert row(summary, "Nothing wrong", "called a gap") == (1, 2)
    assert row(summary, "Nothing wrong", "diagnosis of the contract's form, all cases") == (5, 6)
    assert row(summary, "One effect, eight runs", "SNR 8 to 15: right cause") == (1, 2)
    assert row(summary, "One effect, eight runs", "SNR 8 to 15: a gap was seen") == (2, 2)
    assert row(summary, "Never in the catalogue, all", "SNR 15 and up: misattributed") == (1, 2)
    assert row(summary, "Never in the catalogue, all", "SNR 15 and up: missed") == (1, 2)
    assert row(summary, "Closure against the oracle, right causes", "within 0.03") == (1, 1)
    assert summary["pulls"]["median"] == pytest.approx(1.0)
    assert summary["seconds"]["median"] == 3.0
    assert {"truth": "bias_ramp", "answer": "latency", "n": 1} in summary["confusion"]
    assert summary["reliability"]["causes, closed set"]["n"] == 2
    assert summary["reliability"]["causes, open set"]["n"] == 1
