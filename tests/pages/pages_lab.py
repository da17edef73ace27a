"""A small laboratory whose names are as hostile as names may be, reduced once."""

import contextlib
import io
from pathlib import Path

from fogreduce.cli.main import main
from fogreduce.metadata.yaml12 import dump_yaml

HOSTILE = "<script>document.title='caught'</script>\"'&<img src=x onerror=document.title='caught'>"

RECORD = {
    "schema": "fogreduce/calibration/1",
    "unit": "TETRA-01",
    "version": "2012a",
    "valid_from": "2012-06-01T00:00:00Z",
    "procedure": HOSTILE,
    "H": [[0.29, 0.29, 0.29, 0.5], [0.0, 0.71, -0.7, 0.0], [0.81, -0.41, -0.41, 0.0]],
    "scale_factor_V_per_deg_s": [0.075, 0.09, 0.092, 0.075],
    "bias_V": [1e-4, 6e-4, 2e-4, -4e-4],
}


def run_yaml(run_id, rate, started_at="2014-05-12T13:00:00Z"):
    return {
        "schema": "fogreduce/run/1",
        "run_id": run_id,
        "unit": "TETRA-01",
        "started_at": started_at,
        "site": {"latitude_deg": -23.2, "name": HOSTILE},
        "table": {
            "axis": "x",
            "profile": [{"rate_deg_s": rate, "duration_s": 40.0}, {"rate_deg_s": 0.0, "duration_s": 30.0}],
        },
        "orientation": {"x": "up", "z": "north"},
        "capture": {
            "file": "capture.fogcap",
            "format": "fogcap-1",
            "sample_rate_hz": 16.0,
            "volts_per_count": 1e-7,
            "polarity": [1, -1, 1, 1],
        },
        "calibration": "TETRA-01@2012a",
        "notes": HOSTILE,
    }


def call(*arguments):
    """A command's exit status and standard error."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = main([str(argument) for argument in arguments])
    return status, err.getvalue()


def succeed(*arguments):
    status, err = call(*arguments)
    assert status == 0, err


class Lab:
    """Folders of one campaign ``c1`` of two runs with figures, a third that failed, and their calibration."""

    def __init__(self, root: Path) -> None:
        self.campaign = root / "campaigns" / "c1"
        self.results = root / "results"
        calibrations = root / "calibrations"
        (calibrations / "TETRA-01").mkdir(parents=True)
        (calibrations / "TETRA-01" / "2012a.yaml").write_text(dump_yaml(RECORD))
        plan = root / "plan" / "c1"
        for number, (run_id, rate) in enumerate({"r1": 10.0, "r2": -10.0}.items()):
            folder = plan / "runs" / run_id
            folder.mkdir(parents=True)
            described = run_yaml(run_id, rate, f"2014-05-1{number}T13:00:00Z")
            (folder / "run.yaml").write_text(dump_yaml(described))
        about = {"title": HOSTILE, "operator": HOSTILE, "notes": HOSTILE, "label": "<b>made up</b>"}
        (plan / "campaign.yaml").write_text(dump_yaml(about))
        succeed("simulate", plan, "--calibrations", calibrations, "--out", self.campaign)
        for run_id in ("r1", "r2"):
            out = self.results / "c1" / run_id
            run = self.campaign / "runs" / run_id
            succeed("reduce", run, "--calibrations", calibrations, "--out", out)
            succeed("figures", "--run", run, "--out", out, "--formats", "svg")
        self._failed("r3")

    def _failed(self, run_id):
        """A run whose capture could not be read: a log, nothing else."""
        run = self.campaign / "runs" / run_id
        run.mkdir()
        (run / "run.yaml").write_text(dump_yaml(run_yaml(run_id, 1.0)))
        logs = self.results / "c1" / run_id / "logs"
        logs.mkdir(parents=True)
        (logs / "manifest.log").write_text(f"capture.fogcap: byte 0: found {HOSTILE}; expected FOGCAP1\n")

    def run(self, run_id="r1"):
        """Results of a run, its page written."""
        succeed("page", "run", self.results / "c1" / run_id)
        return self.results / "c1" / run_id
