"""Two writers of one folder at once: one does its work whole, the other is told and writes nothing.

Commands are forked from this process, whose imports they share, so that twenty overlaps of each pair take
minutes; the workflow is a process of its own. `FOGREDUCE_OVERLAPS`: how many overlaps of each pair are made.
"""

from __future__ import annotations

import itertools
import os
import random
import shutil
import signal
import subprocess
import sys
import time
import traceback
from pathlib import Path

import pytest
from small_campaign import ASIDE, BIN, PATIENCE_S, ROOT, write_captures

from fogreduce.cli.main import main

pytestmark = pytest.mark.slow

COMMANDS = ("reduce", "diagnose", "simulate", "archive", "restore")
OVERLAPS = int(os.environ.get("FOGREDUCE_OVERLAPS", "20"))
#: Tries for one overlap: a second that comes too late or too early finds nobody at work.
TRIES = 6


class Lab:
    """Inputs of every writer, the folder that all write, and what each leaves there undisturbed."""

    def __init__(self, root: Path) -> None:
        self.root, self.out = root, root / "out"
        write_captures(root, ("a", "b"))
        self.records = ROOT / "calibrations"
        for run in ("a", "b"):
            self.do("reduce", root / f"campaigns/lab/runs/{run}", "--out", root / f"results/lab/{run}")
            self.do("checksums", root / f"results/lab/{run}")
        self.do(*self.words("archive", 0)[:-1], root / "bags")
        self.alone: dict[tuple[str, int], tuple[dict[str, bytes], float]] = {}

    def do(self, *words: object) -> None:
        records = ["--calibrations", str(self.records)] if words[0] in ("reduce", "archive") else []
        assert main([*map(str, words), *records]) == 0

    def words(self, writer: str, which: int) -> list[object]:
        """The command that writes the folder; `which` of two runs, or seeds, where there are two."""
        run, campaign = ("a", "b")[which], self.root / "campaigns/lab"
        return {
            "reduce": ["reduce", campaign / "runs" / run],
            "diagnose": ["diagnose", campaign, "--only-runs", run],
            "simulate": ["simulate", campaign, "--seed", which],
            "archive": ["archive", self.root / "results", "--campaigns", self.root / "campaigns"],
            "restore": ["restore", self.root / "bags/lab"],
        }[writer] + ["--out", self.out]

    def start(self, writer: str, which: int) -> Writer:
        if writer == "workflow":
            return Workflow(self, which)
        words = self.words(writer, which)
        if writer != "restore":
            words += ["--calibrations", self.records]
        return Command(self.root / f"said-{which}", [str(word) for word in words])

    def contents(self) -> dict[str, bytes]:
        """Every file of the folder, logs and timings aside."""
        return {
            str(path.relative_to(self.out)): path.read_bytes()
            for path in sorted(self.out.rglob("*"))
            if path.is_file() and not ASIDE & set(path.relative_to(self.out).parts)
        }

    def undisturbed(self, writer: str, which: int) -> tuple[dict[str, bytes], float]:
        """What a writer leaves when it is by itself, and how long it takes [s]."""
        if (writer, which) not in self.alone:
            self.clear()
            began = time.monotonic()
            status, said = self.start(writer, which).end()
            assert status == 0, said
            self.alone[writer, which] = self.contents(), time.monotonic() - began
        return self.alone[writer, which]

    def clear(self) -> None:
        shutil.rmtree(self.out, ignore_errors=True)


class Writer:
    """A process that writes the folder."""

    pid: int
    said: Path

    def wait(self) -> int:
        return os.waitstatus_to_exitcode(os.waitpid(self.pid, 0)[1])

    def end(self) -> tuple[int, str]:
        status = self.wait()
        return status, self.said.read_text()


class Command(Writer):
    """A command in a fork of this process."""

    def __init__(self, said: Path, words: list[str]) -> None:
        self.said = said
        sys.stdout.flush()
        sys.stderr.flush()
        self.pid = os.fork()
        if self.pid:
            return
        status = 1
        try:
            signal.alarm(PATIENCE_S)
            file = os.open(said, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
            os.dup2(file, 1)
            os.dup2(file, 2)
            sys.stdout, sys.stderr = os.fdopen(1, "w"), os.fdopen(2, "w")
            status = main(words)
        except BaseException:
            traceback.print_exc()
        finally:
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status)


class Workflow(Writer):
    """The plain command, in a working folder of its own, so that Snakemake's locks keep nobody out."""

    def __init__(self, lab: Lab, which: int) -> None:
        place = lab.root / f"place-{which}"
        shutil.rmtree(place, ignore_errors=True)
        place.mkdir()
        self.said = lab.root / f"said-{which}"
        settings = [f"campaigns_dir={lab.root}/campaigns", f"calibrations_dir={lab.records}"]
        settings += [f"results_dir={lab.out}", "figures={enabled: false}", "pages={enabled: false}"]
        with self.said.open("wb") as said:
            self.process = subprocess.Popen(
                [BIN / "snakemake", "--cores", "2", "--snakefile", ROOT / "Snakefile", "--config", *settings],
                cwd=place,
                stdout=said,
                stderr=said,
            )
        self.pid = self.process.pid

    def wait(self) -> int:
        return self.process.wait(PATIENCE_S)


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Lab:
    return Lab(tmp_path_factory.mktemp("overlaps"))


def overlap(lab: Lab, names: tuple[str, str], random_: random.Random) -> bool:
    """Start one, after a while the other; whether they met."""
    order = random_.sample((0, 1), 2)
    if names[0] == "workflow" != names[1]:
        order = [0, 1]  # a command has ended long before a workflow that begins after it writes
    expected = {which: lab.undisturbed(names[which], which) for which in order}
    lab.clear()
    first = lab.start(names[order[0]], order[0])
    time.sleep(random_.uniform(0.0, 0.9) * expected[order[0]][1])
    second = lab.start(names[order[1]], order[1])
    ended = {order[0]: first.end(), order[1]: second.end()}
    pids = {order[0]: first.pid, order[1]: second.pid}
    told = [which for which, (_, said) in ended.items() if "expected one writer at a time" in said]
    if not told:
        return False
    (loser,) = told
    winner = 1 - loser
    assert ended[loser][0] == 2, ended
    assert f"process {pids[winner]} on {os.uname().nodename}, since " in ended[loser][1]
    assert ended[winner][0] == 0, ended
    assert lab.contents() == expected[winner][0], names
    return True


def meet(lab: Lab, names: tuple[str, str], times: int) -> None:
    random_ = random.Random(" ".join(names))
    met = 0
    for _ in range(TRIES * times):
        met += overlap(lab, names, random_)
        if met == times:
            return
    pytest.fail(f"only {met} overlaps of {' and '.join(names)}")


@pytest.mark.parametrize("names", list(itertools.combinations_with_replacement(COMMANDS, 2)), ids="-".join)
def test_commands(lab: Lab, names: tuple[str, str]) -> None:
    meet(lab, names, OVERLAPS)


@pytest.mark.parametrize("other", ["workflow", *COMMANDS])
def test_the_workflow_and(lab: Lab, other: str) -> None:
    meet(lab, ("workflow", other), OVERLAPS)
