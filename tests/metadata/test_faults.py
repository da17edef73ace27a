"""The table of faulty metadata: one line each, with file, key, what was found and expected."""

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from fogreduce.errors import BadInput
from fogreduce.metadata.curves import Curves
from fogreduce.metadata.folder import cross_check, load_calibration, load_campaign, load_run

# file, text replaced, by what; then: key (or line), part of what was found, part of what was expected
FAULTS = [
    (
        "run",
        "latitude_deg: -23.21132308",
        "latitude_deg: .nan",
        "site.latitude_deg",
        "nan",
        "a finite number",
    ),
    (
        "run",
        "latitude_deg: -23.21132308",
        "latitude_deg: .inf",
        "site.latitude_deg",
        "inf",
        "a finite number",
    ),
    ("run", "latitude_deg: -23.21132308", "latitude_deg: 90.5", "site.latitude_deg", "90.5", "at most 90"),
    ("run", "latitude_deg: -23.21132308", "latitude_deg: '12'", "site.latitude_deg", "text '12'", "a number"),
    ("run", "latitude_deg: -23.21132308", "latitude_deg: true", "site.latitude_deg", "true", "a number"),
    ("run", "latitude_deg: -23.21132308", "latitude_deg: 1e999", "site.latitude_deg", "inf", "finite number"),
    ("run", "latitude_deg: -23.21132308", "name: here", "site.latitude_deg", "nothing", "north positive"),
    ("run", "site: {latitude_deg: -23.21132308}", "site: 5", "site", "5", "a mapping"),
    ("run", "unit: TETRA-01", "unit: TETRA-01\nfoo: 1", "foo", "an unknown key", "one of schema, run_id"),
    ("run", "sample_rate_hz", "sample_rate", "capture.sample_rate", "did you mean sample_rate_hz?", "one of"),
    ("run", "- {rate_deg_s", "- {rate", "table.profile[0].rate", "did you mean rate_deg_s?", "one of"),
    (
        "run",
        "schema: fogreduce/run/1",
        "schema: fogreduce/run/2",
        "schema",
        "fogreduce/run/2",
        "fogreduce/run/1",
    ),
    ("run", "schema: fogreduce/run/1\n", "", "schema", "nothing", "format of this file"),
    ("run", "run_id: r1", "run_id: r2", "run_id", "'r2'", "r1, the folder's name"),
    ("run", "run_id: r1", "run_id: 12", "run_id", "12", "text (quote it"),
    ("run", "unit: TETRA-01", "unit: ../TETRA", "unit", "'../TETRA'", "a name of 1 to 64"),
    ("run", "2014-05-12T13:00:00Z", "2014-05-12T13:00:00", "started_at", "13:00:00'", "a time with its zone"),
    ("run", "2014-05-12T13:00:00Z", "2014-02-30T13:00:00Z", "started_at", "02-30", "a time with its zone"),
    (
        "run",
        "2014-05-12T13:00:00Z",
        "2014-05-12T13:00:00.1234567Z",
        "started_at",
        ".1234567Z",
        "microseconds",
    ),
    ("run", "2014-05-12T13:00:00Z", "2014-05-12", "started_at", "'2014-05-12'", "a time with its zone"),
    (
        "run",
        "2014-05-12T13:00:00Z",
        "2011-05-12T13:00:00Z",
        "started_at",
        "2011",
        "from 2012-06-01T00:00:00Z until",
    ),
    (
        "run",
        "2014-05-12T13:00:00Z",
        "2016-05-12T13:00:00Z",
        "started_at",
        "2016",
        "until 2015-06-01T00:00:00Z",
    ),
    ("run", "axis: x", "axis: w", "table.axis", "'w'", "x, y, z or three numbers"),
    ("run", "axis: x", "axis: [0, 0, 0]", "table.axis", "a list of 3", "a vector with a direction"),
    ("run", "axis: x", "axis: [1, 0]", "table.axis[2]", "nothing", "one entry more"),
    ("run", "axis: x", "axis: [1, .nan, 0]", "table.axis[1]", "nan", "a finite number"),
    ("run", "duration_s: 6000", "duration_s: -1", "table.profile[0].duration_s", "-1", "more than 0"),
    ("run", "duration_s: 6000", "duration_s: 0", "table.profile[0].duration_s", "0", "more than 0"),
    (
        "run",
        "\n    - {rate_deg_s: 0.06, duration_s: 6000}",
        " []",
        "table.profile",
        "0 entries",
        "at least 1",
    ),
    ("run", "{x: up, z: north}", "{x: up, z: down}", "orientation", "up and down", "right angles"),
    ("run", "{x: up, z: north}", "{x: up}", "orientation", "1 entries", "at least 2"),
    ("run", "{x: up, z: north}", "{x: up, y: east, z: north}", "orientation", "3 entries", "at most 2"),
    ("run", "{x: up, z: north}", "{x: up, z: left}", "orientation.z", "'left'", "up, down, north"),
    ("run", "{x: up, z: north}", "{x: up, w: north}", "orientation.w", "the key w", "x, y or z"),
    ("run", "frame_signs: [1, 1, 1]", "frame_signs: [1, 1, 2]", "frame_signs[2]", "2", "1 or -1"),
    ("run", "frame_signs: [1, 1, 1]", "frame_signs: [1, 1, 1, 1]", "frame_signs", "4 entries", "at most 3"),
    (
        "run",
        "sample_rate_hz: 128",
        "sample_rate_hz: 10001",
        "capture.sample_rate_hz",
        "10001",
        "at most 10000",
    ),
    (
        "run",
        "sample_rate_hz: 128",
        "sample_rate_hz: 0.001",
        "capture.sample_rate_hz",
        "0.001",
        "at least 0.01",
    ),
    ("run", "volts_per_count: 1e-07", "volts_per_count: 0", "capture.volts_per_count", "0", "more than 0"),
    ("run", "[1, -1, 1, 1]", "[1, 0, 1, 1]", "capture.polarity[1]", "0", "1 or -1"),
    ("run", "[1, -1, 1, 1]", "[1, true, 1, 1]", "capture.polarity[1]", "true", "1 or -1"),
    ("run", "[1, -1, 1, 1]", "[1, -1, 1]", "capture.polarity", "3 signs", "4, one a gyro of TETRA-01@2012a"),
    (
        "run",
        "file: capture.fogcap",
        "file: ../capture.fogcap",
        "capture.file",
        "'../cap",
        "a plain file name",
    ),
    (
        "run",
        "file: capture.fogcap",
        "file: /etc/passwd",
        "capture.file",
        "'/etc/passwd'",
        "a plain file name",
    ),
    ("run", "file: capture.fogcap", "file: ..", "capture.file", "'..'", "a plain file name"),
    (
        "run",
        "file: capture.fogcap",
        "file: absent.fogcap",
        "capture.file",
        "absent.fogcap",
        "run's own folder",
    ),
    (
        "run",
        "temperature: temperature.csv",
        "temperature: logs/t.csv",
        "temperature",
        "'logs/t.csv'",
        "no path",
    ),
    (
        "run",
        "temperature: temperature.csv",
        "table_log: t.csv",
        "table_log",
        "t.csv",
        "a file in the run's own folder",
    ),
    ("run", "calibration: TETRA-01@2012a", "calibration: TETRA-01", "calibration", "'TETRA-01'", "@"),
    ("run", "unit: TETRA-01", "unit: TETRA-02", "unit", "TETRA-02", "TETRA-01, the unit of calibration"),
    (
        "run",
        "run_id: r1",
        "run_id: !!python/name:os.system r1",
        "line 2, column 9",
        "the tag",
        "without a tag",
    ),
    ("run", "run_id: r1", "run_id: !!str r1", "line 2, column 9", "the tag", "without a tag"),
    ("run", "run_id: r1", "run_id: &a r1", "line 2, column 9", "the anchor &a", "without an anchor"),
    ("run", "run_id: r1", "run_id: *a", "line 2, column 9", "the alias *a", "written out"),
    ("run", "unit: TETRA-01", "unit: A\nunit: B", "line 4, column 1", "the key unit a second time", "once"),
    ("run", "run_id: r1", "run_id: [r1", "line 3, column 5", "", "YAML 1.2"),
    ("run", "unit: TETRA-01", "unit: TETRA-01\n---", "line 4, column 1", "a second document", "one document"),
    ("run", "run_id: r1", "1: r1", "line 2, column 1", "1 as a key", "text as a key"),
    ("run", "run_id: r1", "run_id: " + "9" * 5000, "line 2, column 9", "of 5000 digits", "a number in use"),
    ("calibration", "H: [[0.29, 0.29, 0.29, 0.5], ", "H: [", "H[2]", "nothing", "one entry more"),
    ("calibration", "[0.0, 0.71, -0.7, 0.0]", "[0.0, 0.71, -0.7]", "H[1]", "3 values", "4, as many as"),
    ("calibration", "[0.0, 0.71, -0.7, 0.0]", "[0.58, 0.58, 0.58, 1.0]", "H", "depend", "a matrix of rank 3"),
    ("calibration", "[0.0, 0.71, -0.7, 0.0]", "[0, 0, 0, 0]", "H", "depend", "a matrix of rank 3"),
    ("calibration", "procedure:", "axes: [[1, 0, 0]]\nprocedure:", "axes", "axes", "H in place of axes"),
    ("calibration", "0.075, 0.09, 0.092, 0.075", "0.1, 0.1", "axes", "nothing", "2 unit vectors"),
    ("calibration", "0.09, 0.092", "0, 0.092", "scale_factor_V_per_deg_s[1]", "0", "other than zero"),
    ("calibration", "[1e-4, 6e-4, 2e-4, -4e-4]", "[1e-4]", "bias_V", "1 values", "4, as many as"),
    ("calibration", "[1e-4, 6e-4, 2e-4, -4e-4]", "[]", "bias_V", "0 entries", "at least 1"),
    ("calibration", "[2e-5, 2e-5", "[-2e-5, 2e-5", "uncertainty.scale_factor_rel[0]", "-2e-05", "at least 0"),
    ("calibration", "2e-5, 2e-5]", "2e-5]", "uncertainty.scale_factor_rel", "3 values", "4, as many as"),
    (
        "calibration",
        "valid_until: 2015",
        "valid_until: 2011",
        "valid_until",
        "2011",
        "an instant after valid_from",
    ),
    ("calibration", "unit: TETRA-01", "unit: OTHER", "unit", "'OTHER'", "TETRA-01, the folder's name"),
    ("calibration", "version: 2012a", "version: 2012b", "version", "'2012b'", "2012a, the file's name"),
    ("calibration", "version: 2012a", "version: 2012", "version", "2012", "text (quote it"),
    ("campaign", "title:", "titel:", "titel", "did you mean title?", "one of schema, title"),
    ("campaign", "title: one run", "title: 5", "title", "5", "text"),
    (
        "campaign",
        "{simulate: {seed: 3}}",
        "{}",
        "captures_from",
        "neither",
        "exactly one of simulate, curves",
    ),
    ("campaign", "{seed: 3}", "{seed: -3}", "captures_from.simulate.seed", "-3", "at least 0"),
    ("campaign", "{seed: 3}", "{seed: 3.5}", "captures_from.simulate.seed", "3.5", "a whole number"),
    (
        "campaign",
        "{simulate: {seed: 3}}",
        "{curves: ../c.yaml}",
        "captures_from.curves",
        "'../c.yaml'",
        "no path",
    ),
    ("curves", "[2e-4, 3e-4]", "[2e-4]", "b_V", "1 values", "2, as many as a_V"),
    ("curves", "end_s: 5800", "end_s: 5600", "unstable[0].end_s", "5600", "more than 5600"),
    ("curves", "gyros: [1, 2]", "gyros: [1, 3]", "unstable[0].gyros", "gyro 3", "one of 2 gyros"),
    ("curves", "fraction: 1e-4", "fraction: 1", "missing_fraction", "1", "less than 1"),
]


