"""The examples to copy in the README make a campaign that is checked, reduced and simulated."""

import csv
import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from fogreduce.cli.main import main
from fogreduce.metadata.yaml12 import load_yaml

README = Path(__file__).resolve().parents[2] / "README.md"
RUN = "2026-03-01-x"
#: Example -> how its block begins.
BLOCKS = {
    "run.yaml": "schema: fogreduce/run/1",
    "capture.csv": "time_s,gyro1_V",
    "temperature.csv": "time_s,electronics_degC",
    "table.csv": "time_s,angle_deg",
    "record": "schema: fogreduce/calibration/1",
    "effects": "schema: fogreduce/effects/1",
}


def example(name):
    """The text of an example, as it stands in the section."""
    section = README.read_text().split("### Your own runs", 1)[1].split("\n### ", 1)[0]
    blocks = re.findall(r"```(?:yaml)?\n(.*?)```", section, re.DOTALL)
    (found,) = [block for block in blocks if block.startswith(BLOCKS[name])]
    return found


def run(*arguments):
    assert main([str(argument) for argument in arguments]) == 0


class Copied:
    """A campaign of the examples; capture and logs have the header of theirs, and the rows of a whole run."""

    def __init__(self, root):
        self.calibrations, self.campaign = root / "calibrations", root / "campaigns" / "my-campaign"
        self.effects = root / "effects.yaml"
        self.effects.write_text(example("effects"))
        record = self.calibrations / "MY-UNIT" / "2026a.yaml"
        record.parent.mkdir(parents=True)
        record.write_text(example("record"))
        self.run = self.campaign / "runs" / RUN
        self.run.mkdir(parents=True)
        steps = load_yaml_text(root, example("run.yaml"))["table"]["profile"]
        self._logs(steps)
        self._simulate(root / "plan" / "my-campaign")
        (self.run / "run.yaml").write_text(example("run.yaml"))

    def _logs(self, steps):
        length = sum(step["duration_s"] for step in steps)
        seconds = np.arange(0.0, length + 1.0)
        write(
            self.run, "temperature.csv", np.column_stack([seconds, 31.2 + 0 * seconds, 24.05 + 0 * seconds])
        )
        times = np.arange(0.0, length + 0.05, 0.1)
        edges = np.cumsum([0.0] + [step["duration_s"] for step in steps])
        angles = np.cumsum([0.0] + [step["duration_s"] * step["rate_deg_s"] for step in steps])
        write(self.run, "table.csv", np.column_stack([times, np.interp(times, edges, angles)]))

    def _simulate(self, plan):
        """The capture that the README's run.yaml and record let expect, with its effects put in."""
        folder = plan / "runs" / RUN
        folder.mkdir(parents=True)
        binary = "file: c.fogcap, format: fogcap-1"
        planned = example("run.yaml").replace("file: capture.csv, format: csv-1", binary)
        assert binary in planned
        (folder / "run.yaml").write_text(planned)
        for log in ("temperature.csv", "table.csv"):
            (folder / log).write_bytes((self.run / log).read_bytes())
        self.out = plan.parent / "predicted"
        options = ["--calibrations", self.calibrations, "--effects", self.effects, "--out", self.out]
        run("simulate", plan, *options)
        record = [("stamp_us", "<u8"), ("pulse", "<u4"), ("counts", "<i4", (3,))]
        records = np.fromfile(self.out / "runs" / RUN / "c.fogcap", record, offset=64)
        write(self.run, "capture.csv", np.column_stack([records["stamp_us"] / 1e6, records["counts"] * 1e-7]))


def load_yaml_text(root, text):
    path = root / "text.yaml"
    path.write_text(text)
    return load_yaml(path)


def write(folder, name, rows):
    """A CSV file with the example's header."""
    header = example(name).splitlines()[0]
    np.savetxt(folder / name, rows, "%.7f", delimiter=",", header=header, comments="")


@pytest.fixture(scope="module")
def copied(tmp_path_factory):
    return Copied(tmp_path_factory.mktemp("readme"))


def test_check_accepts_all_of_them_and_nothing_is_assumed(copied, capsys):
    run("check", copied.campaign, "--calibrations", copied.calibrations)
    run("check", copied.calibrations / "MY-UNIT" / "2026a.yaml")
    run("check", copied.effects)
    captured = capsys.readouterr()
    assert "assumed" not in captured.out
    assert captured.err == ""


def test_the_run_is_reduced(copied, tmp_path):
    run("reduce", copied.run, "--calibrations", copied.calibrations, "--out", tmp_path / "out")
    with (tmp_path / "out" / "tables" / "drift.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["segment"] == "all"]
    assert {row["axis"] for row in rows} == {"x", "y", "z"}


def test_the_effects_are_put_in(copied):
    injected = copied.out.with_name("predicted.injected.yaml").read_text()
    assert "table_rate_error" in injected
    assert "angle_random_walk" in injected


@pytest.mark.parametrize("name", ["capture.csv", "temperature.csv", "table.csv"])
def test_the_rows_of_an_example_are_read(copied, tmp_path, name):
    """The few lines themselves, in place of as many: a form that a reader refuses shows here."""
    campaign = tmp_path / "campaigns" / "my-campaign"
    shutil.copytree(copied.campaign, campaign)
    lines = (copied.run / name).read_text().splitlines()
    few = example(name).splitlines()
    assert lines[0] == few[0]
    (campaign / "runs" / RUN / name).write_text("\n".join(few + lines[len(few) :]) + "\n")
    run("check", campaign, "--calibrations", copied.calibrations)
