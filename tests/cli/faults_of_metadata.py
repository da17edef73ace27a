"""Faults of run.yaml, campaign.yaml and calibration records, and of the folders that hold them."""

from fault_case import Case
from small_lab import RUN


def _run(changes):
    return lambda lab: lab.write_run(changes)


def _record(changes):
    return lambda lab: lab.write_record(changes)


def _line(old: str, new: str):
    """A line of run.yaml rewritten as text, for what no dump would write."""

    def spoil(lab):
        text = lab.yaml.read_text()
        assert old in text
        lab.yaml.write_text(text.replace(old, new))

    return spoil


def _folder_for_yaml(lab):
    lab.yaml.unlink()
    lab.yaml.mkdir()


def _other_folder(lab):
    lab.run.rename(lab.run.with_name("r2"))
    return ["reduce", str(lab.run.with_name("r2")), *lab.reduce()[2:]]


RUN_YAML = [
    Case("no run.yaml", lambda lab: lab.yaml.unlink(), "$yaml: found no such file; expected a YAML file"),
    Case("a directory in its place", _folder_for_yaml, "$yaml: found a folder; expected a YAML file"),
    Case(
        "empty",
        lambda lab: lab.yaml.write_text(""),
        "$yaml: found an empty file; expected a mapping of keys to values",
    ),
    Case(
        "broken YAML",
        lambda lab: lab.yaml.write_text("schema: [1, 2\nunit: x\n"),
        "$yaml: line 2, column 5: found no ',' or ']'; expected YAML 1.2",
    ),
    Case(
        "a tab in YAML",
        lambda lab: lab.yaml.write_text("site:\n\tlatitude_deg: 1\n"),
        "$yaml: line 2, column 1: found a character that cannot start any token; expected YAML 1.2",
    ),
    Case(
        "not UTF-8",
        lambda lab: lab.yaml.write_bytes(b"schema: fogreduce/run/1\nnotes: caf\xe9\n"),
        "$yaml: line 2: found byte 0xe9, not UTF-8; expected UTF-8 text",
    ),
    Case(
        "a YAML tag",
        _line("unit: TETRA-01", "unit: !!python/object/apply:os.system [true]"),
        "$yaml: line 3, column 7: found the tag tag:yaml.org,2002:python/object/apply:os.system; "
        "expected a value without a tag",
    ),
    Case(
        "an alias",
        _line("unit: TETRA-01", "unit: *there"),
        "$yaml: line 3, column 7: found the alias *there; expected the value itself, written out",
    ),
    Case(
        "a key twice",
        _line("unit: TETRA-01", "unit: TETRA-01\nunit: TETRA-02"),
        "$yaml: line 4, column 1: found the key unit a second time; expected each key once",
    ),
    Case(
        "unknown key",
        _run({"site.latitude": 3.0}),
        "$yaml: site.latitude: found an unknown key (did you mean latitude_deg?); expected one of "
        "latitude_deg, longitude_deg, height_m, name, latitude_uncertainty_deg, magnetic_field_uT",
    ),
    Case(
        "missing key",
        _run({"started_at": None}),
        "$yaml: started_at: found nothing; expected start of the record and of the profile, with zone",
    ),
    Case(
        "latitude NaN",
        _line("latitude_deg: -23.2", "latitude_deg: .nan"),
        "$yaml: site.latitude_deg: found nan; expected a finite number",
    ),
    Case(
        "latitude beyond the pole",
        _run({"site.latitude_deg": -90.5}),
        "$yaml: site.latitude_deg: found -90.5; expected a number, at least -90",
    ),
    Case(
        "text for a number",
        _run({"capture.sample_rate_hz": "16"}),
        "$yaml: capture.sample_rate_hz: found the text '16'; expected a number",
    ),
    Case(
        "sample rate zero",
        _run({"capture.sample_rate_hz": 0.0}),
        "$yaml: capture.sample_rate_hz: found 0.0; expected a number, at least 0.01",
    ),
    Case(
        "duration zero",
        _run({"table.profile": [{"rate_deg_s": 1.0, "duration_s": 0.0}]}),
        "$yaml: table.profile[0].duration_s: found 0.0; expected a number, more than 0",
    ),
    Case(
        "polarity zero",
        _run({"capture.polarity": [1, 0, 1, 1]}),
        "$yaml: capture.polarity[1]: found 0; expected 1 or -1",
    ),
    Case(
        "an axis without a direction",
        _run({"table.axis": [0.0, 0.0, 0.0]}),
        "$yaml: table.axis: found a list of 3; expected a vector with a direction",
    ),
    Case(
        "axes that are not at right angles",
        _run({"orientation": {"x": "up", "z": "down"}}),
        "$yaml: orientation: found up and down; expected two directions at right angles",
    ),
    Case(
        "an instant without a zone",
        _run({"started_at": "2014-05-12T13:00:00"}),
        "$yaml: started_at: found the text '2014-05-12T13:00:00'; "
        "expected a time with its zone, such as 2014-05-12T13:00:00Z (at most microseconds)",
    ),
    Case(
        "a path out of the folder",
        _run({"capture.file": "../r2/capture.fogcap"}),
        "$yaml: capture.file: found the text '../r2/capture.fogcap'; "
        "expected a plain file name in the same folder (no path)",
    ),
    Case(
        "an absolute path",
        _run({"temperature": "/etc/passwd"}),
        "$yaml: temperature: found the text '/etc/passwd'; "
        "expected a plain file name in the same folder (no path)",
    ),
    Case(
        "another folder's run_id",
        _other_folder,
        "$campaign/runs/r2/run.yaml: run_id: found the text 'r1'; expected r2, the folder's name",
    ),
    Case(
        "two faults",
        _run({"unit": "-", "capture": {**RUN["capture"], "volts_per_count": -1.0}}),
        "$yaml: unit: found the text '-'; "
        "expected a name of 1 to 64 letters, digits, '.', '_', '-' that begins with a "
        "letter or digit\n"
        "$yaml: capture.volts_per_count: found -1.0; expected a number, more than 0",
    ),
]

