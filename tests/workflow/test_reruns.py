"""What runs again after an edit, in a scratch copy of everything: exactly the nodes that it can touch."""

from __future__ import annotations

import json
import os
import re
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BIN = Path(sys.executable).parent

RUN_YAML = """\
schema: fogreduce/run/1
run_id: {run_id}
unit: {unit}
started_at: 2014-05-12T13:00:00Z
site: {{latitude_deg: -23.21132308}}
table:
  axis: x
  profile: [{{rate_deg_s: 10, duration_s: 10}}]
orientation: {{x: up, z: north}}
capture:
  file: capture.fogcap
  format: fogcap-1
  sample_rate_hz: 32
  volts_per_count: 1.0e-7
  polarity: [1, -1, 1, 1]
calibration: {unit}@2012a
"""

STAGES = {"ingest", "calibrate", "project", "remove_earth", "fit", "drift"}
LAST = {"figures", "checksums"}
RUN = {"manifest", *STAGES, *LAST}
Nodes = set[tuple[str, str]]


class Lab:
    """A copy of the source, two runs of two units, and the workflow over them."""

    def __init__(self, root: Path) -> None:
        self.source = root / "source"
        for name in ("fogreduce", "workflow", "profiles"):
            shutil.copytree(ROOT / name, self.source / name, ignore=shutil.ignore_patterns("__pycache__"))
        for name in ("Snakefile", "requirements.lock"):
            shutil.copy(ROOT / name, self.source / name)
        self.place = root / "place"
        record = (ROOT / "calibrations" / "TETRA-01" / "2012a.yaml").read_text()
        for run_id, unit in (("a", "TETRA-01"), ("b", "TETRA-02")):
            folder = self.place / "plan" / "runs" / run_id
            folder.mkdir(parents=True)
            (folder / "run.yaml").write_text(RUN_YAML.format(run_id=run_id, unit=unit))
            path = self.place / "calibrations" / unit / "2012a.yaml"
            path.parent.mkdir(parents=True)
            path.write_text(record.replace("TETRA-01", unit))
        words = ["simulate", "plan", "--calibrations", "calibrations", "--out", "campaigns/lab"]
        self.call("fogreduce", *words)

    def call(self, command: str, *words: object, status: int = 0) -> str:
        environment = {**os.environ, "PYTHONPATH": str(self.source), "OPENBLAS_NUM_THREADS": "1"}
        done = subprocess.run(
            [BIN / command, *map(str, words)],
            cwd=self.place,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == status, done.stdout + done.stderr
        return done.stdout + done.stderr

    def snakemake(self, *words: str, status: int = 0, **config: str) -> str:
        told = ["--cores", "2", "--snakefile", self.source / "Snakefile", *words]
        told += ["--workflow-profile", self.source / "profiles" / "default"]
        config = {"pages": "{enabled: false}", **config}
        return self.call(
            "snakemake",
            *told,
            "--config",
            *(f"{key}={value}" for key, value in config.items()),
            status=status,
        )

    def planned(self, **config: str) -> Nodes:
        """What a call would run: rule and run, the aggregates without a run; `all` aside."""
        nodes: Nodes = set()
        for part in re.split(r"\n(?=\w*rule \w+:)", self.snakemake("--dry-run", **config)):
            if match := re.match(r"\w*rule (\w+):", part):
                run = re.search(r"wildcards: .*\brun=(\w+)", part)
                nodes.add((match[1], run[1] if run else ""))
        return nodes - {("all", "")}


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Lab:
    lab = Lab(tmp_path_factory.mktemp("reruns"))
    lab.snakemake()
    return lab


@contextmanager
def changed(path: Path, change: Callable[[str], str]) -> Iterator[None]:
    """A file with other content for a while, then as it was, its time too."""
    before, times = path.read_bytes(), path.stat()
    text = before.decode("latin-1")
    assert change(text) != text
    path.write_bytes(change(text).encode("latin-1"))
    try:
        yield
    finally:
        path.write_bytes(before)
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))


def of(rules: set[str], *runs: str) -> Nodes:
    return {(rule, run) for rule in rules for run in runs}


SUMMARY = {("summary", "")}


def statement(text: str) -> str:
    return text + "\nA_WORD = 1\n"


def comment(text: str) -> str:
    return text.replace('"""', '"""Words. ', 1) + "\n\n# a word\n"


