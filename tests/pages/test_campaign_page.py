"""The page of a campaign."""

import re
import shutil
from pathlib import Path

import html_checks
import pytest
from browser import chromium, evaluate, needs_browser, usable_ms
from many_runs import many_runs
from pages_lab import HOSTILE
from small_unit import succeed


@pytest.fixture(scope="module")
def page_of_lab(lab):
    lab.run("r1")
    lab.run("r2")
    succeed("page", "campaign", lab.results / "c1", "--campaigns", lab.campaign.parent)
    return lab.results / "c1" / "index.html"


@pytest.fixture(scope="module")
def page_of_many(tmp_path_factory):
    folder = many_runs(tmp_path_factory.mktemp("many"), 1000)
    succeed("page", "campaign", folder)
    return folder / "index.html"


def states_of(page):
    """State of each run, in the order of the table of runs."""
    table = re.search('<table id="runs-table".*?</table>', page.read_text(), re.DOTALL)
    return re.findall(r"</th><td>(\w+)</td>", table[0])


def test_runs_stand_side_by_side_in_order_of_date(page_of_lab) -> None:
    page = html_checks.check(page_of_lab.read_text(), scripts=1)
    assert states_of(page_of_lab) == ["good", "good", "failed"]
    links = [attrs["href"] for attrs in page.all("a")]
    assert [link for link in links if link.startswith("r")] == ["r1/index.html", "r2/index.html"]
    assert all((page_of_lab.parent / link).is_file() for link in links if link.startswith("r"))
    said = " ".join(attrs["aria-label"] for attrs in page.all("svg"))
    for words in ("Drift by run", "Mean rates less commanded by run", "x: 2 runs", "gyro4: 2 runs"):
        assert words in said


def test_what_nobody_stated_is_listed_as_assumed(page_of_lab) -> None:
    page = html_checks.check(page_of_lab.read_text(), scripts=1)
    for words in ("what stands in for it", "uncertainty.bias_V", "1 deg/h", "site.latitude_uncertainty_deg"):
        assert words in page.words


def test_a_run_that_failed_is_there_with_its_reason(page_of_lab) -> None:
    page = html_checks.check(page_of_lab.read_text(), scripts=1)
    assert page.words.count("capture.fogcap: byte 0: found") == 2
    assert "1 failed" in page.words
    assert "<b>made up</b>" in page.words
    assert HOSTILE in page.words


def test_a_run_whose_tables_are_gone_failed_though_an_overview_lies_there(lab, tmp_path) -> None:
    folder = Path(shutil.copytree(lab.results / "c1", tmp_path / "c1"))
    shutil.copytree(lab.run("r1"), folder / "r1", dirs_exist_ok=True)
    (folder / "r1" / "tables" / "drift.csv").unlink()
    succeed("page", "campaign", folder)
    page = html_checks.check((folder / "index.html").read_text(), scripts=1)
    assert "drift.csv: found no such file" in page.words


def test_runs_that_the_campaign_no_longer_has_are_not_shown(lab, tmp_path) -> None:
    campaigns = Path(shutil.copytree(lab.campaign.parent, tmp_path / "campaigns"))
    shutil.rmtree(campaigns / "c1" / "runs" / "r2")
    folder = Path(shutil.copytree(lab.results / "c1", tmp_path / "results" / "c1"))
    succeed("page", "campaign", folder, "--campaigns", campaigns)
    html_checks.check((folder / "index.html").read_text(), scripts=1)
    assert len(states_of(folder / "index.html")) == 2


def test_the_same_results_give_the_same_bytes(page_of_lab, lab) -> None:
    before = page_of_lab.read_bytes()
    succeed("page", "campaign", lab.results / "c1", "--campaigns", lab.campaign.parent)
    assert page_of_lab.read_bytes() == before


def test_no_run_at_all_is_a_page_too(tmp_path) -> None:
    (tmp_path / "empty").mkdir()
    succeed("page", "campaign", tmp_path / "empty")
    html_checks.check((tmp_path / "empty" / "index.html").read_text(), scripts=1)


def test_a_thousand_runs_are_below_a_megabyte(page_of_many) -> None:
    html_checks.check(page_of_many.read_text(), scripts=1)
    print(f"campaign of 1,000 runs: {page_of_many.stat().st_size / 1e6:.2f} MB")
    assert page_of_many.stat().st_size < 1e6


SORT = """
const heads = [...document.querySelectorAll('#runs-table thead th')];
const column = heads.findIndex((th) => th.textContent.startsWith('drift x'));
const button = heads[column].querySelector('button');
const rows = () => [...document.querySelectorAll('#runs-table tbody tr')];
const values = () => rows().map((row) => row.cells[column].textContent.replace('\u2212', '-'));
button.focus();
button.click();
const up = values(), sorted_up = heads[column].getAttribute('aria-sort');
button.click();
const down = values(), sorted_down = heads[column].getAttribute('aria-sort');
heads[0].querySelector('button').click();
return {up, down, sorted_up, sorted_down, focused: document.activeElement === button,
  other: heads[column].getAttribute('aria-sort'), first: heads[0].getAttribute('aria-sort')};
"""


