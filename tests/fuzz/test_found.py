"""What fuzzing found, each with the smallest input that showed it."""

import io
import json

import h5py
import numpy as np
import pytest
from attempt import attempt
from fuzz_lab import COUNT
from hdf5_mutations import CHANGES, spoilt
from judge import beside_flags
from small_lab import header, records

import fogreduce
from fogreduce.cli.main import main
from fogreduce.errors import BadInput, Fault

READ = [
    ("ingest", "calibrate", ("time", "pulse", "volts", "flag", "gyro_flag")),
    ("calibrate", "project", ("time", "gyro_rate", "flag")),
    ("project", "remove_earth", ("time", "axis_rate", "flag")),
    ("remove_earth", "fit", ("axis_rate",)),
]


@pytest.mark.parametrize(
    ("stage", "after", "names"), READ, ids=lambda value: value if isinstance(value, str) else ""
)
def test_a_dataset_that_is_not_as_written(fuzz_lab, capsys, stage, after, names):
    """A variable gone, of another kind or shape, a group or a link in its place: refused by name."""
    path = fuzz_lab.reduced / "datasets" / f"{stage}.nc"
    for name in names:
        for change in CHANGES:
            path.write_bytes(spoilt(fuzz_lab.good[path], change, name))
            status = main(fuzz_lab.stage(after, run=True))
            said = capsys.readouterr().err
            assert status == 2, (name, change)
            assert said.startswith(f"{path}: "), said
            assert said.count("\n") == 1
    fuzz_lab.mend(path)
    assert main(fuzz_lab.stage(after, run=True)) == 0


def test_a_view_of_a_dataset_that_is_not_as_written(fuzz_lab):
    path = fuzz_lab.reduced / "datasets" / "ingest.nc"
    for change in CHANGES:
        path.write_bytes(spoilt(fuzz_lab.good[path], change, "volts"))
        with pytest.raises(BadInput):
            fogreduce.open_run(fuzz_lab.reduced)
    fuzz_lab.mend(path)
    fogreduce.open_run(fuzz_lab.reduced).close()


@pytest.mark.parametrize(("owner", "key"), [("/", "version_id"), ("time", "units")])
def test_a_view_of_an_attribute_that_is_no_text(fuzz_lab, owner, key):
    path = fuzz_lab.reduced / "datasets" / "ingest.nc"
    held = io.BytesIO(fuzz_lab.good[path])
    with h5py.File(held, "r+") as file:
        del file[owner].attrs[key]
        file[owner].attrs[key] = h5py.Empty("f4")
    path.write_bytes(held.getvalue())
    with pytest.raises(BadInput):
        fogreduce.open_run(fuzz_lab.reduced)
    fuzz_lab.mend(path)


def test_a_manifest_changed_by_hand(fuzz_lab, capsys):
    """Its version id is derived from what it says."""
    path = fuzz_lab.reduced / "manifest.json"
    manifest = json.loads(fuzz_lab.good[path])
    manifest["run"]["site"]["latitude_deg"] = 90.0
    for text in (json.dumps(manifest), "[" * 100_000, "[]", '{"schema": "fogreduce/manifest/1", "run": NaN}'):
        path.write_text(text)
        assert main(fuzz_lab.stage("calibrate")) == 2
        assert capsys.readouterr().err.startswith(f"{path}: ")
    fuzz_lab.mend(path)


@pytest.mark.parametrize("text", ["[]", "[" * 100_000, None])
def test_a_report_that_is_another(fuzz_lab, capsys, text):
    path = fuzz_lab.reduced / "reports" / "fit.json"
    version = json.loads(fuzz_lab.good[path])["version_id"]
    path.write_text(text or json.dumps({"version_id": version}))
    assert main(fuzz_lab.stage("drift")) == 2
    assert capsys.readouterr().err.startswith(f"{path}: found ")
    fuzz_lab.mend(path)