def flipped(text: str) -> str:
    return text[:-1] + chr(ord(text[-1]) ^ 1)


#: What is edited -> file below the source or the place, edit, nodes that run again.
EDITS: dict[str, tuple[str, Callable[[str], str], Nodes]] = {
    "a stage": ("source/fogreduce/stages/drift.py", statement, of(RUN, "a", "b") | SUMMARY),
    "shared physics": ("source/fogreduce/physics/frames.py", statement, of(RUN, "a", "b") | SUMMARY),
    "a module imported late": (
        "source/fogreduce/datasets/readers/csv1.py",
        statement,
        of(RUN, "a", "b") | SUMMARY,
    ),
    "a figure": ("source/fogreduce/figures/rates.py", statement, of(LAST, "a", "b")),
    "the summary": ("source/fogreduce/stages/summary.py", statement, SUMMARY),
    "a module that no node uses": ("source/fogreduce/cli/curve.py", statement, set()),
    "comment and docstring of a stage": ("source/fogreduce/stages/fit.py", comment, set()),
    "the lock": ("source/requirements.lock", statement, of(RUN, "a", "b") | SUMMARY),
    "a calibration record": (
        "place/calibrations/TETRA-02/2012a.yaml",
        lambda text: text + "# a word\n",
        of(RUN, "b") | SUMMARY,
    ),
    "run.yaml": (
        "place/campaigns/lab/runs/a/run.yaml",
        lambda text: text.replace("-23.2113", "-23.2114"),
        of(RUN, "a") | SUMMARY,
    ),
    "a capture": ("place/campaigns/lab/runs/a/capture.fogcap", flipped, of(RUN, "a") | SUMMARY),
}


@pytest.mark.slow
def test_nothing_changed_nothing_runs(lab: Lab) -> None:
    assert lab.planned() == set()
    path = lab.place / "campaigns/lab/runs/a/run.yaml"
    os.utime(path)
    assert lab.planned() == set(), "touched, but equal"


@pytest.mark.slow
@pytest.mark.parametrize("edit", EDITS)
def test_an_edit_runs_again_what_it_touches(lab: Lab, edit: str) -> None:
    name, change, expected = EDITS[edit]
    with changed(lab.place.parent / name, change):
        assert lab.planned() == expected


@pytest.mark.slow
def test_a_configured_value_runs_again_what_it_touches(lab: Lab) -> None:
    assert lab.planned(figures="{formats: [png]}") == of(LAST, "a", "b")
    assert lab.planned(reduction="{edge_guard_s: 0.25}") == of(RUN, "a", "b") | SUMMARY


@pytest.mark.slow
def test_outputs_edited_by_hand_are_made_anew_once(lab: Lab) -> None:
    results = lab.place / "results" / "lab"
    edited = [results / "a" / "tables" / "drift.csv", results / "b" / "datasets" / "project.nc"]
    before = [path.read_bytes() for path in edited]
    untouched = (results / "a" / "datasets" / "ingest.nc").stat().st_mtime_ns
    for _ in range(2):  # the same edit a second time is found again
        edited[0].write_bytes(before[0].replace(b"x,", b"y,"))
        edited[1].write_bytes(before[1][:-1] + bytes([before[1][-1] ^ 1]))
        last = {"drift", *LAST}
        expected = of(last, "a") | of({"project", "remove_earth", "fit", *last}, "b") | SUMMARY
        assert lab.planned() == expected
        lab.snakemake()
        assert [path.read_bytes() for path in edited] == before
        assert lab.planned() == set()
    assert (results / "a" / "datasets" / "ingest.nc").stat().st_mtime_ns == untouched


@pytest.mark.slow
def test_a_clock_that_is_set_back(lab: Lab) -> None:
    """What was edited while the clock stood earlier is seen; inputs from the future run no more than once."""
    path = lab.place / "campaigns/lab/runs/a/run.yaml"
    times = path.stat()
    with changed(path, lambda text: text + "# a word\n"):
        os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns - 3600 * 10**9))
        assert lab.planned() == of(RUN, "a") | SUMMARY
    inputs = {path: path.stat() for path in path.parent.iterdir()}
    try:
        for ahead, was in inputs.items():
            os.utime(ahead, ns=(was.st_atime_ns, was.st_mtime_ns + 86400 * 10**9))
        assert lab.planned() == set()
        # Snakemake makes nothing of such inputs; other runs, and the tables over all, are made nevertheless.
        with changed(lab.place / "campaigns/lab/runs/b/run.yaml", lambda text: text + "# a word\n"):
            assert lab.planned() == of(RUN, "b") | SUMMARY
            lab.snakemake()
    finally:
        for ahead, was in inputs.items():
            os.utime(ahead, ns=(was.st_atime_ns, was.st_mtime_ns))
    lab.snakemake()


