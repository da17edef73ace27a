"""Which results used a record: manifests that were written by hand, so that nothing but them counts."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from fogreduce.errors import BadInput
from fogreduce.reruns.uses import REWRITTEN, refuse_rewritten, rewritten, some_of, uses_below

OLD, NEW = "a" * 64, "b" * 64


def manifest(folder: Path, record: str, sha256: str) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    data = {
        # What somebody wrote in notes is no use of a record.
        "run": {"notes": '"calibration": {"id": "U@x", "sha256": "' + NEW + '"}'},
        "calibration": {"id": record, "sha256": sha256},
    }
    (folder / "manifest.json").write_text(json.dumps(data, indent=1))


@pytest.fixture
def results(tmp_path: Path) -> Path:
    manifest(tmp_path / "lab" / "one", "U@a", OLD)
    manifest(tmp_path / "lab" / "one" / "versions" / "1-00", "U@0", OLD)
    manifest(tmp_path / "lab" / "two", "U@b", NEW)
    manifest(tmp_path / "_captures" / "no", "U@a", NEW)
    return tmp_path


def test_newest_and_kept_versions_are_found_and_nothing_else(results: Path) -> None:
    found = [(str(use), use.record_id, use.sha256) for use in uses_below(results)]
    assert found == [
        ("lab/one", "U@a", OLD),
        ("lab/one, version 1-00", "U@0", OLD),
        ("lab/two", "U@b", NEW),
    ]


def test_a_record_is_rewritten_where_no_use_has_its_bytes(results: Path) -> None:
    uses = uses_below(results)
    assert rewritten(uses, {"U@a": OLD, "U@b": NEW, "U@0": OLD}) == {}
    assert rewritten(uses, {"U@a": NEW, "U@0": NEW, "U@never": NEW}) == {
        "U@a": ["lab/one"],
        "U@0": ["lab/one"],
    }


def test_a_rewritten_record_is_refused_and_named_with_what_used_it(results: Path, tmp_path: Path) -> None:
    calibrations = tmp_path / "calibrations"
    refuse_rewritten("U@a", OLD, calibrations, results / "lab" / "one")
    with pytest.raises(BadInput, match=r"calibrations/U/a\.yaml: found another content than one was reduced"):
        refuse_rewritten("U@a", NEW, calibrations, results / "lab" / "one")
    # A run that was never reduced: the folders beside it are looked at where asked, and the workflow's note.
    refuse_rewritten("U@a", NEW, calibrations, results / "lab" / "three")
    with pytest.raises(BadInput, match="one was reduced"):
        refuse_rewritten("U@a", NEW, calibrations, results / "lab" / "three", neighbours=True)
    (results / REWRITTEN).write_text(json.dumps({"U@a": ["lab/one"]}))
    with pytest.raises(BadInput, match="lab/one was reduced"):
        refuse_rewritten("U@a", NEW, calibrations, results / "lab" / "three")


def test_a_kept_version_counts_as_a_use(results: Path) -> None:
    with pytest.raises(BadInput, match="never rewritten"):
        refuse_rewritten("U@0", NEW, results / "c", results / "lab" / "one")


def test_many_names_are_counted() -> None:
    assert some_of(["a"]) == "a"
    assert some_of(["a", "b"]) == "a and b"
    assert some_of(list("abcde")) == "a, b, c and 2 more"
