"""The scorer tells candidates apart as a person would: each one's habit shows in its scores."""

from typing import Any

import pytest
from labels import effect, label

from withheld.atomic import write_json
from withheld.candidates import CANDIDATES, document_of, place_of
from withheld.effects.catalogue import NAMES
from withheld.score.diagnosis_file import read_diagnosis
from withheld.score.judge import judge
from withheld.score.summary import summarise
from withheld.streams import stream
from withheld.study.designs import draw_campaign
from withheld.study.protocol import Thresholds

T = Thresholds()
SINGLES = ("bias_ramp", "latency", "crosstalk", "spikes", "warm_up")
STRANGERS = ("telegraph_bias", "sawtooth_bias", "rate_squared")


def peeking(campaign, names, truth: dict[str, Any]) -> dict[str, Any]:
    """Reads the label by name: what a perfect diagnoser would say.  It exists in tests alone."""
    effects = truth["effects"]
    if not effects:
        return CANDIDATES["no_gap"](campaign, names)
    places = [place_of("gyro", e["channels"], e["runs"]) for e in effects]
    if truth["kind"] in ("stranger", "without"):
        return document_of(campaign, names, "unexplained", 0.99) | {
            "where": places,
            "unknown_probability": 0.97,
        }
    causes = []
    for e in effects:
        member = {key: e[key] for key in ("effect", "channels", "runs")} | {"probability": 0.99}
        parameters = {name: {"value": v, "std": 0.1} for name, v in e["parameters"].items()}
        causes.append({**member, "group_probability": 0.99, "group": [member], "parameters": parameters})
    return document_of(campaign, names, "explained", 0.99) | {"where": places, "causes": causes}


def cases():
    rng = stream(1, "candidates")
    for number in range(60):
        name = f"case-{number:04d}"
        campaign = draw_campaign(name, "eight", 4, rng, temperature=True)
        if number < 24:
            yield campaign, label("nothing", case=name)
        elif number < 44:
            one = effect(SINGLES[number % 5], f"gyro{number % 4 + 1}", snr=12.0, size=1.0)
            yield campaign, label("single", one, case=name)
        elif number < 50:
            two = (
                effect("bias_ramp", "gyro1", snr=20.0, size=1.0),
                effect("latency", "gyro3", snr=20.0, size=2.0),
            )
            yield campaign, label("pair", *two, case=name)
        else:
            one = effect(STRANGERS[number % 3], f"gyro{number % 4 + 1}", snr=20.0, best=10.0)
            yield campaign, label("stranger", one, case=name)


@pytest.fixture(scope="module")
def scores(tmp_path_factory):
    """Candidate -> row -> share, each diagnosis passed through its file."""
    folder, found = tmp_path_factory.mktemp("candidates"), {}
    made = list(cases())
    for name in (*CANDIDATES, "peeking"):
        outcomes = []
        for campaign, truth in made:
            said = peeking(campaign, NAMES, truth) if name == "peeking" else CANDIDATES[name](campaign, NAMES)
            write_json(folder / "diagnosis.json", said)
            outcomes.append(judge(truth, read_diagnosis(folder / "diagnosis.json"), T))
        summary = summarise(outcomes, T)
        found[name] = {
            (t["title"], r["row"]): (r["k"], r["n"]) for t in summary["tables"] for r in t["rows"]
        } | {"reliability": summary["reliability"], "group_size": summary["group_size"]}
    return found


FALSE = ("Nothing wrong", "called a gap")
SEEN = ("One effect, eight runs", "SNR 8 to 15: a gap was seen")
CAUSE = ("One effect, eight runs", "SNR 8 to 15: right cause")
GROUP = ("One effect, eight runs", "SNR 8 to 15: right cause or pure group")
PLACE = ("One effect, eight runs", "SNR 8 to 15: right place first")
BOTH = ("Two and three effects", "SNR 15 and up: right cause")
ODD = ("Never in the catalogue, all", "SNR 15 and up: flagged in place")
ELSEWHERE = ("Never in the catalogue, all", "SNR 15 and up: flagged elsewhere")
WRONG = ("Never in the catalogue, all", "SNR 15 and up: misattributed")
MISSED = ("Never in the catalogue, all", "SNR 15 and up: missed")
PURE = ("Groups (one effect)", "groups without a member separated by 6 or more")


def test_always_content_has_no_false_alarm_and_finds_nothing(scores):
    s = scores["no_gap"]
    assert (s[FALSE], s[SEEN], s[GROUP], s[MISSED]) == ((0, 24), (0, 20), (0, 20), (10, 10))


def test_always_alarmed_sees_every_gap_and_knows_no_place(scores):
    s = scores["unexplained"]
    assert (s[FALSE], s[SEEN], s[CAUSE], s[PLACE]) == ((24, 24), (20, 20), (0, 20), (0, 20))
    assert (s[ODD], s[ELSEWHERE], s[WRONG]) == ((0, 10), (10, 10), (0, 10))


def test_everything_in_one_group_gets_no_credit_for_holding_the_truth(scores):
    s = scores["one_group"]
    assert (s[FALSE], s[CAUSE], s[GROUP]) == ((24, 24), (0, 20), (0, 20))
    assert s[PURE] == (0, 20)
    assert s[("Groups (one effect)", "of at most 4 members, eight runs")] == (0, 20)
    assert s[WRONG] == (10, 10)
    assert s["group_size"]["median"] > 100


def test_a_guess_is_near_chance(scores):
    s = scores["guess"]
    assert 4 <= s[FALSE][0] <= 20  # a coin, 24 times: outside with probability 5e-4
    assert s[CAUSE][0] <= 2
    assert s["reliability"]["causes, closed set"]["error"] > 0.3  # it says one half


def test_who_reads_the_label_is_right_in_everything(scores):
    s = scores["peeking"]
    assert (s[FALSE], s[SEEN], s[CAUSE], s[PLACE]) == ((0, 24), (20, 20), (20, 20), (20, 20))
    assert (s[BOTH], s[ODD], s[PURE]) == ((6, 6), (10, 10), (20, 20))
    assert s["reliability"]["causes, closed set"]["error"] == pytest.approx(0.01)