def test_stamps_that_stand_still(fuzz_lab):
    """A capture whose clock stopped at once: no bin is later than the one before."""
    stopped = records(COUNT)
    stopped["time"] = 0
    fuzz_lab.capture.write_bytes(header() + stopped.tobytes())
    before = fuzz_lab.listing()
    outcome = attempt(fuzz_lab.reduce())
    fuzz_lab.mend(fuzz_lab.capture)
    fuzz_lab.tidy(before)
    assert (outcome.status, beside_flags(outcome.err)) == (0, [])


def test_a_byte_lost_within_a_stamp(fuzz_lab):
    """Stamps after it are wrong, some by a million years: one bin so far off that no error can be stated."""
    good = fuzz_lab.good[fuzz_lab.capture]
    fuzz_lab.capture.write_bytes(good[:5901] + good[5902:])
    before = fuzz_lab.listing()
    outcome = attempt(fuzz_lab.reduce())
    fuzz_lab.mend(fuzz_lab.capture)
    fuzz_lab.tidy(before)
    assert (outcome.status, beside_flags(outcome.err)) == (0, [])


def test_a_rate_beyond_all_numbers(fuzz_lab, capsys):
    """A bit of an exponent flipped: its square is infinite."""
    path = fuzz_lab.reduced / "datasets" / "remove_earth.nc"
    held = io.BytesIO(fuzz_lab.good[path])
    with h5py.File(held, "r+") as file:
        file["axis_rate"][0, 5] = 1e300
    path.write_bytes(held.getvalue())
    assert main(fuzz_lab.stage("fit", run=True)) == 2
    assert capsys.readouterr().err.startswith(f"{path}: axis_rate: found a number beyond 1e+100")
    fuzz_lab.mend(path)


def test_an_uncertainty_beyond_all_measure(fuzz_lab, capsys):
    """Its square would be infinite."""
    record = fuzz_lab.record
    good = fuzz_lab.good[record]
    huge = good.replace(b"0.0001", b"1e+308")
    assert huge != good
    record.write_bytes(huge)
    assert main(fuzz_lab.reduce()) == 2
    said = capsys.readouterr().err
    fuzz_lab.mend(record)
    assert "uncertainty.axis_rad[0]: found 1e+308; expected a number, at most 1e+09" in said


def test_an_error_holds_nothing_that_a_terminal_obeys():
    """Names and bytes come from anywhere: a line's end, an escape sequence, half of a surrogate pair."""
    said = str(Fault("a\udc80", "b\n", "\x1b[2J\x00é", "\u2028x"))
    assert said == r"a\udc80: b : found \x1b[2J\x00é; expected x"
    assert said.encode()


@pytest.mark.parametrize("line", ["", "   "])
def test_an_empty_line_in_a_log(fuzz_lab, capsys, line):
    """It is passed over, wherever it stands; a line of commas alone is none."""
    path = fuzz_lab.run / "table.csv"
    path.write_text(f"time_s,angle_deg\n0,0\n{line}\n1,1\n")
    assert main(fuzz_lab.check(fuzz_lab.run)) == 0
    path.write_text("time_s,angle_deg\n0,0\n1,\n")
    capsys.readouterr()
    assert main(fuzz_lab.check(fuzz_lab.run)) == 2
    assert capsys.readouterr().err == f"{path}: line 3: found 1,; expected 2 finite numbers\n"
    fuzz_lab.mend(path)


def test_a_dataset_of_no_records(fuzz_lab, capsys):
    path = fuzz_lab.reduced / "datasets" / "bins.nc"
    held = io.BytesIO(fuzz_lab.good[path])
    with h5py.File(held, "r+") as file:
        for name in [name for name in file if file[name].shape[-1:] == file["time"].shape]:
            shape, dtype = file[name].shape, file[name].dtype
            del file[name]
            file[name] = np.zeros((*shape[:-1], 0), dtype)
    path.write_bytes(held.getvalue())
    assert main(["figures", "--out", str(fuzz_lab.reduced)]) == 2
    assert capsys.readouterr().err.startswith(f"{path}: time: found shape (0,)")
    fuzz_lab.mend(path)
