"""A small laboratory whose names are as hostile as names may be, reduced once."""

from pathlib import Path

import small_unit
from small_unit import succeed

from fogreduce.metadata.yaml12 import dump_yaml

HOSTILE = "<script>document.title='caught'</script>\"'&<img src=x onerror=document.title='caught'>"

RECORD = {**small_unit.RECORD, "procedure": HOSTILE}


def run_yaml(run_id, rate, **more):
    """A turn and a rest; names and notes are hostile."""
    site = {"latitude_deg": -23.2, "name": HOSTILE}
    return small_unit.run_yaml(run_id, [(rate, 40.0), (0.0, 30.0)], site=site, notes=HOSTILE, **more)


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
            described = run_yaml(run_id, rate, started_at=f"2014-05-1{number}T13:00:00Z")
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
