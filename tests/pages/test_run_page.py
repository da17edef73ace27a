"""The page of a run."""

import csv
import json
import math
import shutil
from pathlib import Path
from xml.etree import ElementTree

import html_checks
import pytest
from pages_lab import RECORD, run_yaml
from small_unit import succeed

from fogreduce.cli.main import main
from fogreduce.metadata.yaml12 import dump_yaml
from fogreduce.pages import run_page as module
from fogreduce.pages.budget_bars import budget_bars
from fogreduce.pages.overview import kept_overview, overview


def test_it_says_what_was_run_with_what_and_what_came_of_it(lab) -> None:
    folder = lab.run("r1")
    page = html_checks.check((folder / "index.html").read_text(), scripts=1)
    manifest = json.loads((folder / "manifest.json").read_text())
    for expected in (
        "TETRA-01@2012a",
        manifest["version_id"],
        manifest["software"]["numpy"],
        manifest["calibration"]["sha256"],
        "2014-05-10 13:00:00 UTC",
        "about x: 10 deg/s for 40 s; 0 deg/s for 30 s",
        "outliers.threshold_sigma",
        "<b>made up</b>",
        "Nothing was flagged",
    ):
        assert expected in page.words
    index = json.loads((folder / "figures" / "index.json").read_text())
    linked = [attrs["href"] for attrs in page.all("a") if attrs["href"].startswith("figures/")]
    # Every figure is in the page or linked; that of counts is left out where nothing was counted.
    assert len(page.all("img")) + len(linked) == len(index["figures"]) - 1
    assert {"figures/rates.svg", "figures/angles.svg"} <= set(linked)
    assert "Numbers of records out of the ordinary" not in page.words
    assert "run.yaml names no table_log" in page.words


def test_names_are_text_and_nothing_else(lab) -> None:
    text = (lab.run("r1") / "index.html").read_text()
    page = html_checks.check(text, scripts=1)
    assert "<script>document.title='caught'</script>" in page.words
    assert "<img src=x" not in text


def test_what_nobody_stated_is_listed_as_assumed(lab) -> None:
    folder = lab.run("r1")
    page = html_checks.check((folder / "index.html").read_text(), scripts=1)
    assumed = json.loads((folder / "manifest.json").read_text())["assumed"]
    assert len(assumed) == 10
    assert "what stands in for it" in page.words
    for item in assumed:
        assert item["key"] in page.words
        assert item["said"] in page.words


def test_its_drift_is_that_of_the_table(lab) -> None:
    folder = lab.run("r1")
    with (folder / "tables" / "drift.csv").open() as file:
        rows = {(row["axis"], row["segment"]): row for row in csv.DictReader(file)}
    drift = overview(folder)["drift"]
    for axis in "xyz":
        assert drift[axis]["value"] == float(rows[axis, "all"]["drift_deg_h"])
        assert drift[axis]["error"] == float(rows[axis, "all"]["drift_err_coloured_deg_h"])


def test_the_bars_are_the_shares_of_the_budget(lab) -> None:
    """Widths of the bars over the whole width are u_part^2 / u_combined^2 of budget.csv."""
    folder = lab.run("r1")
    with (folder / "tables" / "budget.csv").open() as file:
        rows = list(csv.DictReader(file))
    drawn = ElementTree.fromstring(str(budget_bars(rows)))
    names = [text.text for text in drawn.iter("{http://www.w3.org/2000/svg}text")]
    assert [name for name in names if name.startswith(("drift", "mean"))] == [
        f"{quantity} {axis}" for quantity in ("drift", "mean rate") for axis in "xyz"
    ]
    assert "turn-on bias" in names  # in the legend
    row = next(
        row for row in rows if (row["quantity"], row["channel"], row["segment"]) == ("drift", "x", "all")
    )
    share = (float(row["u_noise"]) / float(row["u_combined"])) ** 2
    first = next(drawn.iter("{http://www.w3.org/2000/svg}rect"))
    inner = 960 - (128 + 60) - 190
    assert float(first.get("width")) == pytest.approx(share * inner, abs=0.06)
    assert budget_bars([]) is None
    page = (folder / "index.html").read_text()
    assert "What the uncertainty of each value comes from" in page


