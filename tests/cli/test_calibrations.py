"""``fogreduce calibrations`` and ``fogreduce impact`` as their user calls them."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import pytest

from fogreduce.cli.main import main


@pytest.fixture
def lab(small_lab):
    """A run reduced with the first of two records, the second naming it."""
    text = small_lab.record.read_text()
    later = text.replace("version: 2012a", "version: 2013a").replace("2012-06-01", "2013-06-01")
    later = later.replace("0.09,", "0.0909,").replace("- 0.09\n", "- 0.0909\n")
    assert later.count("0.0909") == 1
    small_lab.record.with_name("2013a.yaml").write_text(later + "supersedes: TETRA-01@2012a\n")
    small_lab.results = small_lab.root / "results"
    out = str(small_lab.results / "c1" / "r1")
    assert (
        main(["reduce", str(small_lab.run), "--calibrations", str(small_lab.calibrations), "--out", out]) == 0
    )
    return small_lab


def call(lab, *words: str) -> int:
    return main([*words, "--calibrations", str(lab.calibrations)])


def test_list_says_validity_succession_and_use(lab, capsys) -> None:
    capsys.readouterr()
    assert call(lab, "calibrations", "list", "--results", str(lab.results)) == 0
    head, first, second = capsys.readouterr().out.splitlines()
    assert head.split()[0] == "record"
    assert first.startswith("TETRA-01@2012a  2012-06-01")
    assert "superseded by TETRA-01@2013a; 1 run" in first
    assert "in force; no runs" in second


def test_list_goes_on_past_a_record_that_cannot_be_read(lab, capsys) -> None:
    lab.record.with_name("2014a.yaml").write_text("schema: fogreduce/calibration/1\n")
    capsys.readouterr()
    assert call(lab, "calibrations", "list") == 2
    said = capsys.readouterr()
    assert "TETRA-01@2013a" in said.out
    assert "2014a.yaml" in said.err


def test_show_and_diff(lab, capsys) -> None:
    capsys.readouterr()
    assert call(lab, "calibrations", "show", "TETRA-01@2013a", "--results", str(lab.results)) == 0
    said = capsys.readouterr().out
    assert "history: TETRA-01@2013a <- TETRA-01@2012a" in said
    assert "used by no runs" in said
    assert "the record states none: the project's defaults" in said
    assert call(lab, "calibrations", "diff", "TETRA-01@2012a", "TETRA-01@2013a") == 0
    said = capsys.readouterr().out.splitlines()
    assert "365 days later" in said[0]
    (scale,) = [line for line in said if line.startswith("gyro2  scale factor")]
    assert "10000 ± 140" in scale  # 0.0909 / 0.09; two defaults of 100 ppm
    assert scale.endswith("70.7 *")


def test_a_used_record_that_was_changed_is_refused_by_reduce_and_found_by_validate(lab, capsys) -> None:
    assert call(lab, "calibrations", "validate", "--results", str(lab.results)) == 0
    lab.record.write_text(lab.record.read_text().replace("certificate 7", "certificate 8"))
    before = {path: path.read_bytes() for path in lab.results.rglob("*") if path.is_file()}
    other = shutil.copytree(lab.run, lab.run.with_name("r2"))
    (other / "run.yaml").write_text(lab.yaml.read_text().replace("run_id: r1", "run_id: r2"))
    for run in (lab.run, other):  # also a run that was never reduced, beside the results that used it
        capsys.readouterr()
        assert call(lab, "reduce", str(run), "--out", str(lab.results / "c1" / run.name)) == 2
        (line,) = capsys.readouterr().err.splitlines()
        assert line.startswith(f"{lab.record}: found another content than r1 was reduced with")
    assert before == {path: path.read_bytes() for path in lab.results.rglob("*") if path.is_file()}
    assert not (lab.results / "c1" / "r2").exists()
    assert call(lab, "calibrations", "validate", "--results", str(lab.results)) == 2
    assert "another content than c1/r1 used" in capsys.readouterr().err


def test_impact_names_runs_later_records_and_what_is_kept(lab, capsys) -> None:
    (lab.results / "c1" / "_calibration").mkdir()
    (lab.results / "c1" / "_calibration" / "derivation.json").write_text('{"started_from": "TETRA-01@2012a"}')
    shutil.copytree(lab.results / "c1" / "r1", lab.results / "c2" / "r1" / "versions" / "1-00")
    shutil.copytree(lab.results / "c1" / "r1", lab.results / "c2" / "r1", dirs_exist_ok=True)
    path = lab.results / "c2" / "r1" / "manifest.json"
    path.write_text(path.read_text().replace('"id": "TETRA-01@2012a"', '"id": "TETRA-01@2013a"'))
    capsys.readouterr()
    words = ("impact", "TETRA-01@2012a", "--results", str(lab.results))
    assert call(lab, *words, "--format", "json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["runs"] == ["c1/r1"]
    assert found["of_runs"] == ["c1/_calibration"]
    assert found["kept"] == ["c2/r1, version 1-00"]
    assert found["records"] == ["TETRA-01@2013a"]
    assert call(lab, *words) == 0
    assert capsys.readouterr().out.splitlines()[0] == f"TETRA-01@2012a: 1 run in {lab.results}"


def test_the_page_of_a_unit(lab, capsys, tmp_path: Path) -> None:
    page = tmp_path / "unit.html"
    words = ("calibrations", "page", "TETRA-01", "--out", str(page), "--results", str(lab.results))
    assert call(lab, *words) == 0
    text = page.read_text()
    assert "From TETRA-01@2012a to TETRA-01@2013a, 0.999 years" in text
    assert "<strong>70.7</strong>" in text
    assert '<td class="n">0.0</td>' in text, "what did not change is not bold"
    assert "Input axis (first direction across it) of each gyro over its records" in text
    before = page.read_bytes()
    assert call(lab, *words) == 0
    assert page.read_bytes() == before


def test_the_page_of_a_unit_with_one_record_shows_no_changes(small_lab, tmp_path: Path) -> None:
    page = tmp_path / "unit.html"
    assert call(small_lab, "calibrations", "page", "TETRA-01", "--out", str(page)) == 0
    assert "Bias of each gyro over its records" in page.read_text()
    assert "change since the first record" not in page.read_text()


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        (("calibrations", "list", "NOBODY"), "found no unit NOBODY; expected a unit with records: TETRA-01"),
        (("calibrations", "show", "TETRA-01"), "expected <unit>@<version>"),
        (("calibrations", "show", "TETRA-01@x"), "found no such file"),
        (("calibrations", "diff", "TETRA-01@2012a", "TETRA-01@x"), "found no such file"),
        (("calibrations", "page", "TETRA-01", "--out", "page.txt"), "expected the name of an .html file"),
        (("calibrations", "validate", "--results", "nowhere"), "nowhere: found no such folder"),
        (("impact", "TETRA-01@x", "--results", "."), "found no record TETRA-01@x"),
        (("impact", "TETRA-01"), "expected <unit>@<version>"),
    ],
)
def test_bad_input_is_one_line(small_lab, capsys, words, expected) -> None:
    assert call(small_lab, *words) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert expected in line
