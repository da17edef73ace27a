"""The page over all campaigns."""

import html_checks
import pytest
from browser import evaluate, needs_browser
from many_runs import many_runs
from pages_lab import HOSTILE
from small_unit import succeed


@pytest.fixture(scope="module")
def page_of_lab(lab):
    lab.run("r1")
    lab.run("r2")
    succeed("page", "campaign", lab.results / "c1", "--campaigns", lab.campaign.parent)
    succeed("page", "index", lab.results, "--campaigns", lab.campaign.parent)
    return lab.results / "index.html"


@pytest.fixture(scope="module")
def page_of_many(tmp_path_factory):
    results = tmp_path_factory.mktemp("many")
    many_runs(results, 1000)
    succeed("page", "index", results)
    return results / "index.html"


def test_it_names_each_campaign_and_leads_to_its_page(page_of_lab) -> None:
    page = html_checks.check(page_of_lab.read_text(), scripts=1)
    assert HOSTILE in page.words
    links = [attrs["href"] for attrs in page.all("a") if not attrs["href"].startswith("#")]
    assert links == ["c1/index.html"]
    assert (page_of_lab.parent / links[0]).is_file()


def test_few_runs_have_a_centre_and_no_limits(page_of_lab) -> None:
    page = html_checks.check(page_of_lab.read_text(), scripts=1)
    assert "Unit TETRA-01: 2 runs" in page.words
    assert "too few runs" in page.words
    assert all("no limits" in attrs["aria-label"] for attrs in page.all("svg"))


def test_a_thousand_runs_as_control_charts_with_what_lies_outside(page_of_many) -> None:
    text = page_of_many.read_text()
    page = html_checks.check(text, scripts=1)
    print(f"1,000 runs: {len(text.encode()) / 1e6:.2f} MB")
    assert len(text.encode()) < 5e6
    # The 610th run lies 1.5 deg/h off on every axis.
    assert [attrs["href"] for attrs in page.all("a")].count("many/run-0610/index.html") == 3
    assert "How the limits are computed" in page.words


def test_the_same_results_give_the_same_bytes(page_of_lab, lab) -> None:
    before = page_of_lab.read_bytes()
    succeed("page", "index", lab.results, "--campaigns", lab.campaign.parent)
    assert page_of_lab.read_bytes() == before


def test_results_without_a_campaign_are_a_page_too(tmp_path) -> None:
    succeed("page", "index", tmp_path)
    html_checks.check((tmp_path / "index.html").read_text(), scripts=0)


@needs_browser
def test_it_opens_without_a_word_on_the_console_and_fetches_nothing(page_of_many, tmp_path) -> None:
    script = "return performance.getEntriesByType('resource').map((entry) => entry.name)"
    said, console = evaluate(page_of_many, script, tmp_path)
    assert console == []
    assert [name for name in said if not name.startswith("data:")] == []