def test_offset_is_what_the_mean_rate_lies_beside_the_command(lab) -> None:
    """From the table of the curves by hand: a + e t in the middle, and the sine over whole turns."""
    folder = lab.run("r1")
    with (folder / "tables" / "rate_fit.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["axis"] == "x"]
    # 10 deg/s for 40 s are 400 degrees, so the sine does not average out: its integral by hand.
    total = 0.0
    for row, commanded in zip(rows, (10.0, 0.0), strict=True):
        start, stop = float(row["start_s"]), float(row["stop_s"])
        a, e = float(row["a_deg_s"]), float(row["e_deg_s2"])
        total += (a - commanded) * (stop - start) + e * (stop**2 - start**2) / 2
        if row["b_deg_s"]:
            p, q, c = (float(row[name]) for name in ("p_deg_s", "q_deg_s", "c_rad_s"))
            total += p / c * (math.sin(c * stop) - math.sin(c * start))
            total += q / c * (math.cos(c * start) - math.cos(c * stop))
    found = overview(folder)["offset"]["x"]
    assert found["value"] == pytest.approx(total / 70.0 * 3600.0, abs=1e-6 * found["error"])


def test_the_same_results_give_the_same_bytes(lab) -> None:
    folder = lab.run("r1")
    before = (folder / "index.html").read_bytes(), (folder / "reports" / "overview.json").read_bytes()
    lab.run("r1")
    assert before == (
        (folder / "index.html").read_bytes(),
        (folder / "reports" / "overview.json").read_bytes(),
    )


def test_pictures_beyond_what_a_page_may_hold_are_linked(lab, monkeypatch) -> None:
    monkeypatch.setattr(module, "MOST_PICTURES", 60_000)
    page = html_checks.check(module.run_page(lab.run("r1")), scripts=1)
    assert len(page.all("img")) < 5
    links = [attrs["href"] for attrs in page.all("a") if attrs["href"].startswith("figures/")]
    assert links
    assert all((lab.results / "c1" / "r1" / link).is_file() for link in links)


def test_links_lead_to_files_beside_the_page(lab) -> None:
    folder = lab.run("r1")
    page = html_checks.check((folder / "index.html").read_text(), scripts=1)
    for attrs in page.all("a"):
        if not attrs["href"].startswith(("#", "..")):
            assert (folder / attrs["href"]).is_file(), attrs


def test_without_datasets_the_drift_is_drawn(lab, tmp_path) -> None:
    folder = Path(shutil.copytree(lab.run("r2"), tmp_path / "r2"))
    shutil.rmtree(folder / "figures")
    shutil.rmtree(folder / "datasets")
    page = html_checks.check(module.run_page(folder), scripts=0)
    said = page.all("svg")[0]["aria-label"]
    assert "drift x" in said
    assert "mean rate x" in said


def test_an_overview_of_another_version_is_not_used(lab, tmp_path) -> None:
    folder = Path(shutil.copytree(lab.run("r2"), tmp_path / "r2"))
    path = folder / "reports" / "overview.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "version_id": "0" * 16, "unit": "another"}))
    assert kept_overview(folder)["unit"] == "TETRA-01"


def test_a_run_without_its_tables_is_refused_by_name(lab, tmp_path, capsys) -> None:
    folder = Path(shutil.copytree(lab.run("r2"), tmp_path / "r2"))
    (folder / "tables" / "drift.csv").unlink()
    assert main(["page", "run", str(folder)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "drift.csv: found no such file; expected a table of the reduction" in error


TABLES = ("drift", "rate_fit", "gyro_fit", "quality", "unstable", "encoder")


@pytest.mark.parametrize("name", TABLES)
@pytest.mark.parametrize("header", ["spoilt", "empty"])
def test_a_table_without_its_columns_is_refused_by_name(lab, tmp_path, capsys, name, header) -> None:
    """One line, and neither page nor overview of it."""
    folder = Path(shutil.copytree(lab.run("r2"), tmp_path / "r2"))
    path = folder / "tables" / f"{name}.csv"
    columns, *rows = path.read_text().splitlines()
    first = columns.split(",")[0]
    path.write_text("\n".join([f"x{columns}", *rows]) + "\n" if header == "spoilt" else "")
    for made in ("index.html", "reports/overview.json"):
        (folder / made).unlink(missing_ok=True)
    assert main(["page", "run", str(folder)]) == 2
    found = f"x{columns}"[:80] if header == "spoilt" else "nothing"
    assert capsys.readouterr().err == f"{path}: line 1: found {found}; expected the column {first}\n"
    assert not (folder / "index.html").exists()
    assert not (folder / "reports" / "overview.json").exists()


def test_a_torn_table_and_one_of_no_number_are_refused(lab, tmp_path, capsys) -> None:
    folder = Path(shutil.copytree(lab.run("r2"), tmp_path / "r2"))
    path = folder / "tables" / "drift.csv"
    columns, row, *rows = path.read_text().splitlines()
    path.write_text("\n".join([columns, row[:20]]))
    assert main(["page", "run", str(folder)]) == 2
    assert "drift.csv: line 2: found" in capsys.readouterr().err
    spoilt = row.split(",")
    spoilt[columns.split(",").index("duration_s")] = "long"
    path.write_text("\n".join([columns, ",".join(spoilt), *rows]))
    assert main(["page", "run", str(folder)]) == 2
    assert "drift.csv: line 2: found long; expected duration_s, a number" in capsys.readouterr().err


def test_pages_over_runs_stay_out_of_a_runs_results(lab, tmp_path, capsys) -> None:
    results = Path(shutil.copytree(lab.run("r2").parent, tmp_path / "c1"))
    for of, folder in (("campaign", results / "r2"), ("index", results / "r2"), ("index", results)):
        before = (folder / "index.html").read_bytes() if (folder / "index.html").exists() else None
        assert main(["page", of, str(folder)]) == 2
        assert capsys.readouterr().err.startswith(f"{folder}: found results of a ")
        assert ((folder / "index.html").read_bytes() if before is not None else None) == before


def test_a_unit_of_two_gyros_has_a_page_without_drift(tmp_path) -> None:
    record = {key: value for key, value in RECORD.items() if key != "H"}
    record |= {"axes": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]}
    record |= {key: record[key][:2] for key in ("scale_factor_V_per_deg_s", "bias_V")}
    (tmp_path / "calibrations" / "TETRA-01").mkdir(parents=True)
    (tmp_path / "calibrations" / "TETRA-01" / "2012a.yaml").write_text(dump_yaml(record))
    plan = tmp_path / "plan" / "runs" / "r1"
    plan.mkdir(parents=True)
    described = run_yaml("r1", 10.0)
    described["capture"]["polarity"] = [1, -1]
    (plan / "run.yaml").write_text(dump_yaml(described))
    calibrations, out = ("--calibrations", tmp_path / "calibrations"), tmp_path / "results" / "lab" / "r1"
    succeed("simulate", tmp_path / "plan", *calibrations, "--out", tmp_path / "lab")
    succeed("reduce", tmp_path / "lab" / "runs" / "r1", *calibrations, "--out", out)
    succeed("page", "run", out)
    page = html_checks.check((out / "index.html").read_text(), scripts=0)
    assert "no x, y, z, so no drift" in page.words
    succeed("page", "campaign", out.parent)
    page = html_checks.check((out.parent / "index.html").read_text(), scripts=1)
    assert [attrs["aria-label"][:5] for attrs in page.all("svg")] == ["Mean ", "Noise"]
    succeed("page", "index", out.parent.parent)
    html_checks.check((out.parent.parent / "index.html").read_text(), scripts=1)
