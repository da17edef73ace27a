"""Good runs of eighty seconds with a capture in text and both logs, and what is said of a spoilt copy."""

import contextlib
import copy
import io
import shutil
from pathlib import Path

import numpy as np

from fogreduce.cli.main import main
from fogreduce.metadata.yaml12 import dump_yaml

REPOSITORY = Path(__file__).resolve().parents[2]
#: The record of the published unit, which states every uncertainty.
RECORD_FILE = REPOSITORY / "calibrations" / "TETRA-01" / "2012a.yaml"
RATE_HZ = 64.0

GOOD = {
    "schema": "fogreduce/run/1",
    "run_id": "good",
    "unit": "TETRA-01",
    "started_at": "2014-05-12T13:00:00Z",
    "site": {"latitude_deg": -23.2113},
    "table": {
        "axis": "z",
        "profile": [
            {"rate_deg_s": 0.0, "duration_s": 14.0},
            {"rate_deg_s": 10.0, "duration_s": 20.0},
            {"rate_deg_s": -24.0, "duration_s": 22.0},
            {"rate_deg_s": 4.0, "duration_s": 16.0},
            {"rate_deg_s": 0.0, "duration_s": 8.0},
        ],
    },
    "orientation": {"z": "up", "x": "north"},
    "azimuth_deg": 31.0,
    "azimuth_uncertainty_deg": 0.05,
    "capture": {
        "file": "capture.csv",
        "format": "csv-1",
        "sample_rate_hz": RATE_HZ,
        "volts_per_count": 1e-7,
        "polarity": [1, -1, 1, 1],
    },
    "calibration": "TETRA-01@2012a",
    "temperature": "temperature.csv",
    "table_log": "table.csv",
}
#: What another run of the same unit on the same day has otherwise: half as long, about another axis.
OTHER = {
    "run_id": "other",
    "table": {
        "axis": "x",
        "profile": [{"rate_deg_s": 6.0, "duration_s": 20.0}, {"rate_deg_s": -6.0, "duration_s": 20.0}],
    },
    "orientation": {"x": "up", "z": "north"},
}
#: A good run of a digital unit, which gives deg/s, about a level axis.
DIGITAL = GOOD | {
    "unit": "DIGITAL-7",
    "calibration": "DIGITAL-7@a",
    "site": {"latitude_deg": 48.137},
    "orientation": {"z": "east", "x": "up"},
    "capture": {
        "file": "capture.csv",
        "format": "csv-1",
        "sample_rate_hz": RATE_HZ,
        "raw_unit": "deg/s",
        "least_count": 1e-7,
        "polarity": [1, 1, 1],
    },
}
#: Its record: an ideal unit that is as good as the published one.
DIGITAL_RECORD = {
    "schema": "fogreduce/calibration/1",
    "unit": "DIGITAL-7",
    "version": "a",
    "valid_from": "2012-06-01T00:00:00Z",
    "procedure": "none",
    "H": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
    "scale_factor_deg_s_per_deg_s": [1.0, 1.0, 1.0],
    "bias_deg_s": [0.0, 0.0, 0.0],
    "uncertainty": {
        "scale_factor_rel": [2e-5] * 3,
        "bias_deg_s": [1e-8] * 3,
        "axis_rad": [2e-5] * 3,
        "turn_on_bias_deg_h": [0.05] * 3,
    },
    "noise": {
        "angle_random_walk_deg_sqrt_h": [0.002] * 3,
        "bias_instability_deg_h": [0.03] * 3,
        "rate_random_walk_deg_h_sqrt_h": [0.0] * 3,
    },
}


def call(*arguments):
    """A command's exit status, standard output and standard error."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = main([str(argument) for argument in arguments])
    return status, out.getvalue(), err.getvalue()


def angle_deg(profile, times):
    """The table's angle at times [s], the integral of the profile."""
    edges = np.concatenate([[0.0], np.cumsum([step["duration_s"] for step in profile])])
    angles = np.concatenate([[0.0], np.cumsum([s["duration_s"] * s["rate_deg_s"] for s in profile])])
    return np.interp(times, edges, angles)