def use_everything(lab) -> None:
    """What a reduction would read."""
    load_campaign(lab.campaign)
    Curves.from_yaml(lab.files["curves"])
    run = load_run(lab.run)
    record, _ = load_calibration(lab.calibrations, run.calibration)
    cross_check(run, record, lab.files["run"])


def test_the_unedited_folder_has_no_fault(lab):
    use_everything(lab)


@pytest.mark.parametrize(("kind", "old", "new", "key", "found", "expected"), FAULTS)
def test_fault(lab, kind, old, new, key, found, expected):
    lab.edit(kind, old, new)
    with pytest.raises(BadInput) as error:
        use_everything(lab)
    lines = [str(fault) for fault in error.value.faults if fault.where == key]
    assert len(lines) == 1, str(error.value)
    head, tail = lines[0].split("; expected ")
    assert head.startswith(f"{lab.files[kind]}: {key}: found ")
    assert found in head
    assert expected in tail
    assert "\n" not in lines[0]
    assert "'[key]'" not in lines[0]


@pytest.mark.parametrize("kind", ["run", "calibration", "campaign", "curves"])
@pytest.mark.parametrize(
    ("content", "found"),
    [
        (b"", "an empty file"),
        (b"# only a comment\n", "an empty file"),
        (b"---\n...\n", "an empty document"),
        (b"- 1\n- 2\n", "a list of 2"),
        (b"just text\n", "the text 'just text'"),
        (b"unit: caf\xe9\n", "byte 0xe9, not UTF-8"),
        (b"a: \x00\n", "control characters are not allowed"),
        (b"a: " + b"[" * 200 + b"]" * 200, "nesting deeper than"),
        (b"\tunit: a\n", ""),
    ],
)
def test_content_that_is_not_a_mapping_in_utf8(lab, kind, content, found):
    lab.files[kind].write_bytes(content)
    with pytest.raises(BadInput) as error:
        use_everything(lab)
    (fault,) = error.value.faults
    assert fault.file == str(lab.files[kind])
    assert found in fault.found


