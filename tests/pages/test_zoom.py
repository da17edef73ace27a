"""Plots that zoom: uPlot as it was released, the data in the page, and what buttons, keys and fingers do."""

import hashlib
import json
import re

import html_checks
import numpy as np
import pytest
from browser import chromium, evaluate, needs_browser
from markupsafe import Markup

from fogreduce.pages.style import UPLOT
from fogreduce.pages.svg import Panel
from fogreduce.pages.zoom import Line, lines, runs


def data_of(text):
    """Data of every plot of a page."""
    blocks = re.findall(r'<script type="application/json">(.*?)</script>', text, re.DOTALL)
    return [json.loads(block) for block in blocks]


def test_uplot_is_as_it_was_released() -> None:
    """The hashes that its README has, which are those of the published package's files."""
    said = (UPLOT / "README.md").read_text()
    for name in ("uPlot.iife.min.js", "uPlot.min.css", "LICENSE"):
        digest = hashlib.sha256((UPLOT / name).read_bytes()).hexdigest()
        assert f"{digest}  {name}" in said
    script = (UPLOT / "uPlot.iife.min.js").read_text()
    assert "</script" not in script  # it stands within one
    assert "<!--" not in script


def test_columns_keep_extremes_and_gaps() -> None:
    x = np.arange(4.0)
    mean = np.array([1.0, np.nan, 2.5004, 3.0])
    found = json.loads(lines("time [s]", x, [Line("x [deg/h]", mean, mean - 1, mean + 1, 0.5, "mean 0.5")]))
    assert found["x"] == [0, 1, 2, 3]
    (panel,) = found["panels"]
    assert panel["values"] == [1, None, 2.5, 3]
    assert panel["low"] == [0, None, 1.5, 2]
    assert panel["high"] == [2, None, 3.5, 4]


def test_names_in_the_data_end_no_script() -> None:
    panel = Panel("x", "deg/h", [1.0, None], [0.5, None], limits=[(0.0, 2.0)] * 2, out=frozenset({0}))
    text = runs(["</script><b>", "&amp;"], ["2020-01-01"] * 2, [panel])
    assert isinstance(text, Markup)
    assert not set("<>&") & set(text)
    found = json.loads(text)
    assert found["names"] == ["</script><b>", "&amp;"]
    assert found["panels"][0]["errors"] == [0.5, None]
    assert found["panels"][0]["limits"] == [[0, 0], [2, 2]]
    assert found["panels"][0]["out"] == [0]


@pytest.fixture(scope="module")
def page_of_run(lab):
    return lab.run("r1") / "index.html"


def test_a_runs_plot_has_its_bins_less_the_command(page_of_run) -> None:
    """The mean of what is plotted is the mean rate less commanded of rates.csv, within its noise."""
    overview = json.loads((page_of_run.parent / "reports" / "overview.json").read_text())
    (data,) = data_of(page_of_run.read_text())
    assert [panel["name"] for panel in data["panels"]] == ["x [deg/h]", "y [deg/h]", "z [deg/h]"]
    for panel in data["panels"]:
        there = [value for value in panel["values"] if value is not None]
        entry = overview["offset"][panel["name"][0]]
        assert len(there) > 60
        assert np.mean(there) == pytest.approx(entry["value"], abs=5 * entry["error"])


def test_without_scripts_the_drawn_figures_are_the_page(page_of_run) -> None:
    page = html_checks.check(page_of_run.read_text(), scripts=1)
    assert all("hidden" in attrs for attrs in page.all("div") if attrs.get("class") == "zoom")
    assert page.all("svg")[0]["aria-label"].startswith("Rate less the commanded one")


ZOOM = """
const box = document.querySelector('.zoom'), button = box.querySelector('button');
const wait = () => new Promise((done) => setTimeout(done, 60));
const said = () => box.querySelector('[role=status]').textContent.trim();
const before = box.querySelectorAll('canvas').length;
button.click(); await wait();
const tools = [...box.querySelectorAll('p button')];
const out = [before, box.querySelectorAll('canvas').length, tools.map((b) => b.getAttribute('aria-label'))];
tools[0].click(); await wait(); out.push(said());
const plots = box.querySelector('.plots');
plots.dispatchEvent(new KeyboardEvent('keydown', {key: 'ArrowRight'})); await wait(); out.push(said());
plots.dispatchEvent(new KeyboardEvent('keydown', {key: '0'})); await wait(); out.push(said());
const at = (x) => new Touch({identifier: x, target: plots, clientX: x, clientY: 600});
const touch = (kind, a, b) => plots.dispatchEvent(
  new TouchEvent(kind, {touches: [at(a), at(b)], cancelable: true, bubbles: true}));
touch('touchstart', 500, 600); touch('touchmove', 400, 700); await wait(); out.push(said());
button.click();
out.push(plots.hidden, button.getAttribute('aria-expanded'));
return out;
"""


def ends(said):
    return [float(number) for number in re.fullmatch(r"time \[s\]: ([0-9.]+) to ([0-9.]+)", said).groups()]


@needs_browser
def test_it_zooms_by_buttons_keys_and_two_fingers(page_of_run, tmp_path) -> None:
    said, console = evaluate(page_of_run, ZOOM, tmp_path)
    assert console == []
    none, canvases, names, nearer, later, whole, pinched, hidden, expanded = said
    assert (none, canvases) == (0, 3)
    assert names == ["Zoom in", "Zoom out", "Earlier", "Later", "Show the whole range"]
    low, high = ends(nearer)
    assert high - low == pytest.approx(35.0, rel=0.02)  # half of 70 s
    moved = ends(later)
    assert moved[0] > low + 10
    assert whole == "whole range"
    low, high = ends(pinched)
    assert high - low == pytest.approx(70.0 / 3.0, rel=0.02)  # fingers three times as far apart
    assert (hidden, expanded) == (True, "false")


@needs_browser
def test_its_own_policy_lets_it_run(page_of_run, tmp_path) -> None:
    """The page as it is, not a copy with another policy: the button that the script adds is there."""
    out, console = chromium(tmp_path, "--dump-dom", page_of_run.as_uri())
    assert console == []
    assert re.search(r'<button type="button"[^>]*>Zoom</button>', out)
