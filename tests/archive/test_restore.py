"""A bag becomes a working folder again, and what is redone there is held against the bag."""

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import pytest
from archived_lab import CAMPAIGN, RUNS, sha256_of
from small_unit import call, succeed

from fogreduce.metadata.yaml12 import load_yaml
from fogreduce.provenance.cell import standard_uncertainty
from fogreduce.provenance.compare import compare_run, distance_of


@pytest.fixture(scope="module", autouse=True)
def one_code(archived):
    """All reductions of this file name the archived code."""
    with archived.one_code():
        yield


@pytest.fixture(scope="module")
def restored(archived, tmp_path_factory):
    """The bag, restored; not to be changed by a test."""
    out = tmp_path_factory.mktemp("restored") / "lab"
    succeed("restore", archived.bag, "--out", out, "--expect", archived.digest)
    return out


def test_every_file_comes_back_as_it_was(archived, restored):
    for run_id in RUNS:
        for name in ("run.yaml", "capture.fogcap"):
            path = Path("campaigns") / CAMPAIGN / "runs" / run_id / name
            assert sha256_of(restored / path) == sha256_of(archived.root / path)
        table = Path(CAMPAIGN) / run_id / "tables" / "drift.csv"
        assert sha256_of(restored / "archived" / table) == sha256_of(archived.results / table)
    for name in ("Snakefile", "requirements.lock", "pyproject.toml", "workflow/rules/reduction.smk"):
        assert sha256_of(restored / name) == sha256_of(archived.source / name)
    assert not (restored / "results").exists()


def test_redone_by_the_restored_software_the_tables_are_the_same_bytes(archived, restored, tmp_path):
    """In a process of its own, whose fogreduce is the restored one."""
    results = tmp_path / "results"
    for run_id in RUNS:
        code = "import sys; from fogreduce.cli.main import main; sys.exit(main(sys.argv[1:]))"
        command = [sys.executable, "-c", code, "reduce", f"campaigns/{CAMPAIGN}/runs/{run_id}"]
        command += ["--calibrations", "calibrations", "--out", str(results / CAMPAIGN / run_id)]
        environment = {**os.environ, "PYTHONPATH": str(restored), "OPENBLAS_NUM_THREADS": "1"}
        subprocess.run(command, cwd=restored, env=environment, check=True)
    out = succeed("restore", archived.bag, "--compare", results)
    for run_id in RUNS:
        assert re.search(
            rf"^{CAMPAIGN}/{run_id}: 11 tables, byte for byte .*; datasets equal$", out, re.MULTILINE
        )


@pytest.mark.slow
def test_redone_by_snakemake_the_tables_are_the_same_bytes(archived, restored, tmp_path):
    lab = Path(shutil.copytree(restored, tmp_path / "lab"))
    snakemake = Path(sys.executable).with_name("snakemake")
    environment = {**os.environ, "PYTHONPATH": str(lab), "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(
        [snakemake, "--cores", "1", "--config", 'figures={"enabled": false}'],
        cwd=lab,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-3000:]
    out = succeed("restore", archived.bag, "--compare", lab / "results")
    assert out.count("byte for byte") == len(RUNS)
    assert out.count("datasets equal") == len(RUNS)


def test_a_bag_with_a_fault_is_not_restored(bag, tmp_path):
    capture = bag / "data/campaigns" / CAMPAIGN / "runs/r1/capture.fogcap"
    capture.write_bytes(capture.read_bytes()[:-1])
    status, out, err = call("restore", bag, "--out", tmp_path / "lab")
    assert status == 2
    assert str(capture) in err
    assert out == ""
    assert [path.name for path in tmp_path.iterdir()] == ["bag"]


def test_another_bag_than_expected_is_not_restored(archived, tmp_path):
    status, _, err = call("restore", archived.bag, "--out", tmp_path / "lab", "--expect", "0" * 64)
    assert status == 2
    assert "tagmanifest-sha256.txt" in err
    assert not list(tmp_path.iterdir())


def test_nothing_is_written_over(archived, tmp_path):
    (tmp_path / "lab").mkdir()
    status, _, err = call("restore", archived.bag, "--out", tmp_path / "lab")
    assert status == 2
    assert "something there already" in err


def test_parameters_other_than_the_defaults_come_back(archived, tmp_path):
    lab = tmp_path / "results"
    shutil.copytree(archived.results, lab)
    for run_id in RUNS:
        run = archived.campaigns / CAMPAIGN / "runs" / run_id
        out = lab / CAMPAIGN / run_id
        places = ["--calibrations", archived.calibrations, "--out", out]
        succeed("reduce", run, *places, "--parameters", '{"edge_guard_s": 2.5}')
        succeed("checksums", out)
    places = ["--campaigns", archived.campaigns, "--calibrations", archived.calibrations]
    places += ["--source", archived.source]
    succeed("archive", lab, *places, "--out", tmp_path / "bags")
    succeed("restore", tmp_path / "bags" / CAMPAIGN, "--out", tmp_path / "lab")
    settings = load_yaml(tmp_path / "lab" / "workflow" / "config.yaml")
    assert settings["reduction"]["edge_guard_s"] == 2.5
    kept = tmp_path / "bags" / CAMPAIGN / "data" / "results" / CAMPAIGN / "r1" / "versions"
    assert [path.name[:2] for path in kept.iterdir()] == ["1-"]


