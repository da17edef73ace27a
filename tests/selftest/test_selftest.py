"""``fogreduce selftest``: its numbers agree, a wrong one is said, and the page and the archive have them."""

from __future__ import annotations

import json

import pytest

from fogreduce.cli.main import main
from fogreduce.selftest import allan, geometry, gum, paper, run
from fogreduce.selftest.check import Check, printed


def test_the_package_has_the_repositorys_data(repository) -> None:
    """The published campaign and its record, byte for byte."""
    kept = paper.DATA
    names = sorted(path.relative_to(kept) for path in kept.rglob("*") if path.is_file())
    assert len(names) == 4
    for name in names:
        assert (kept / name).read_bytes() == (repository / name).read_bytes(), name
    text = (repository / "pyproject.toml").read_text()
    assert '"selftest/data/**/*.yaml"' in text


@pytest.mark.parametrize(
    "part", [allan.nist, allan.freedom, geometry.geometry, gum.impedance, gum.straight_line, paper.integrated]
)
def test_numbers_agree(part) -> None:
    for one in part():
        assert one.good, one


def test_printed_digits_bound_the_difference() -> None:
    """0.32 stands for 0.315 to 0.325."""
    assert printed("g", "w", "s", "0.32", 0.3249).good
    assert not printed("g", "w", "s", "0.32", 0.3251).good
    assert not printed("g", "w", "s", "-5.0", float("nan")).good


def test_command_page_and_exit_status(tmp_path, monkeypatch, capsys) -> None:
    """The whole command; then with one number spoilt."""
    assert main(["selftest", "--out", str(tmp_path / "a")]) == 0
    said = json.loads((tmp_path / "a" / "selftest.json").read_text())
    assert (said["failed"], said["checks"]) == (0, len(said["results"]))
    assert {one["group"] for one in said["results"]} >= {
        "Allan deviation", "Degrees of freedom", "Geometry", "GUM H.2", "GUM H.3", "The paper's Table 4",
    }  # fmt: skip
    html = (tmp_path / "a" / "selftest.html").read_text()
    assert f"All {said['checks']} numbers agree" in html
    assert "0.2922319" in html
    spoilt = Check("group", "a number", "nowhere", 1.0, 2.0, 0.1, "none")
    monkeypatch.setattr(run, "checks", lambda: [spoilt])
    assert main(["selftest", "--out", str(tmp_path / "b")]) == 1
    assert "a number: expected 1, obtained 2" in capsys.readouterr().out
    assert "1 of 1 numbers do not agree" in (tmp_path / "b" / "selftest.html").read_text()


def test_the_archive_takes_it_up(published, repository, tmp_path) -> None:
    """What stands in `_selftest` beside the campaigns is among an archive's contents."""
    import shutil

    from fogreduce.archive.contents import contents

    results = tmp_path / "results"
    shutil.copytree(published.reduced.out, results / "published" / "x-one-turn")
    assert main(["checksums", str(results / "published" / "x-one-turn"), "--no-keep"]) == 0
    run.write([Check("g", "w", "s", 1.0, 1.0, 0.1, "none")], results / "_selftest")
    campaigns = published.run_dir.parents[2]
    found = contents(results, "published", campaigns, published.calibrations, repository)
    paths = {item.path for item in found.items}
    assert {"results/_selftest/selftest.html", "results/_selftest/selftest.json"} <= paths
