"""A folder appears whole or not at all."""

from __future__ import annotations

from pathlib import Path

import pytest

from fogreduce.simulate.publish import published


def files(folder: Path) -> dict[str, str]:
    return {str(p.relative_to(folder)): p.read_text() for p in sorted(folder.rglob("*")) if p.is_file()}


def test_nothing_is_there_before_the_end(tmp_path: Path) -> None:
    out = tmp_path / "deep" / "out"
    with published(out) as folder:
        (folder / "a").write_text("1")
        assert not out.exists()
    assert files(tmp_path) == {"deep/out/a": "1"}


def test_a_failure_leaves_nothing(tmp_path: Path) -> None:
    def stopped() -> None:
        with published(tmp_path / "out") as folder:
            (folder / "a").write_text("1")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        stopped()
    assert list(tmp_path.iterdir()) == []


def test_files_take_their_places_among_others(tmp_path: Path) -> None:
    out = tmp_path / "out"
    (out / "runs" / "x").mkdir(parents=True)
    (out / "kept").write_text("0")
    (out / "runs" / "x" / "a").write_text("old")
    with published(out) as folder:
        (folder / "runs" / "x").mkdir(parents=True)
        (folder / "runs" / "x" / "a").write_text("new")
        (folder / "runs" / "x" / "b").write_text("2")
        assert files(out) == {"kept": "0", "runs/x/a": "old"}
    assert files(tmp_path) == {"out/kept": "0", "out/runs/x/a": "new", "out/runs/x/b": "2"}


def test_two_at_once_do_not_disturb_each_other(tmp_path: Path) -> None:
    """Another process publishes its run into the same folder while this one works on its own."""
    out = tmp_path / "out"
    with published(out) as folder:
        (folder / "one").write_text("1")
        out.mkdir()
        (out / "two").write_text("2")
    assert files(tmp_path) == {"out/one": "1", "out/two": "2"}


def test_a_file_in_the_way_is_an_error(tmp_path: Path) -> None:
    (tmp_path / "out").write_text("a file")
    with pytest.raises(OSError, match="out"), published(tmp_path / "out") as folder:
        (folder / "a").write_text("1")
    assert files(tmp_path) == {"out": "a file"}