@pytest.mark.slow
def test_an_added_run_is_the_only_one_that_runs(lab: Lab) -> None:
    runs = lab.place / "campaigns/lab/runs"
    shutil.copytree(runs / "a", runs / "c")
    path = runs / "c" / "run.yaml"
    path.write_text(path.read_text().replace("run_id: a", "run_id: c"))
    try:
        assert lab.planned() == of(RUN, "c") | SUMMARY
    finally:
        shutil.rmtree(runs / "c")


@pytest.mark.slow
def test_a_new_record_reruns_what_used_the_old_one_and_no_others(lab: Lab) -> None:
    """`impact` names the runs; a new version that their run.yaml names runs these again."""
    record = lab.place / "calibrations/TETRA-02/2012a.yaml"
    used = json.loads(lab.call("fogreduce", "impact", "TETRA-02@2012a", "--format", "json"))["runs"]
    assert used == ["lab/b"]
    later = record.with_name("2013a.yaml")
    later.write_text(record.read_text().replace("version: 2012a", "version: 2013a"))
    try:
        assert lab.planned() == set(), "nobody names it"
        with changed(lab.place / "campaigns/lab/runs/b/run.yaml", lambda t: t.replace("2@2012a", "2@2013a")):
            assert lab.planned() == of(RUN, *(name.partition("/")[2] for name in used)) | SUMMARY
    finally:
        later.unlink()


@pytest.mark.slow
def test_a_record_that_was_used_is_not_rewritten(lab: Lab) -> None:
    """Its runs are refused, those that were never reduced too; the others are reduced; results stay."""
    results = lab.place / "results/lab"
    runs = lab.place / "campaigns/lab/runs"
    shutil.copytree(runs / "b", runs / "c")
    path = runs / "c" / "run.yaml"
    path.write_text(path.read_text().replace("run_id: b", "run_id: c"))
    before = {name: name.read_bytes() for name in sorted((results / "b").rglob("*.csv"))}
    try:
        with changed(lab.place / "calibrations/TETRA-02/2012a.yaml", lambda text: text + "# a word\n"):
            said = lab.snakemake("--keep-going", status=1)
            assert "TETRA-02@2012a: not what lab/b used; a record that was used is never rewritten" in said
            for run in ("b", "c"):
                log = (results / run / "logs" / "manifest.log").read_text()
                assert "another content than lab/b was reduced with" in log
            assert not (results / "c" / "tables").exists()
            assert before == {name: name.read_bytes() for name in sorted((results / "b").rglob("*.csv"))}
    finally:
        shutil.rmtree(runs / "c")
        shutil.rmtree(results / "c")
    lab.snakemake()
    assert lab.planned() == set()
    assert not (lab.place / "results/_rewritten.json").exists()


@pytest.mark.slow
def test_a_derived_record_is_used_by_nobody_until_it_is_named(lab: Lab) -> None:
    about = lab.place / "campaigns/lab/campaign.yaml"
    runs = lab.place / "campaigns/lab/runs"
    about.write_text("derive: true\n")
    assert lab.planned() == set(), "it says nothing that runs are reduced with"
    said = lab.snakemake()
    expected = "found runs of TETRA-01@2012a (a) and of TETRA-02@2012a (b); expected runs of one calibration"
    assert f"derives no record: campaigns/lab: calibration: {expected}" in said
    assert not (lab.place / "results/lab/_calibration").exists()
    shutil.move(runs / "b", lab.place / "b")  # runs of one record
    try:
        assert ("derive_calibration", "") in lab.planned()
        lab.snakemake()
        found = json.loads((lab.place / "results/lab/_calibration/derivation.json").read_text())
        assert found["candidate"] is None, "one sense of one axis"
        assert lab.planned() == set()
        assert "TETRA-01@2012a" in (lab.place / "results/lab/a/manifest.json").read_text()
    finally:
        about.unlink()
        shutil.move(lab.place / "b", runs / "b")
    lab.snakemake()
