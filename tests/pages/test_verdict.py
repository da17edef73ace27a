"""Good or flagged, and why."""

from __future__ import annotations

import csv
import json
import math
import shutil
from pathlib import Path

import html_checks
import pytest
from many_runs import many_runs
from small_unit import succeed

from fogreduce.pages.history import outside
from fogreduce.pages.verdict import combined, verdict


def run(x: float = 0.0, **more) -> dict:
    entry = {"value": x, "error": 0.03, "stated": 0.04}
    return {"unit": "U", "flagged": {}, "attention": [], "offset": {"x": entry}, "drift": {}, **more}


def test_a_good_run_says_how_near_the_command_it_is() -> None:
    said = verdict(run(0.1, flagged={"spurious_gyro1": 2, "spurious_gyro2": 1}))
    assert said.state == "good"
    assert "at most 2 standard uncertainties off" in said.text  # 0.1 / hypot(0.03, 0.04)
    assert "3 spurious" in said.text


def test_reasons_come_first_to_last() -> None:
    warning = {"kind": "warning", "text": "lost: 11 of 1000 records, 1.1 %"}
    limits = {"kind": "outside limits", "text": "x: far"}
    said = verdict(run(attention=[warning]), [limits])
    assert said.state == "flagged"
    assert said.text == "warning: lost: 11 of 1000 records, 1.1 %; and 1 more"
    assert verdict(run(), [limits]).text == "outside limits: x: far"


def test_uncertainty_is_noise_and_what_is_stated() -> None:
    assert combined({"error": 3.0, "stated": 4.0}) == 5.0
    assert combined({"error": 3.0, "stated": None}) == 3.0
    assert combined({}) is None


def test_a_run_far_off_is_outside_its_units_limits_and_no_other_is() -> None:
    far = [0.01 * math.sin(k) for k in range(12)]
    far[7] = 14.0
    runs = [run(x) for x in far] + [{**run(99.0), "unit": "another"}]
    said = outside(runs)
    assert [bool(reasons) for reasons in said] == [k == 7 for k in range(13)]
    assert said[7][0]["kind"] == "outside limits"
    assert "x: mean rate less commanded 14.000 ± 0.030 deg/h, control limits" in said[7][0]["text"]


def test_the_index_and_the_campaigns_page_count_what_lies_outside(tmp_path) -> None:
    """Run 610 of these is 1.5 deg/h off on every axis, and has nothing else wrong."""
    many_runs(tmp_path, 650)
    succeed("page", "campaign", tmp_path / "many")
    succeed("page", "index", tmp_path)
    text = (tmp_path / "many" / "index.html").read_text()
    page = html_checks.check(text, scripts=1)
    rows = [line for line in text.splitlines() if "</th><td>flagged</td>" in line]
    assert any("run-0610" in line for line in rows)
    flagged = len(rows)
    index = html_checks.check((tmp_path / "index.html").read_text(), scripts=1)
    assert f"{flagged} outside limits" in index.words
    assert f"of 650 runs {flagged} flagged, 32 failed" in page.words


@pytest.fixture(scope="module")
def page_of_run(lab):
    return html_checks.check((lab.run("r1") / "index.html").read_text(), scripts=1)


def test_a_runs_page_answers_first(page_of_run, lab) -> None:
    """Verdict, differences and drift with their uncertainty, the figure; at last what was run, with what."""
    words = page_of_run.words
    order = [
        "Good: mean rates agree",
        "mean rate less commanded [deg/h]",
        "Rate less the commanded",
    ]
    order += [
        "Drift of each axis.",
        "What was flagged",
        "Mean curves",
        "What was run Unit",
        "With what Calibration",
    ]
    places = [words.index(part) for part in order]
    assert places == sorted(places)
    offset = json.loads((lab.run("r1") / "reports" / "overview.json").read_text())["offset"]["x"]
    error = math.hypot(offset["error"], offset["stated"])
    digits = 1 - math.floor(math.log10(error))
    assert f"± {error:.{digits}f}" in words[places[1] : places[2]]


def test_the_whole_run_comes_first_and_bold(page_of_run, lab) -> None:
    with (lab.run("r1") / "tables" / "drift.csv").open() as file:
        assert next(csv.DictReader(file))["segment"] == "1"
    drift = page_of_run.words[page_of_run.words.index("Drift of each axis.") :]
    assert drift.index("xwhole run") < drift.index("x1")
    # Three rows of drift, three of mean rates.
    assert [attrs.get("class") for attrs in page_of_run.all("tr")].count("strong") == 6


def test_a_campaigns_table_comes_before_its_plots(lab, tmp_path) -> None:
    folder = Path(shutil.copytree(lab.run("r1").parent, tmp_path / "c1"))
    succeed("page", "campaign", folder)
    page = html_checks.check((folder / "index.html").read_text(), scripts=1)
    tags = [tag for tag, _ in page.tags]
    assert tags.index("table") < tags.index("svg")


def test_no_link_of_run_campaign_and_index_is_dead(lab, tmp_path) -> None:
    results = Path(shutil.copytree(lab.run("r1").parent.parent, tmp_path / "results"))
    succeed("page", "campaign", results / "c1")
    (results / "c1" / "_report").mkdir()
    (results / "c1" / "_report" / "index.html").write_text("")
    succeed("page", "campaign", results / "c1")
    records, unit_page = lab.campaign.parents[1] / "calibrations", results / "_units" / "TETRA-01.html"
    succeed("calibrations", "page", "TETRA-01", "--calibrations", records, "--out", unit_page)
    succeed("page", "index", results)
    for path in (results / "index.html", results / "c1" / "index.html", results / "c1" / "r1" / "index.html"):
        links = [attrs["href"] for attrs in html_checks.Page(path.read_text()).all("a")]
        assert links
        assert any(link.endswith(("_units/TETRA-01.html", "/index.html#unit-TETRA-01")) for link in links)
        files = [link.partition("#")[0] for link in links if link[0] != "#"]
        assert [file for file in files if not (path.parent / file).is_file()] == []
    assert 'id="unit-TETRA-01"' in (results / "index.html").read_text()
    assert 'href="_report/index.html"' in (results / "c1" / "index.html").read_text()
