"""Names of files: what is archived is valid to our `verify` and to bagit.py; the rest is refused before."""

import os
import shutil
import unicodedata

import bagit
import pytest
from archived_lab import CAMPAIGN, two_rates
from small_unit import call, succeed

from fogreduce.metadata.file_name import problem_of_file_name
from fogreduce.metadata.yaml12 import dump_yaml

LETTERS = "Prüfstand-Å 2é"
TAKEN = [
    "two words.txt",
    " a space before.txt",
    unicodedata.normalize("NFC", LETTERS),
    unicodedata.normalize("NFD", "Messung ö"),
    "測定 1.txt",
    "Ωμέγα🛰.txt",
    "#1; it's \"a\" [b] (c) & 'd' + e, f = g ~ * ? ! $HOME `x`.txt",
    "-rf",
    "~notes",
    "a..b",
    "ﬁ.txt",  # a ligature, which normal form KC takes apart
    "x" * 255,
]
REFUSED = [
    "50%.txt",
    "a%25b",
    "%0A",
    "end ",
    "a\u00a0b",
    "a\u200bb",
    "bell\x07",
    "line\nline",
    "back\\slash",
    "{run}",
]


def validate(bag):
    """Both say yes."""
    bagit.Bag(str(bag)).validate()
    return succeed("verify", bag)


def copied(archived, tmp_path):
    """A copy of the campaigns, with the arguments that archive it."""
    campaigns = tmp_path / "campaigns"
    shutil.copytree(archived.campaigns, campaigns)
    arguments = [campaigns if a == archived.campaigns else a for a in archived.arguments(tmp_path / "bags")]
    return campaigns / CAMPAIGN, arguments


def test_names_that_both_tools_accept(archived, tmp_path):
    campaign, arguments = copied(archived, tmp_path)
    for name in TAKEN:
        (campaign / name).write_text(name)
    succeed("check", campaign, "--calibrations", archived.calibrations)
    succeed(*arguments)
    bag = tmp_path / "bags" / CAMPAIGN
    validate(bag)
    succeed("restore", bag, "--out", tmp_path / "restored")
    restored = tmp_path / "restored" / "campaigns" / CAMPAIGN
    assert {name: (restored / name).read_text() for name in TAKEN} == {name: name for name in TAKEN}


@pytest.mark.parametrize("name", REFUSED)
def test_names_that_are_refused_before_anything_is_written(archived, tmp_path, name):
    campaign, arguments = copied(archived, tmp_path)
    (campaign / name).write_text("x")
    for command in (("check", campaign, "--calibrations", archived.calibrations), arguments):
        status, out, err = call(*command)
        assert (status, out) == (2, "")
        assert len(err.splitlines()) == 1
        assert "a name that cannot be archived" in err
        assert problem_of_file_name(name) in err
    assert not (tmp_path / "bags").exists()


def test_a_name_that_is_not_utf8_is_refused(archived, tmp_path):
    campaign, arguments = copied(archived, tmp_path)
    (campaign / os.fsdecode(b"a\xff")).write_text("x")
    status, _, err = call(*arguments)
    assert status == 2
    assert "not UTF-8" in err
    err.encode()  # and can be printed


def test_two_names_that_only_their_unicode_form_tells_apart(archived, tmp_path):
    campaign, arguments = copied(archived, tmp_path)
    for form in ("NFC", "NFD"):
        (campaign / unicodedata.normalize(form, "é")).write_text(form)
    for command in (("check", campaign, "--calibrations", archived.calibrations), arguments):
        status, _, err = call(*command)
        assert status == 2
        assert "another Unicode form" in err


@pytest.mark.parametrize("name", ["50%.fogcap", "a\u00a0b.fogcap", "end "])
def test_a_capture_of_such_a_name_is_refused_by_check(archived, tmp_path, name):
    campaign, _ = copied(archived, tmp_path)
    run = campaign / "runs" / "r1"
    (run / "capture.fogcap").rename(run / name)
    data = two_rates("r1")
    data["capture"]["file"] = name
    (run / "run.yaml").write_text(dump_yaml(data))
    status, out, err = call("check", run, "--calibrations", archived.calibrations)
    assert (status, out) == (2, "")
    assert "capture.file" in err
    assert problem_of_file_name(name) in err


def archived_as(name, archived, root):
    """The bag of a run that was reduced from a capture of that name."""
    campaign, arguments = copied(archived, root)
    run = campaign / "runs" / "r1"
    (run / "capture.fogcap").rename(run / name)
    data = two_rates("r1")
    data["capture"]["file"] = name
    (run / "run.yaml").write_text(dump_yaml(data))
    results = root / "results"
    out = results / CAMPAIGN / "r1"
    with archived.one_code():
        succeed("reduce", run, "--calibrations", archived.calibrations, "--out", out)
        succeed("checksums", out)
    succeed(*(results if a == archived.results else a for a in arguments))
    return root / "bags" / CAMPAIGN


def test_a_capture_whose_name_is_in_normal_form_d(archived, tmp_path):
    name = unicodedata.normalize("NFD", "Läufe é.fogcap")
    bag = archived_as(name, archived, tmp_path)
    validate(bag)
    assert (bag / "data" / "campaigns" / CAMPAIGN / "runs" / "r1" / name).is_file()


def test_a_bag_on_a_disk_that_takes_letters_apart(archived, tmp_path):
    """As a Mac's HFS+ does; bagit.py accepts it."""
    name = unicodedata.normalize("NFC", "Läufe é.fogcap")
    bag = archived_as(name, archived, tmp_path)
    validate(bag)
    run = bag / "data" / "campaigns" / CAMPAIGN / "runs" / "r1"
    (run / name).rename(run / unicodedata.normalize("NFD", name))
    bagit.Bag(str(bag)).validate()
    status, _, err = call("verify", bag)
    assert status == 0, err
    assert len(err.splitlines()) == 1
    assert "another Unicode form" in err
    succeed("restore", bag, "--out", tmp_path / "restored")
    assert (tmp_path / "restored" / "campaigns" / CAMPAIGN / "runs" / "r1" / name).is_file()


def test_a_file_that_looks_the_same_and_is_spelt_otherwise(archived, tmp_path):
    campaign, _ = copied(archived, tmp_path)
    run = campaign / "runs" / "r1"
    (run / "capture.fogcap").rename(run / unicodedata.normalize("NFD", "é.fogcap"))
    data = two_rates("r1")
    data["capture"]["file"] = unicodedata.normalize("NFC", "é.fogcap")
    (run / "run.yaml").write_text(dump_yaml(data))
    status, _, err = call("check", run, "--calibrations", archived.calibrations)
    assert status == 2
    assert "which is not there (one of that name in another Unicode form is: rename it)" in err
