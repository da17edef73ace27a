"""The page and its figures, from scores of a handful of cases and from next to none."""

import json
import re

import pytest
from labels import cause, diagnosis, effect, label

from withheld.report.figures import FIGURES
from withheld.report.page import page, write_page
from withheld.score.judge import judge
from withheld.score.scoring import plain_outcome
from withheld.score.summary import summarise
from withheld.study.protocol import Thresholds

T = Thresholds()


def scores_of(outcomes, once=True):
    return json.loads(
        json.dumps(
            {
                "study": "full",
                "seed": 1000009,
                "once": once,
                "candidate": "hand",
                "studies_before": 3,
                "tries_before": 1,
                "seals": {"labels": "0" * 64},
                "summary": summarise(outcomes, T),
                "outcomes": [plain_outcome(outcome) for outcome in outcomes],
            }
        )
    )


@pytest.fixture(scope="module")
def some():
    ramp = effect("bias_ramp", "gyro2", deg_h_per_h=2.0, snr=10.0)
    right = diagnosis("explained", cause("bias_ramp", "gyro2", deg_h_per_h=(2.1, 0.1)), closure=(0.98, 0.01))
    odd = effect("sawtooth_bias", "gyro1", snr=16.0, best=8.0)
    outcomes = [
        judge(label("nothing"), diagnosis("no_gap", gap=0.1), T, 2.0),
        judge(label("single", ramp, oracle=0.99), right, T, 3.0),
        judge(label("stranger", odd), diagnosis("unexplained", where=[("gyro", ["gyro1"])]), T),
        judge(label("without", {**odd, "snr": 6.0}), diagnosis("explained", cause("latency", "gyro2")), T),
    ]
    return scores_of(outcomes)


def test_every_row_is_k_of_n_with_its_interval(some):
    text = page(some)
    rows = re.findall(r"^\| ([^|]+) \| (\d+ of \d+ \([\d.]+-[\d.]+ %\)) \|", text, re.M)
    assert ("called a gap", "0 of 1 (0.0-79.3 %)") in rows
    assert ("SNR 8 to 15: right cause", "1 of 1 (20.7-100.0 %)") in rows
    assert ("SNR 15 and up: flagged in place", "1 of 1 (20.7-100.0 %)") in rows
    assert ("SNR 5 to 8: misattributed", "1 of 1 (20.7-100.0 %)") in rows


def test_the_clairvoyant_stands_beside(some):
    # SNR 10, its best rival separated by 10: Phi(10 - 4) and Phi(10 / 2) of that
    assert "SNR 8 to 15: a gap was seen | 1 of 1 (20.7-100.0 %) | 100.0 % |" in page(some)
    assert "SNR 8 to 15: right cause or pure group | 1 of 1 (20.7-100.0 %) | |" in page(some)


def test_the_page_says_how_many_studies_came_before(some):
    assert "It was scored once. Studies of this candidate before it: 3." in page(some)
    assert "it proves nothing" in page({**some, "once": False})


def test_equal_scores_give_equal_bytes(some, tmp_path):
    for name in ("one", "two"):
        write_page(some, tmp_path / name)
    files = [{p.name: p.read_bytes() for p in (tmp_path / n).iterdir()} for n in ("one", "two")]
    assert files[0] == files[1]
    assert set(files[0]) == {"index.md", "scores.json", *(f"{name}.png" for name in FIGURES)}
    assert all(f"]({name}.png)" in files[0]["index.md"].decode() for name in FIGURES)


def test_figures_of_next_to_nothing():
    quiet = [judge(label("nothing"), diagnosis("no_gap", gap=0.1), T)]
    for draw in FIGURES.values():
        assert draw(scores_of(quiet)).axes


def test_the_figure_of_causes_shows_the_shares(some):
    (ax,) = FIGURES["causes"](some).axes
    heights = {line.get_label(): line.get_ydata() for line in ax.lines}
    assert list(heights["right cause"]) == [100.0]
    assert [tick.get_text() for tick in ax.get_xticklabels()] == ["8 to 15\n(n = 1)"]
