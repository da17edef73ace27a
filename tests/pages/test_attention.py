"""What stands at the top of pages: a run with a gyro's sign turned, warnings, records lost."""

from __future__ import annotations

import csv
import json
import re
import shutil
from pathlib import Path

import html_checks
import pytest
from small_unit import succeed

from fogreduce.pages.attention import attention, first_of_each, names_of, runs_to_see
from fogreduce.pages.numbers import number


@pytest.fixture(scope="module")
def wrong(lab, tmp_path_factory) -> Path:
    """Results of a campaign: r1 with gyro 1's polarity turned, r2 as it should be; all pages written."""
    root = tmp_path_factory.mktemp("attention")
    campaign = Path(shutil.copytree(lab.campaign, root / "campaigns" / "c1"))
    path = campaign / "runs" / "r1" / "run.yaml"
    text = path.read_text()
    path.write_text(text.replace("polarity: [1, -1", "polarity: [-1, -1"))
    assert text != path.read_text()
    calibrations = lab.results.parent / "calibrations"
    for run in ("r1", "r2"):
        out = root / "results" / "c1" / run
        succeed("reduce", campaign / "runs" / run, "--calibrations", calibrations, "--out", out)
        succeed("page", "run", out)
    succeed("page", "campaign", root / "results" / "c1")
    succeed("page", "index", root / "results")
    return root / "results"


LOOKS = "looks like the other sign: gyro1 (capture.polarity)"


def test_the_runs_page_begins_with_its_red_flags(wrong) -> None:
    page = html_checks.check((wrong / "c1" / "r1" / "index.html").read_text(), scripts=1)
    assert LOOKS in page.words
    assert page.words.index("red flag") < page.words.index("What was run")
    good = html_checks.check((wrong / "c1" / "r2" / "index.html").read_text(), scripts=1)
    assert "red flag" not in good.words


def test_mean_rates_stand_beside_drift(wrong) -> None:
    page = html_checks.check((wrong / "c1" / "r1" / "index.html").read_text(), scripts=1)
    drift = page.words[page.words.index("Drift of each axis.") :]
    assert "mean rate less commanded [deg/h]" in drift[:700]
    with (wrong / "c1" / "r1" / "tables" / "rates.csv").open() as file:
        row = next(csv.DictReader(file))
    assert number(float(row["difference_sigma"]), 3) in drift


def test_the_campaigns_page_and_the_index_link_it(wrong) -> None:
    for name, href in (("c1/index.html", "r1/index.html"), ("index.html", "c1/r1/index.html")):
        page = html_checks.check((wrong / name).read_text(), scripts=1)
        assert LOOKS in page.words
        assert any(attrs.get("href") == href for attrs in page.all("a"))
    states = re.findall(r"</th><td>(flagged|good)</td>", (wrong / "c1" / "index.html").read_text())
    assert states == ["flagged", "good"]


def test_warnings_of_ingest_and_shares_of_records() -> None:
    warning = {"severity": "warning", "what": "rate of the stamps", "where": "run.yaml", "version_id": "v"}
    said = attention(
        [], [{**warning, "found": "101 Hz", "expected": "100 Hz"}], {"lost": 11, "missing_gyro2": 10}, 1000
    )
    assert said == [
        {"kind": "warning", "text": "run.yaml: rate of the stamps: found 101 Hz; expected 100 Hz"},
        {"kind": "warning", "text": "lost: 11 of 1000 records, 1.1 %"},
    ]


def test_a_warning_in_the_table_is_on_the_page(wrong, tmp_path) -> None:
    folder = Path(shutil.copytree(wrong / "c1" / "r2", tmp_path / "r2"))
    version = json.loads((folder / "manifest.json").read_text())["version_id"]
    header = "severity,what,where,found,expected,version_id"
    line = f"warning,rate of the stamps,capture.fogcap,101 Hz,100 Hz,{version}"
    (folder / "tables" / "warnings.csv").write_text(f"{header}\n{line}\n")
    (folder / "reports" / "overview.json").unlink()
    succeed("page", "run", folder)
    page = html_checks.check((folder / "index.html").read_text(), scripts=1)
    assert "capture.fogcap: rate of the stamps: found 101 Hz; expected 100 Hz" in page.words


def test_red_flags_come_before_warnings_and_few_are_shown() -> None:
    def of(kind: str, number: int) -> list[dict]:
        return [{"kind": kind, "text": str(k)} for k in range(number)]

    runs = [("a", None, of("warning", 2)), ("b", "b.html", of("red flag", 3)), ("c", None, of("warning", 0))]
    found = runs_to_see(runs, most=1)
    assert found.shown == [{"run": "b", "href": "b.html", "kind": "red flag", "text": "0", "more": 2}]
    assert found.more == 1
    shown, more = first_of_each(of("warning", 9))
    assert (len(shown), more) == (6, 3)


def test_axes_stand_before_gyros() -> None:
    overviews = [{"drift": {"gyro2": 1, "gyro10": 1, "z": 1}}, {"drift": {"x": 1}}]
    assert names_of("drift", overviews) == ["x", "z", "gyro2", "gyro10"]
