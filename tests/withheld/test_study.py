"""Studies: what they hold, how they are sealed, and that none is scored twice."""

from collections import Counter
from dataclasses import replace

import pytest

from withheld.atomic import read_json, sha256, write_json
from withheld.effects.catalogue import NAMES
from withheld.effects.near import NEAR
from withheld.effects.strangers import NAMES as STRANGERS
from withheld.errors import BadInput
from withheld.score.scoring import score
from withheld.streams import stream
from withheld.study.batch import check_study, check_training, make_batch
from withheld.study.cases import draw_case, plans
from withheld.study.classes import CLASSES
from withheld.study.laws import LAWS
from withheld.study.ledger import enter
from withheld.study.protocol import code_hash, protocol_document, protocol_from, study
from withheld.study.seal import check_seal, write_seal

FULL = study("full", 1_000_001)


def test_the_full_study_holds_what_the_issue_asks():
    drawn = plans(FULL)
    kinds = Counter(plan.kind for plan in drawn)
    assert len(drawn) == FULL.cases >= 1200
    assert kinds["nothing"] >= 400
    assert kinds["nothing"] >= len(drawn) / 4
    alone = Counter(plan.effects[0] for plan in drawn if plan.kind == "single")
    assert set(alone) == set(NAMES)
    taken_out = [plan for plan in drawn if plan.kind == "without"]
    assert {plan.effects[0] for plan in taken_out} == set(NAMES)
    assert all(plan.effects[0] in plan.without for plan in taken_out)
    assert {plan.effects[0] for plan in drawn if plan.kind == "stranger"} == set(STRANGERS)
    assert len(STRANGERS) >= 10
    assert kinds["pair"] > 0
    assert kinds["triple"] > 0


def test_names_and_order_of_cases_say_nothing():
    kinds = [plan.kind for plan in plans(FULL)]
    first, last = Counter(kinds[:608]), Counter(kinds[608:])
    # 200 +- 10 in each half, at five standard deviations
    assert abs(first["nothing"] - last["nothing"]) < 120


def test_an_effect_left_out_does_not_give_the_truth_away():
    decoys = [plan for plan in plans(FULL) if plan.kind != "without" and plan.without]
    assert len(decoys) > 60
    assert all(plan.without[0] not in plan.effects for plan in decoys)


def test_the_small_study_has_some_twenty_cases_a_quarter_of_them_quiet():
    small = study("small", 1_000_001)
    assert small.cases == len(plans(small)) == 20
    assert sum(plan.kind == "nothing" for plan in plans(small)) >= 5
    with pytest.raises(BadInput, match="expected small, quarter, full or whole"):
        study("medium", 1)


def test_the_whole_study_holds_every_kind_and_class():
    whole = study("whole", 1_000_001)
    kinds = Counter(plan.kind for plan in plans(whole))
    assert whole.cases == sum(kinds.values()) == 1500
    assert set(CLASSES) < set(kinds)
    assert {(p.effects, p.snr) for p in plans(whole) if p.kind == "strong"} == {
        ((name,), snr) for name in NAMES for snr in (50.0, 200.0, 1000.0)
    }


def test_a_quarter_of_the_whole_study_holds_every_kind_and_class_too():
    quarter = study("quarter", 1_000_001)
    kinds = Counter(plan.kind for plan in plans(quarter))
    assert quarter.cases == sum(kinds.values()) == 386
    assert set(kinds) == {plan.kind for plan in plans(study("whole", 1_000_001))}


def test_every_effect_has_a_law():
    assert set(LAWS) == set(NAMES) | set(STRANGERS) | set(NEAR)


def test_training_and_study_seeds_lie_apart_and_so_do_their_streams():
    check_training(999_999)
    check_study(1_000_000)
    with pytest.raises(BadInput, match="training seed 1000000"):
        check_training(1_000_000)
    with pytest.raises(BadInput, match="study seed 999999"):
        check_study(999_999)
    assert study("full", 5).domain != FULL.domain
    assert stream(5, "study").random() != stream(5, "training").random()


def single(effect):
    return next(plan for plan in plans(FULL) if plan.kind == "single" and plan.effects == (effect,))


@pytest.mark.parametrize("effect", ["bias_ramp", "scale_factor_error", "angle_random_walk", "dropouts"])
def test_amplitudes_meet_a_target_within_the_study_s_range(effect):
    from withheld.study.cases import label

    plan = single(effect)
    known = label(FULL, plan, draw_case(FULL, plan))["effects"][0]
    assert FULL.snr_low * 0.5 < known["snr"] < FULL.snr_high * 1.1


def test_the_same_study_makes_the_same_bytes(tmp_path):
    chosen = [single("spikes")]
    for name in ("one", "two"):
        make_batch(FULL, chosen, tmp_path / name, tmp_path / f"{name}.json")
    files = [
        {p.relative_to(tmp_path / n): p.read_bytes() for p in (tmp_path / n).rglob("*") if p.is_file()}
        for n in ("one", "two")
    ]
    assert files[0] == files[1]
    assert sha256(tmp_path / "one.json") == sha256(tmp_path / "two.json")
    # what a diagnoser may see names no effect, only what it is to leave out
    public = read_json(tmp_path / "one" / "public.json")
    assert public == {chosen[0].name: {"without": list(chosen[0].without)}}
    seen = b"".join(files[0].values())
    assert b"spikes" not in seen
    assert b"effect" not in seen


