"""Progress with the time left, on a terminal; nothing where the output is piped."""

import io
import re
import sys
import time

import pytest

from fogreduce.cli.main import main
from fogreduce.cli.stage import STAGES
from fogreduce.progress import steps

#: As tqdm has it: done, whole, time since the start, time left.
TIME_LEFT = re.compile(r"/[0-9.]+k? *\w* *\[[0-9:]+<[0-9:]+")
BLOCKS = ("--parameters", '{"block_records": 256}')


class Terminal(io.StringIO):
    """A standard error that says it is a terminal."""

    def isatty(self):
        return True


@pytest.fixture(params=[True, False], ids=["terminal", "piped"])
def said(request, monkeypatch):
    """Calls a command that takes no time as if it took two seconds; what it said on standard error."""
    monkeypatch.setattr("fogreduce.progress.SILENT_S", 0.0)
    monkeypatch.setenv("TQDM_MININTERVAL", "0")

    def call(arguments):
        screen = Terminal() if request.param else io.StringIO()
        monkeypatch.setattr(sys, "stderr", screen)
        assert main(arguments) == 0
        if request.param:
            assert TIME_LEFT.search(screen.getvalue()), screen.getvalue()
        else:
            # What goes with a good end: the capture is made up, and no turn is in it.
            allowed = ("red flag: ", "warning: ")
            assert all(line.startswith(allowed) for line in screen.getvalue().splitlines())

    return call


def test_reduce_and_checksums(small_lab, said, capsys):
    said(small_lab.reduce(*BLOCKS))
    said(["checksums", str(small_lab.out), "--no-keep"])


def test_simulate(small_lab, said, capsys):
    """In a record of more than one block."""
    small_lab.write_run({"table.profile": [{"rate_deg_s": 0.01, "duration_s": 20_000.0}]})
    places = ["--calibrations", str(small_lab.calibrations), "--out", str(small_lab.out)]
    said(["simulate", str(small_lab.campaign), *places])


def test_each_stage(small_lab, said, capsys):
    """Those that read the whole record; the drift has only the fits to read."""
    assert main([*small_lab.manifest(), *BLOCKS]) == 0
    for name in STAGES[:-1]:
        said(small_lab.stage(name, run=True))
    assert main(small_lab.stage("drift")) == 0


def test_steps_are_named_while_they_last(monkeypatch):
    """A step of a diagnosis tells nothing of itself until it ends: the bar names it all the same."""
    monkeypatch.setattr("fogreduce.progress.SILENT_S", 0.0)
    monkeypatch.setattr("fogreduce.progress.TICK_S", 0.001)
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", screen)
    with steps(("reading", "search")) as begin:
        for name in ("reading", "search"):
            begin(name)
            while name not in screen.getvalue():
                time.sleep(0.001)
    assert "/2 [" in screen.getvalue()


def test_steps_of_a_quick_or_piped_command_are_silent(monkeypatch):
    for screen in (Terminal(), io.StringIO()):
        monkeypatch.setattr(sys, "stderr", screen)
        with steps(("reading", "search")) as begin:
            begin("search")
        assert screen.getvalue() == ""


def test_diagnose_names_its_steps(small_lab, monkeypatch, capsys):
    """Those that the command announces are those that a diagnosis goes through."""
    from fogreduce.diagnosis import diagnose

    def enough(*given):
        raise InterruptedError

    said = []
    monkeypatch.setattr(diagnose, "Search", enough)
    with pytest.raises(InterruptedError):
        diagnose.diagnose(small_lab.campaign, small_lab.calibrations, progress=said.append)
    assert said == list(diagnose.STEPS[:2])