@pytest.mark.parametrize("kind", ["run", "calibration", "campaign", "curves"])
def test_a_folder_in_place_of_a_file(lab, kind):
    lab.files[kind].unlink()
    lab.files[kind].mkdir()
    with pytest.raises(BadInput, match="found a folder; expected a YAML file"):
        use_everything(lab)


def test_no_run_yaml(lab):
    lab.files["run"].unlink()
    with pytest.raises(BadInput, match=r"run\.yaml: found no such file; expected a YAML file"):
        load_run(lab.run)


def test_no_run_folder(lab):
    with pytest.raises(BadInput, match="r9: found no such folder; expected a run's folder"):
        load_run(lab.run.parent / "r9")


def test_no_permission(lab):
    with tempfile.TemporaryDirectory() as root, ordinary_user(Path(root)):
        private = type(lab)(Path(root))
        private.files["run"].chmod(0)
        with pytest.raises(
            BadInput, match=r"run\.yaml: found no permission to read it; expected a readable file"
        ):
            load_run(private.run)


@contextlib.contextmanager
def ordinary_user(folder: Path) -> Iterator[None]:
    """Permissions do not bind root: become nobody for a while, in a folder that nobody owns."""
    if os.geteuid() != 0:
        yield
        return
    nobody = 65534
    os.chown(folder, nobody, nobody)
    os.seteuid(nobody)
    try:
        yield
    finally:
        os.seteuid(0)