def test_a_protocol_says_everything_and_comes_back():
    document = protocol_document(FULL)
    assert protocol_from(document) == FULL
    assert set(document) == {"schema", "study", "metrics", "designs", "laws", "code_sha256"}
    assert document["code_sha256"] == code_hash()
    with pytest.raises(BadInput, match="not a protocol"):
        protocol_from({"study": {"name": "x"}})


def test_a_seal_breaks_with_one_byte(tmp_path):
    (tmp_path / "a").write_text("one")
    write_seal(tmp_path / "seal", [tmp_path / "a"], tmp_path)
    assert check_seal(tmp_path / "seal", tmp_path) == [tmp_path / "a"]
    (tmp_path / "a").write_text("two")
    with pytest.raises(BadInput, match="is not what"):
        check_seal(tmp_path / "seal", tmp_path)
    with pytest.raises(BadInput, match="nothing to seal"):
        write_seal(tmp_path / "none", [], tmp_path)


def test_a_study_is_scored_once_and_the_next_knows_it(tmp_path):
    book = tmp_path / "ledger.json"
    assert enter(book, FULL, "x", "labels", "diagnoses") == {"before": 0, "tries": 0}
    assert enter(book, FULL, "x", "labels", "diagnoses") == {"before": 0, "tries": 0}  # the same again
    with pytest.raises(BadInput, match="scored on this study before"):
        enter(book, FULL, "x", "labels", "others")
    assert enter(book, FULL, "y", "labels", "others") == {"before": 0, "tries": 0}
    small = study("small", 1_000_001)
    enter(book, small, "x", "small", "one")
    enter(book, small, "x", "small", "two")  # it only tries the path
    assert enter(book, FULL, "x", "labels 2", "d") == {"before": 1, "tries": 2}


@pytest.fixture
def scored(tmp_path):
    """A study of one quiet case, made and sealed by hand; what `score` takes."""
    protocol = replace(study("small", 1_000_001), nothing_wrong=1, singles_total=0, singles_each=0, pairs=0,
                       triples=0, without_each=0, strangers_each=0)  # fmt: skip
    write_json(tmp_path / "protocol.json", protocol_document(protocol))
    write_seal(tmp_path / "protocol.sha256", [tmp_path / "protocol.json"], tmp_path)
    label = {
        "case": "case-0001",
        "kind": "nothing",
        "design": "eight",
        "gyros": 4,
        "effects": [],
        "oracle_closure": None,
    }
    write_json(tmp_path / "sealed" / "batch-000.json", [label])
    said = {"schema": "fogreduce/diagnosis/1", "verdict": "no_gap", "gap_probability": 0.1,
            "unknown_probability": 0.0, "where": [], "causes": [], "closure": None}  # fmt: skip
    write_json(tmp_path / "diagnoses" / "batch-000" / "case-0001" / "diagnosis.json", said)
    write_json(tmp_path / "diagnoses" / "batch-000" / "timing.json", {"case-0001": {"wall_s": 1.5}})
    write_seal(tmp_path / "labels.sha256", [tmp_path / "sealed" / "batch-000.json"], tmp_path / "sealed")
    reseal(tmp_path)
    return tmp_path


def reseal(folder):
    write_seal(
        folder / "diagnoses.sha256",
        list((folder / "diagnoses").rglob("diagnosis.json")),
        folder / "diagnoses",
    )


def scored_with(folder):
    return score(
        folder / "protocol.json",
        folder / "protocol.sha256",
        folder / "sealed",
        folder / "labels.sha256",
        folder / "diagnoses",
        folder / "diagnoses.sha256",
        "x",
        folder / "ledger.json",
    )


def test_scores_of_a_sealed_study(scored):
    scores = scored_with(scored)
    assert scores["outcomes"][0]["verdict_right"] is True
    assert scores["summary"]["seconds"]["median"] == 1.5


@pytest.mark.parametrize(
    "name", ["protocol.json", "sealed/batch-000.json", "diagnoses/batch-000/case-0001/diagnosis.json"]
)
def test_nothing_is_scored_behind_a_broken_seal(scored, name):
    (scored / name).write_text((scored / name).read_text() + " ")
    with pytest.raises(BadInput, match="is not what"):
        scored_with(scored)


def test_a_diagnosis_that_came_after_the_seal_is_none(scored):
    late = scored / "diagnoses" / "batch-000" / "case-0001" / "diagnosis.json"
    content = late.read_bytes()
    late.unlink()
    other = late.parents[1] / "case-0002" / "diagnosis.json"
    write_json(other, {})
    reseal(scored)
    late.write_bytes(content)
    assert scored_with(scored)["outcomes"][0]["valid"] is False


def test_another_bench_than_the_sealed_one_does_not_score(scored):
    document = read_json(scored / "protocol.json")
    write_json(scored / "protocol.json", {**document, "code_sha256": "0" * 64})
    write_seal(scored / "protocol.sha256", [scored / "protocol.json"], scored)
    with pytest.raises(BadInput, match="the bench has changed"):
        scored_with(scored)


def test_labels_of_another_number_of_cases_do_not_score(scored):
    write_json(scored / "sealed" / "batch-000.json", [])
    write_seal(scored / "labels.sha256", [scored / "sealed" / "batch-000.json"], scored / "sealed")
    with pytest.raises(BadInput, match="labels of 0 cases"):
        scored_with(scored)