def drift(archived):
    """The drift of x in the first segment, as it stands, and its standard uncertainty."""
    lines = (archived.results / CAMPAIGN / "r1" / "tables" / "drift.csv").read_text().splitlines()
    fields = dict(zip(lines[0].split(","), lines[1].split(","), strict=True))
    return fields["drift_deg_h"], float(fields["drift_err_deg_h"])


def changed(archived, tmp_path, name, change):
    """A copy of a run's results with one table's text changed."""
    new = tmp_path / "new"
    shutil.copytree(archived.results / CAMPAIGN / "r1", new)
    table = new / "tables" / name
    table.write_text(change(table.read_text()))
    return compare_run(archived.results / CAMPAIGN / "r1", new)


def test_a_last_digit_is_within_the_tolerance(archived, tmp_path):
    old, error = drift(archived)
    near = f"{float(old) + 1e-7 * error:.15g}"
    found = changed(archived, tmp_path, "drift.csv", lambda text: text.replace(old, near))
    assert found.differing == ("drift.csv",)
    assert found.faults == ()
    assert 0.5e-7 < found.worst < 2e-7


def test_more_than_that_is_a_fault_that_names_the_cell(archived, tmp_path):
    old, error = drift(archived)
    far = f"{float(old) + 1e-5 * error:.15g}"
    found = changed(archived, tmp_path, "drift.csv", lambda text: text.replace(old, far))
    assert [fault.where for fault in found.faults] == ["x@1:drift_deg_h"]
    assert found.faults[0].file.endswith("new/tables/drift.csv")


def test_a_count_that_differs_is_a_fault(archived, tmp_path):
    found = changed(archived, tmp_path, "quality.csv", lambda text: text.replace("1120", "1121", 1))
    assert [fault.where for fault in found.faults] == ["records:count"]


def test_a_row_that_is_missing_is_a_fault(archived, tmp_path):
    found = changed(archived, tmp_path, "drift.csv", lambda text: text[: text.rindex("z,")])
    assert [fault.found for fault in found.faults] == ["other rows or columns"]


def test_a_dataset_that_differs_in_one_value_is_named(archived, tmp_path):
    new = tmp_path / "new"
    shutil.copytree(archived.results / CAMPAIGN / "r1", new)
    with h5py.File(new / "datasets" / "project.nc", "r+") as file:
        file["axis_rate"][1, 500] += 1e-12
    found = compare_run(archived.results / CAMPAIGN / "r1", new)
    assert found.datasets == "project.nc: values of axis_rate differ"
    with h5py.File(new / "datasets" / "project.nc", "r+") as file:
        file.attrs["comment"] = "only this differs"
        file["axis_rate"][1, 500] = h5py.File(archived.results / CAMPAIGN / "r1/datasets/project.nc")[
            "axis_rate"
        ][1, 500]
    assert compare_run(archived.results / CAMPAIGN / "r1", new).datasets == "equal"


def test_results_of_a_run_that_are_missing(archived, tmp_path):
    shutil.copytree(archived.results / CAMPAIGN / "r1", tmp_path / "results" / CAMPAIGN / "r1")
    status, _, err = call("restore", archived.bag, "--compare", tmp_path / "results")
    assert status == 2
    assert "r2" in err


def test_distances():
    assert distance_of("1.0", "1.5", 0.25) == 2.0
    assert distance_of("x", "y", None) == float("inf")
    assert distance_of("", "1", 0.25) == float("inf")
    assert distance_of("100", "101", None) > 1e-6
    assert distance_of("1", "1.0000000001", None) < 1e-6
    assert distance_of("0", "0.0", None) == float("inf")


def test_a_cell_is_measured_by_its_noise_and_not_by_a_part_that_is_zero_but_for_rounding():
    fields = {"axis": "x", "e_deg_s2": "1e-8", "e_err_deg_s2": "2e-9", "e_err_coloured_deg_s2": "5e-9"}
    fields |= {"e_err_stated_deg_s2": "3e-24", "c_rad_s": "0.1"}
    for column in ("e_deg_s2", "e_err_deg_s2", "e_err_stated_deg_s2", "e_err_coloured_deg_s2"):
        assert standard_uncertainty(column, fields) == 2e-9
    assert standard_uncertainty("c_rad_s", fields) is None
    drift = {"drift_deg_h": "1", "drift_err_deg_h": "0.5", "drift_err_stated_deg_h": "0.1"}
    drift |= {"accumulated_error_deg": "1", "accumulated_err_deg": "0.25"}
    assert standard_uncertainty("drift_deg_h", drift) == 0.5
    assert standard_uncertainty("accumulated_error_deg", drift) == 0.25


@pytest.mark.slow
def test_another_kind_of_processor(archived, tmp_path):
    """Another BLAS kernel and none of numpy's dispatched loops: within the tolerance, and it is said."""
    from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

    environment = {
        **os.environ,
        "PYTHONPATH": str(archived.source),
        "OPENBLAS_CORETYPE": "Nehalem",
        "NPY_DISABLE_CPU_FEATURES": " ".join(name for name in __cpu_dispatch__ if __cpu_features__[name]),
    }
    code = "import sys; from fogreduce.cli.main import main; sys.exit(main(sys.argv[1:]))"
    for run_id in RUNS:
        out = tmp_path / CAMPAIGN / run_id
        run = archived.campaigns / CAMPAIGN / "runs" / run_id
        for command in (
            ["reduce", run, "--calibrations", archived.calibrations, "--out", out],
            ["checksums", out],
        ):
            subprocess.run([sys.executable, "-c", code, *map(str, command)], env=environment, check=True)
    said = succeed("restore", archived.bag, "--compare", tmp_path)
    assert "cpu_features: without" in said
