"""Pages as wide as a phone, 390 px: what stands in them is no wider, tables of many columns are blocks."""

import shutil
from html import escape
from pathlib import Path

import html_checks
import pytest
from browser import evaluate, needs_browser
from small_unit import succeed

WIDTH = 390
#: Chromium's own window is no narrower than 500 px; a frame is.
FRAME = (
    "<!DOCTYPE html><html><body><iframe style='width:{}px;height:900px;border:0' srcdoc=\"{}\"></iframe>"
    "</body></html>"
)
WIDE = """
const frame = document.querySelector('iframe');
while (frame.contentDocument.readyState !== 'complete' || !frame.contentDocument.querySelector('main'))
  await new Promise((done) => setTimeout(done, 50));
const page = frame.contentDocument, all = (what) => [...page.querySelectorAll(what)];
const wide = all('.scroll').filter((box) => box.scrollWidth > box.clientWidth);
const shown = all('.cards tbody td').filter((cell) => cell.offsetWidth);
const named = shown.filter((cell) => getComputedStyle(cell, '::before').content.startsWith('"'));
return {wide: wide.map((box) => box.textContent.slice(0, 60)), inner: frame.contentWindow.innerWidth,
  page: page.documentElement.scrollWidth, shown: shown.length, named: named.length};
"""
PAGES = (
    "c1/_diagnosis/index.html",
    "c1/_report/index.html",
    "c1/_calibration/index.html",
    "_units/TETRA-01.html",
    "c1/r1/index.html",
    "c1/index.html",
    "index.html",
)


@pytest.fixture(scope="module")
def results(lab, tmp_path_factory) -> Path:
    """Results of the laboratory with every kind of page."""
    root = tmp_path_factory.mktemp("phone")
    results = Path(shutil.copytree(lab.run("r1").parent.parent, root / "results"))
    lab.run("r2")
    shutil.copy(lab.results / "c1" / "r2" / "index.html", results / "c1" / "r2")
    campaign = Path(shutil.copytree(lab.campaign, root / "campaigns" / "c1"))
    shutil.rmtree(campaign / "runs" / "r3")
    records = ("--calibrations", lab.campaign.parent.parent / "calibrations")
    succeed("diagnose", campaign, *records, "--out", results / "c1" / "_diagnosis")
    succeed("report", campaign, *records, "--out", results / "c1" / "_report")
    succeed("derive-calibration", campaign, *records, "--out", results / "c1" / "_calibration")
    succeed("calibrations", "page", "TETRA-01", *records, "--out", results / "_units" / "TETRA-01.html")
    succeed("page", "campaign", results / "c1", "--campaigns", campaign.parent)
    succeed("page", "index", results, "--campaigns", campaign.parent)
    return results


def links(page: Path) -> set[str]:
    """The files to which a page leads; links within it are left out."""
    found = [attrs["href"] for attrs in html_checks.Page(page.read_text()).all("a")]
    return {link.partition("#")[0] for link in found if link[0] != "#"}


@pytest.mark.slow
def test_no_link_of_any_page_is_dead_and_each_leads_back(results) -> None:
    for page in (results / name for name in PAGES):
        assert [link for link in links(page) if not (page.parent / link).is_file()] == []
    assert "../index.html" in links(results / "_units" / "TETRA-01.html")
    for name in ("_diagnosis", "_report", "_calibration"):
        assert "../index.html" in links(results / "c1" / name / "index.html")


@needs_browser
@pytest.mark.slow
@pytest.mark.parametrize("page", PAGES)
def test_nothing_is_wider_than_a_phone(results, tmp_path, page) -> None:
    frame = tmp_path / "frame.html"
    frame.write_text(FRAME.format(WIDTH, escape((results / page).read_text(encoding="utf-8"))))
    found, _ = evaluate(frame, WIDE, tmp_path)
    assert found["inner"] == WIDTH
    assert found["wide"] == []
    assert found["page"] <= WIDTH
    assert found["named"] > 0.4 * found["shown"]
