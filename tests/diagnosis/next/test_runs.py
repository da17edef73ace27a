"""run.yaml of a next run: that of today's first run but for what is today's alone."""

from bench_lab import lab

from fogreduce.diagnosis.next.runs import Proposal, run_document
from fogreduce.metadata.run import Run
from fogreduce.metadata.yaml12 import load_yaml


def test_the_epoch_of_todays_stamps_is_not_kept(tmp_path):
    lab(tmp_path)
    today = load_yaml(tmp_path / "plan" / "runs" / "r0" / "run.yaml")
    today["capture"] |= {"file": "log.csv", "format": "csv-1", "time_zero": 1_747_053_000.25}
    document = run_document(Run.from_data(today, "run.yaml"), Proposal("y", "up", -2.0, 600.0))
    assert document["capture"]["time_zero"] == "first"
    assert document["capture"]["file"] == "log.csv"
    Run.from_data(document, "next")