def write_logs(folder, profile):
    """temperature.csv, a row a second, and table.csv, ten a second of an encoder of 1e-5 deg."""
    length = sum(step["duration_s"] for step in profile)
    seconds = np.arange(0.0, length + 0.5)
    temperatures = np.column_stack([seconds, 31.0 + 0.002 * seconds, 24.0 + 0.001 * seconds])
    save(folder / "temperature.csv", "time_s,electronics_degC,sensor_degC", temperatures, "%.1f,%.3f,%.3f")
    times = np.arange(0.0, length + 0.05, 0.1)
    table = np.column_stack([times, angle_deg(profile, times)])
    save(folder / "table.csv", "time_s,angle_deg", table, "%.1f,%.5f")


def save(path, header, rows, form):
    """A table of numbers under a header."""
    np.savetxt(path, rows, form, header=header, comments="")


def load(path):
    """Header and numbers of a CSV table."""
    return path.read_text().split("\n", 1)[0], np.loadtxt(path, delimiter=",", skiprows=1)


def simulated(root, runs, records, *options):
    """Campaign folder of simulated runs (run.yaml's data), with logs; records by id."""
    plan, campaign, calibrations = root / "plan" / "c1", root / "campaigns" / "c1", root / "calibrations"
    for record_id, record in records.items():
        path = calibrations / f"{record_id.replace('@', '/')}.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(dump_yaml(record))
    for run in runs:
        folder = plan / "runs" / run["run_id"]
        folder.mkdir(parents=True)
        write_logs(folder, run["table"]["profile"])
        (folder / "run.yaml").write_text(dump_yaml(run))
    options = ["--draw-uncertainties", "--calibrations", calibrations, "--out", campaign, *options]
    status, _, err = call("simulate", plan, *options)
    assert status == 0, err
    return campaign


class GoodRun:
    """Folders of a good run and of another of the same unit, and their calibration record."""

    def __init__(self, root: Path, run, record, seed) -> None:
        self.run, self.record = run, record
        other = copy.deepcopy(run) | copy.deepcopy(OTHER)
        runs = simulated(root, [run, other], {run["calibration"]: record}, "--seed", seed) / "runs"
        self.folder, self.other = runs / "good", runs / "other"
        self.calibrations = root / "calibrations"

    def with_mistake(self, change, target):
        """Exit status and what is said of a copy of the run in which `change` made its mistake."""
        folder = target / "campaigns" / "c1" / "runs" / "good"
        shutil.copytree(self.folder, folder)
        calibrations = target / "calibrations"
        mistake = Mistake(copy.deepcopy(self.run), copy.deepcopy(self.record), folder, self.other)
        change(mistake)
        (folder / "run.yaml").write_text(dump_yaml(mistake.run))
        path = calibrations / f"{self.run['calibration'].replace('@', '/')}.yaml"
        path.parent.mkdir(parents=True)
        path.write_text(dump_yaml(mistake.record))
        return said_of(folder, calibrations, target / "out")


class Mistake:
    """What a mistake may change: run.yaml's data, the record's, the run's files; and another run's folder."""

    def __init__(self, run, record, folder, other) -> None:
        self.run, self.record, self.folder, self.other = run, record, folder, other

    @property
    def steps(self):
        """The profile."""
        return self.run["table"]["profile"]

    def edit(self, name, function):
        """Change the numbers of a file."""
        header, rows = load(self.folder / name)
        rows = function(rows)
        save(self.folder / name, header, rows, ",".join(["%.6f"] + ["%.9g"] * (rows.shape[1] - 1)))

    def take(self, name):
        """Put the other run's file in place of this one's."""
        shutil.copyfile(self.other / name, self.folder / name)


def said_of(folder, calibrations, out):
    """Exit status, and what check, else reduce, says on standard error."""
    status, _, err = call("check", folder, "--calibrations", calibrations)
    if status == 0:
        status, _, more = call("reduce", folder, "--calibrations", calibrations, "--out", out)
        err += more
    return status, err
