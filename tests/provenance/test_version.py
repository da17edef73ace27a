"""The version id: the same for the same, another for anything else that a number could come from."""

from __future__ import annotations

import csv
import hashlib
import json
import shutil
from pathlib import Path

import pytest

from fogreduce.cli.main import main
from fogreduce.provenance.code import code_digest, reduction_parts
from fogreduce.provenance.digest import data_digest, file_digest


def manifest(run: Path, calibrations: Path, out: Path, parameters: dict | None = None) -> dict:
    told = ["--calibrations", str(calibrations), "--parameters", json.dumps(parameters or {})]
    assert main(["manifest", str(run), "--out", str(out), *told]) == 0
    return json.loads((out / "manifest.json").read_text())


@pytest.fixture
def run(bench) -> Path:
    here = bench.campaign / "runs" / "r1"
    here.mkdir(parents=True)
    (here / "temperature.csv").write_text("time_s,electronics_degC,sensor_degC\n0,20,20\n")
    return bench.run("r1", profile=[(3.0, 5.0)], encoder=lambda t: 3.0 * t, temperature="temperature.csv")


def test_digests_are_sha_256(tmp_path) -> None:
    """The three test vectors that everybody knows, and order of keys that does not matter."""
    path = tmp_path / "abc"
    path.write_bytes(b"abc")
    assert file_digest(path) == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    path.write_bytes(b"")
    assert file_digest(path) == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855"
    assert data_digest({"a": 1, "b": 2}) == data_digest({"b": 2, "a": 1})
    assert data_digest({"a": 1}) == hashlib.sha256(b'{"a":1}').hexdigest()


def test_the_same_run_has_the_same_manifest_wherever_it_lies(bench, run, tmp_path) -> None:
    first = manifest(run, bench.calibrations, tmp_path / "a")
    moved = tmp_path / "elsewhere"
    shutil.copytree(bench.root / "campaigns", moved / "campaigns")
    again = manifest(moved / "campaigns" / "made-up" / "runs" / "r1", bench.calibrations, tmp_path / "b")
    assert first == again
    assert (tmp_path / "a" / "manifest.json").read_bytes() == (tmp_path / "b" / "manifest.json").read_bytes()
    assert str(bench.root) not in json.dumps(first)


def test_it_names_every_input_with_its_hash(bench, run, tmp_path) -> None:
    found = manifest(run, bench.calibrations, tmp_path / "a")
    names = {item["name"]: item for item in found["inputs"]}
    assert set(names) == {"run.yaml", "capture.fogcap", "temperature.csv", "table.csv"}
    for name, item in names.items():
        data = (run / name).read_bytes()
        assert (item["bytes"], item["sha256"]) == (len(data), hashlib.sha256(data).hexdigest())
    record = bench.calibrations / "UNIT-4" / "v1.yaml"
    assert found["calibration"] == {
        "id": "UNIT-4@v1",
        "sha256": hashlib.sha256(record.read_bytes()).hexdigest(),
    }
    assert {"fogreduce", "code_sha256", "python", "numpy", "h5py"} <= set(found["software"])


def edit(path: Path, old: str, new: str) -> None:
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))


def flip_a_bit(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[1000] ^= 1
    path.write_bytes(data)


CHANGES = {
    "capture": lambda bench, run: flip_a_bit(run / "capture.fogcap"),
    "run.yaml": lambda bench, run: edit(run / "run.yaml", "-23.21132308", "-23.21132309"),
    "comment in run.yaml": lambda bench, run: (run / "run.yaml").open("a").write("# a word\n"),
    "temperature": lambda bench, run: edit(run / "temperature.csv", "20,20", "20,21"),
    "encoder": lambda bench, run: edit(run / "table.csv", "3.000000000", "3.000000001"),
    "calibration": lambda bench, run: edit(bench.calibrations / "UNIT-4" / "v1.yaml", "0.075", "0.0751"),
}


@pytest.mark.parametrize("change", list(CHANGES))
def test_each_input_changes_it(bench, run, tmp_path, change: str) -> None:
    before = manifest(run, bench.calibrations, tmp_path / "a")["version_id"]
    CHANGES[change](bench, run)
    assert manifest(run, bench.calibrations, tmp_path / "b")["version_id"] != before


@pytest.mark.parametrize(
    "parameters",
    [
        {"block_records": 4096},
        {"outliers": {"threshold_sigma": 7.0}},
        {"unstable": {"threshold": 1.3}},
        {"storage": {"chunk_records": 1000}},
        {"edge_guard_s": 0.25},
        {"alpha_source": "encoder"},
        {"complete_records": False},
    ],
)
def test_each_parameter_changes_it(bench, run, tmp_path, parameters: dict) -> None:
    before = manifest(run, bench.calibrations, tmp_path / "a")["version_id"]
    assert manifest(run, bench.calibrations, tmp_path / "b", parameters)["version_id"] != before


def test_the_code_changes_it(monkeypatch, tmp_path) -> None:
    """On a copy of the package: a statement in any module that numbers come from, and none elsewhere."""
    import fogreduce

    copy = tmp_path / "fogreduce"
    shutil.copytree(Path(fogreduce.__file__).parent, copy, ignore=shutil.ignore_patterns("__pycache__"))
    monkeypatch.setattr(fogreduce, "__file__", str(copy / "__init__.py"))
    before = code_digest()
    for part in reduction_parts():
        path = copy / part
        kept = path.read_bytes()
        path.write_bytes(kept + b"\nA_WORD = 1\n")
        assert code_digest() != before, part
        path.write_bytes(kept + b"\n# a word\n\n\n")
        assert code_digest() == before, part
        path.write_bytes(kept)
    folders = {part.split("/")[0] for part in reduction_parts()}
    assert {"physics", "estimate", "stages", "datasets", "metadata"} <= folders
    (copy / "cli" / "main.py").write_text("")
    assert code_digest() == before


def test_it_stands_in_every_table_and_dataset(bench, run) -> None:
    import h5py

    reduced = bench.reduce(run)
    version = reduced.setup.version_id
    assert len(version) == 16
    for path in (reduced.out / "tables").glob("*.csv"):
        with path.open(newline="") as file:
            assert all(row["version_id"] == version for row in csv.DictReader(file)), path.name
    datasets = list((reduced.out / "datasets").glob("*.nc"))
    assert len(datasets) >= 5
    for path in datasets:
        with h5py.File(path) as file:
            assert file.attrs["version_id"] == version


def test_a_dataset_of_another_version_is_refused(bench, run, capsys) -> None:
    """A stage that finds what another configuration left behind says so, status 2."""
    reduced = bench.reduce_by_stages(run)
    manifest(run, bench.calibrations, reduced.out, {"edge_guard_s": 0.25})
    capsys.readouterr()
    assert main(["stage", "calibrate", "--out", str(reduced.out)]) == 2
    message = capsys.readouterr().err
    assert "ingest.nc" in message
    assert "version_id" in message