CALIBRATION = [
    Case(
        "calibration not yet valid",
        _record({"valid_from": "2015-01-01T00:00:00Z"}),
        "$yaml: started_at: found 2014-05-12T13:00:00Z; expected an instant from 2015-01-01T00:00:00Z on, "
        "when TETRA-01@2012a is valid",
    ),
    Case(
        "calibration no longer valid",
        _record({"valid_until": "2013-01-01T00:00:00Z"}),
        "$yaml: started_at: found 2014-05-12T13:00:00Z; expected an instant from 2012-06-01T00:00:00Z until "
        "2013-01-01T00:00:00Z, when TETRA-01@2012a is valid",
    ),
    Case(
        "calibration of another unit",
        _run({"unit": "TETRA-02"}),
        "$yaml: unit: found TETRA-02; expected TETRA-01, the unit of calibration TETRA-01@2012a",
    ),
    Case(
        "no such calibration",
        _run({"calibration": "TETRA-01@2013b"}),
        "$root/calibrations/TETRA-01/2013b.yaml: found no such file; "
        "expected the calibration record TETRA-01@2013b",
    ),
    Case(
        "a calibration that is not named by version",
        _run({"calibration": "TETRA-01"}),
        "$yaml: calibration: found the text 'TETRA-01'; expected a unit and a version of its "
        "record, as in TETRA-01@2012a",
    ),
    Case(
        "polarity of three gyros",
        _run({"capture.polarity": [1, 1, 1]}),
        "$yaml: capture.polarity: found 3 signs; expected 4, one a gyro of TETRA-01@2012a",
    ),
    Case(
        "a record that says another version",
        _record({"version": "2013b"}),
        "$record: version: found the text '2013b'; expected 2012a, the file's name",
    ),
    Case(
        "bias of three gyros",
        _record({"bias_V": [0.0, 0.0, 0.0]}),
        "$record: bias_V: found 3 values; expected 4, as many as scale_factor_V_per_deg_s",
    ),
    Case(
        "scale factor zero",
        _record({"scale_factor_V_per_deg_s": [0.075, 0.0, 0.092, 0.075]}),
        "$record: scale_factor_V_per_deg_s[1]: found 0; expected a scale factor other than zero",
    ),
    Case(
        "H of rank two",
        _record({"H": [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0]]}),
        "$record: H: found rows that depend on each other; expected a matrix of rank 3",
    ),
    Case(
        "a campaign.yaml with an unknown key",
        lambda lab: (lab.campaign / "campaign.yaml").write_text("titel: x\n"),
        "$campaign/campaign.yaml: titel: found an unknown key (did you mean title?); expected one of "
        "schema, title, operator, notes, calibration, captures_from, label, diagnose, report, certificate, "
        "derive",
    ),
]