def test_a_file_far_too_large(lab):
    with lab.files["run"].open("wb") as stream:
        stream.truncate(17 * 1024 * 1024)  # sparse
    with pytest.raises(BadInput, match="found 17825792 bytes"):
        load_run(lab.run)


def test_calibration_that_is_not_there(lab):
    with pytest.raises(
        BadInput, match=r"TETRA-01/2099\.yaml: found no such file; expected the calibration record"
    ):
        load_calibration(lab.calibrations, "TETRA-01@2099")


@pytest.mark.parametrize("record_id", ["", "TETRA-01", "../a@b", "a@b@c", "a@../b", "a@b\n", "@"])
def test_calibration_id_that_is_none(lab, record_id):
    with pytest.raises(BadInput, match="expected <unit>@<version>"):
        load_calibration(lab.calibrations, record_id)


@pytest.mark.parametrize(
    ("key", "name"), [("capture.file", "capture.fogcap"), ("temperature", "temperature.csv")]
)
def test_link_that_leaves_the_folder(lab, tmp_path, key, name):
    outside = tmp_path / name
    outside.write_bytes(b"")
    (lab.run / name).unlink()
    (lab.run / name).symlink_to(outside)
    with pytest.raises(BadInput) as error:
        load_run(lab.run)
    (fault,) = error.value.faults
    assert (fault.where, fault.found) == (key, f"{name}, a link that leaves the folder")


def test_link_within_the_folder_is_fine(lab):
    (lab.run / "capture.fogcap").rename(lab.run / "c2")
    (lab.run / "capture.fogcap").symlink_to("c2")
    load_run(lab.run)


def test_folder_in_place_of_a_capture(lab):
    (lab.run / "capture.fogcap").unlink()
    (lab.run / "capture.fogcap").mkdir()
    with pytest.raises(
        BadInput, match=r"capture\.file: found capture\.fogcap, which is a folder; expected a file"
    ):
        load_run(lab.run, need_capture=False)


def test_all_faults_of_a_file_at_once(lab):
    lab.edit("run", "run_id: r1", "run_id: r2")
    lab.edit("run", "latitude_deg: -23.21132308", "latitude_deg: 91, lattitude: 3")
    lab.edit("run", "[1, -1, 1, 1]", "[1, 0, 0, 1]")
    lab.edit("run", "temperature: temperature.csv", "temperature: absent.csv")
    with pytest.raises(BadInput) as error:
        load_run(lab.run)
    assert {fault.where for fault in error.value.faults} == {
        "run_id",
        "site.latitude_deg",
        "site.lattitude",
        "capture.polarity[1]",
        "capture.polarity[2]",
        "temperature",
    }


def test_all_contradictions_of_a_record_at_once(lab):
    lab.edit("calibration", "[1e-4, 6e-4, 2e-4, -4e-4]", "[1e-4]")
    lab.edit("calibration", "[0.0, 0.71, -0.7, 0.0]", "[0, 0, 0, 0]")
    lab.edit("calibration", "version: 2012a", "version: 2012b")
    with pytest.raises(BadInput) as error:
        load_calibration(lab.calibrations, "TETRA-01@2012a")
    assert {fault.where for fault in error.value.faults} == {"bias_V", "H", "version"}
