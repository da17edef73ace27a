"""Faults between the stages: what a node of the workflow finds missing, stale or broken."""

import json

import h5py
from fault_case import Case

from fogreduce.cli.main import main


def _after(*names: str):
    """Decorates a function of the laboratory: the manifest and the named stages are made first."""

    def decorate(spoil):
        def spoilt(lab):
            assert main(lab.manifest()) == 0
            for name in names:
                assert main(lab.stage(name, run=name in ("ingest", "remove_earth"))) == 0
            return spoil(lab)

        return spoilt

    return decorate


def _dataset(lab, stage):
    return lab.out / "datasets" / f"{stage}.nc"


@_after()
def _no_upstream(lab):
    return lab.stage("calibrate")


@_after("ingest")
def _other_version(lab):
    assert main([*lab.manifest(), "--parameters", '{"edge_guard_s": 1.0}']) == 0
    return lab.stage("calibrate")


@_after("ingest")
def _truncated(lab):
    path = _dataset(lab, "ingest")
    path.write_bytes(path.read_bytes()[:-100])
    return lab.stage("calibrate")


@_after("ingest")
def _not_hdf5(lab):
    _dataset(lab, "ingest").write_text("time,volts\n")
    return lab.stage("calibrate")


@_after("ingest")
def _folder(lab):
    _dataset(lab, "ingest").unlink()
    _dataset(lab, "ingest").mkdir()
    return lab.stage("calibrate")


@_after("ingest", "calibrate")
def _variable_missing(lab):
    with h5py.File(_dataset(lab, "calibrate"), "a") as file:
        del file["gyro_rate"]
    return lab.stage("project")


@_after("ingest")
def _no_rates(lab):
    return lab.stage("fit")


@_after()
def _no_fit(lab):
    return lab.stage("drift")


@_after("ingest", "calibrate", "project", "remove_earth", "fit")
def _fit_of_other_version(lab):
    path = lab.out / "reports" / "fit.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {"version_id": "0123456789abcdef"}))
    return lab.stage("drift")


@_after("ingest", "calibrate", "project", "remove_earth", "fit")
def _fit_broken(lab):
    path = lab.out / "reports" / "fit.json"
    path.write_text(path.read_text()[:40])
    return lab.stage("drift")


@_after()
def _no_run(lab):
    return lab.stage("ingest")


@_after()
def _capture_changed(lab):
    lab.capture.write_bytes(lab.capture.read_bytes()[:-28])
    return lab.stage("ingest", run=True)


@_after()
def _capture_gone(lab):
    lab.capture.unlink()
    return lab.stage("ingest", run=True)


def _manifest(text):
    def spoil(lab):
        lab.out.mkdir()
        (lab.out / "manifest.json").write_text(text)
        return lab.stage("calibrate")

    return spoil


STAGES = [
    Case(
        "no manifest",
        lambda lab: lab.stage("calibrate"),
        "$out/manifest.json: found no such file; expected the run's manifest",
    ),
    Case(
        "manifest: not JSON",
        _manifest("{"),
        "$out/manifest.json: found Expecting property name enclosed in double quotes: "
        "line 1 column 2 (char 1); "
        "expected the run's manifest",
    ),
    Case(
        "manifest: a list",
        _manifest("[]"),
        "$out/manifest.json: found list; expected the run's manifest",
    ),
    Case(
        "manifest: of something else",
        _manifest('{"schema": "a/1"}'),
        "$out/manifest.json: schema: found a/1; expected fogreduce/manifest/1",
    ),
    Case(
        "upstream missing",
        _no_upstream,
        "$out/datasets/ingest.nc: found no such file; expected the dataset of stage ingest",
    ),
    Case(
        "upstream of another version",
        _other_version,
        "$out/datasets/ingest.nc: version_id: found $stale; expected $version, as the manifest has it",
    ),
    Case(
        "upstream truncated",
        _truncated,
        "$out/datasets/ingest.nc: found a truncated file; expected the dataset of stage ingest",
    ),
    Case(
        "upstream not HDF5",
        _not_hdf5,
        "$out/datasets/ingest.nc: found a file that is not HDF5; expected the dataset of stage ingest",
    ),
    Case(
        "a folder in upstream's place",
        _folder,
        "$out/datasets/ingest.nc: found a folder; expected the dataset of stage ingest",
    ),
    Case(
        "upstream without its variable",
        _variable_missing,
        "$out/datasets/calibrate.nc: gyro_rate: found no such variable; expected one, as its stage writes it",
    ),
    Case(
        "second upstream missing",
        _no_rates,
        "$out/datasets/remove_earth.nc: found no such file; expected the dataset of stage remove_earth",
    ),
    Case(
        "no fit",
        _no_fit,
        "$out/reports/fit.json: found no such file; expected the report of an earlier stage",
    ),
    Case(
        "fit of another version",
        _fit_of_other_version,
        "$out/reports/fit.json: version_id: found 0123456789abcdef; "
        "expected $version, as the manifest has it",
    ),
    Case(
        "fit broken",
        _fit_broken,
        "$out/reports/fit.json: found Unterminated string starting at: line 3 column 2 (char 38); "
        "expected the report of an earlier stage",
    ),
    Case("ingest without its run", _no_run, "--run: found nothing; expected the run's folder"),
    Case(
        "capture changed since the manifest",
        _capture_changed,
        "$capture: found 26916 bytes; expected 26944, as the manifest has it",
    ),
    Case(
        "capture gone since the manifest",
        _capture_gone,
        "$capture: found No such file or directory; expected a readable capture file",
    ),
]