@needs_browser
def test_it_sorts_by_numbers_and_says_so(page_of_many, tmp_path) -> None:
    said, console = evaluate(page_of_many, SORT, tmp_path)
    assert console == []
    for way, order in (("up", 1), ("down", -1)):
        there = [float(value.split()[0]) for value in said[way] if value]
        assert len(there) == 950
        assert there == sorted(there, reverse=order < 0)
        assert said[way][950:] == [""] * 50  # runs that failed stay at the end
    assert (said["sorted_up"], said["sorted_down"]) == ("ascending", "descending")
    assert (said["other"], said["first"]) == (None, "ascending")
    assert said["focused"]


FILTER = """
const rows = [...document.querySelectorAll('#runs-table tbody tr')];
const shown = () => rows.filter((row) => !row.hidden).length;
const points = () => document.querySelectorAll('figure.chart [data-r] path:not(.off)').length;
const status = () => document.getElementById('shown').textContent;
const type = (id, value) => {
  const field = document.getElementById(id);
  field.value = value;
  field.dispatchEvent(new Event('input', {bubbles: true}));
};
const out = [[shown(), points(), status()]];
type('state', 'failed'); out.push([shown(), points(), status()]);
type('words', 'RUN-0100 capture'); out.push([shown(), points(), status()]);
document.querySelector('.controls button[type=reset]').click();
await new Promise((done) => setTimeout(done, 50));
out.push([shown(), points(), status()]);
return out;
"""


@needs_browser
def test_it_filters_rows_and_points_and_says_how_many(page_of_many, tmp_path) -> None:
    said, console = evaluate(page_of_many, FILTER, tmp_path)
    assert console == []
    charts = 4  # a run has one path in each: mean rates, drift, noise, temperature
    everything = [1000, 1000 * charts, "1000 of 1000 runs shown"]
    assert said == [
        [*everything[:2], "first 200 of 1000 runs shown"],
        [50, 50 * charts, "50 of 1000 runs shown"],
        [1, charts, "1 of 1000 runs shown"],
        everything,
    ]


LONG = """
const rows = [...document.querySelectorAll('#runs-table tbody tr')];
const laid_out = () => rows.filter((row) => row.offsetHeight > 0).length;
const before = laid_out();
document.querySelector('.controls button[type=reset]').click();
await new Promise((done) => setTimeout(done, 50));
return [before, laid_out()];
"""


@needs_browser
def test_a_long_table_begins_with_its_first_rows(page_of_many, tmp_path) -> None:
    said, console = evaluate(page_of_many, LONG, tmp_path)
    assert console == []
    assert said == [200, 1000]


WHOLE = """
document.body.style.width = '1385px';
const table = document.getElementById('runs-table');
return [table.offsetWidth, table.parentElement.clientWidth];
"""


@needs_browser
def test_the_table_of_runs_is_whole_on_a_screen_of_1400_pixels(page_of_many, page_of_lab, tmp_path) -> None:
    """A scroll bar takes 15 of them."""
    for page in (page_of_many, page_of_lab):
        (table, room), _ = evaluate(page, WHOLE, tmp_path)
        assert table <= room


REACH = """
const fields = [...document.querySelectorAll('a[href], button, input, select, summary, [tabindex="0"]')]
  .filter((field) => field.offsetParent !== null);
const name = (field) => field.getAttribute('aria-label') || field.textContent.trim() ||
  (field.labels && field.labels[0] && field.labels[0].textContent);
const nameless = fields.filter((field) => !name(field)).map((field) => field.outerHTML.slice(0, 80));
return {nameless,
  loaded: performance.getEntriesByType('resource').map((entry) => entry.name), title: document.title};
"""


@needs_browser
def test_all_that_can_be_reached_has_a_name_and_nothing_is_fetched(page_of_lab, tmp_path) -> None:
    said, console = evaluate(page_of_lab, REACH, tmp_path)
    assert console == []
    assert said["nameless"] == []
    assert ":focus-visible{outline:3px solid" in page_of_lab.read_text()
    assert [name for name in said["loaded"] if not name.startswith("data:")] == []
    assert said["title"] == "c1 · All campaigns"


@needs_browser
def test_its_own_policy_lets_its_own_script_run_and_no_other(page_of_lab, tmp_path) -> None:
    out, console = chromium(tmp_path, "--dump-dom", page_of_lab.as_uri())
    assert console == []
    assert "3 of 3 runs shown" in out
    spoilt = tmp_path / "spoilt.html"
    spoilt.write_text(
        page_of_lab.read_text().replace("</main>", "<script>document.title = 'caught'</script></main>")
    )
    out, console = chromium(tmp_path, "--dump-dom", spoilt.as_uri())
    assert "caught</title>" not in out
    assert "Content Security Policy" in " ".join(console)


@needs_browser
def test_time_until_a_page_of_a_thousand_runs_is_usable_is_told(page_of_many, tmp_path) -> None:
    """Told, not asserted: it is the machine's and its other users' too."""
    milliseconds, elements = usable_ms(page_of_many, tmp_path)
    print(f"usable after {milliseconds:.0f} ms, {elements} elements")
    assert elements > 1000 * 13  # the table has a row of thirteen cells a run
