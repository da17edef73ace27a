"""The warm server: what comes out is what the cold command gives, and nothing outlives what it belongs to."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from fogreduce.warm import start as warm

FOGREDUCE = Path(sys.executable).with_name("fogreduce")
PATIENCE_S = 60.0

#: A workflow: starts a server and lives until its standard input closes.
WORKFLOW = """
import sys
import tempfile
from fogreduce.warm.start import start
print(start(), flush=True)
sys.stdin.read()
"""

#: Stands in for the real command: as `server` it serves jobs that wait, else it says that it ran cold.
REAL = """#!{python}
import os, signal, sys, time
from pathlib import Path
if sys.argv[1] != "server":
    print("cold", *sys.argv[1:])
    sys.exit(7)
from fogreduce.warm import serve
serve.ALWAYS = ()
def command(words):
    try:
        print(os.getpid(), flush=True)
        time.sleep(600)
    except KeyboardInterrupt:
        print("stopped", flush=True)
        return 1
    return 0
serve.Server(Path(sys.argv[2]), command).run()
"""


class Workflow:
    """A process that started a server."""

    def __init__(self, root: Path, real: str | None = None) -> None:
        environment = {**os.environ, "XDG_RUNTIME_DIR": str(root)}
        environment["PATH"] = f"{FOGREDUCE.parent}:{environment['PATH']}"
        environment.pop("SLURM_JOB_ID", None)
        if real is not None:
            (root / "bin").mkdir()
            command = root / "bin" / "fogreduce"
            command.write_text(real)
            command.chmod(0o755)
            environment["PATH"] = f"{root / 'bin'}:{environment['PATH']}"
        self.process = subprocess.Popen(
            [sys.executable, "-c", WORKFLOW],
            env=environment,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
        )
        assert self.process.stdout is not None
        self.folder = Path(self.process.stdout.readline().strip())
        self.client = self.folder / "fogreduce"
        wait_for(lambda: (self.folder / "socket").exists())

    def pid(self) -> int:
        """Of the server."""
        children = Path(f"/proc/{self.process.pid}/task/{self.process.pid}/children").read_text().split()
        (server,) = [int(child) for child in children]
        return server

    def job(self, **environment: str) -> subprocess.Popen[str]:
        """A client whose job waits."""
        return subprocess.Popen(
            [self.client, "stage", "drift"],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, **environment},
        )

    def end(self) -> None:
        self.process.kill()
        self.process.wait()
        for stream in (self.process.stdin, self.process.stdout):
            assert stream is not None
            stream.close()


def wait_for(condition: Callable[[], bool]) -> None:
    until = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < until, "waited in vain"
        time.sleep(0.01)


def lives(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


@pytest.fixture
def runtime() -> Iterator[Path]:
    """A folder with a short name: a socket's path has at most 107 bytes."""
    with tempfile.TemporaryDirectory() as name:
        yield Path(name)


@pytest.fixture
def workflow(runtime: Path) -> Iterator[Workflow]:
    workflow = Workflow(runtime)
    yield workflow
    workflow.end()


@pytest.fixture
def waiting(runtime: Path) -> Iterator[Workflow]:
    workflow = Workflow(runtime, REAL.format(python=sys.executable))
    yield workflow
    workflow.end()


@pytest.mark.parametrize(
    "words",
    [["--version"], ["check", "no-such-folder"], ["stage", "nothing"], ["summary", "--out", "here"], []],
)
def test_it_says_and_ends_as_the_cold_command(workflow: Workflow, tmp_path: Path, words: list[str]) -> None:
    told = [
        subprocess.run([command, *words], cwd=tmp_path, capture_output=True, text=True, check=False)
        for command in (workflow.client, FOGREDUCE)
    ]
    assert told[0].returncode == told[1].returncode
    assert (told[0].stdout, told[0].stderr) == (told[1].stdout, told[1].stderr)


def test_results_are_the_same_to_the_byte(workflow: Workflow, bench) -> None:
    run = bench.run(profile=[(3.0, 10.0)])
    outs = []
    for name, command in (("cold", FOGREDUCE), ("warm", workflow.client)):
        out = bench.root / name
        words = [run, "--calibrations", bench.calibrations, "--out", out]
        subprocess.run([command, "manifest", *words], check=True)
        for stage in ("ingest", "calibrate", "project", "remove_earth", "fit", "drift"):
            subprocess.run([command, "stage", stage, "--run", run, "--out", out], check=True)
        subprocess.run([command, "figures", "--run", run, "--out", out, "--formats", "svg"], check=True)
        outs.append({path.relative_to(out): path.read_bytes() for path in out.rglob("*") if path.is_file()})
    assert outs[0] == outs[1]
    assert len(outs[0]) > 15
    assert workflow.pid(), "the server lives on"


def test_it_is_private_and_goes_with_its_workflow(workflow: Workflow) -> None:
    assert workflow.folder.stat().st_mode & 0o777 == 0o700
    server = workflow.pid()
    workflow.process.kill()
    wait_for(lambda: not lives(server) and not workflow.folder.exists())


def test_a_job_ends_with_its_client(waiting: Workflow) -> None:
    job = waiting.job()
    assert job.stdout is not None
    pid = int(job.stdout.readline())
    assert lives(pid)
    job.kill()
    wait_for(lambda: not lives(pid))
    job.communicate()


@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_a_stopped_client_waits_until_its_job_has_tidied_up(waiting: Workflow, number: int) -> None:
    job = waiting.job()
    assert job.stdout is not None
    pid = int(job.stdout.readline())
    job.send_signal(number)
    said, _ = job.communicate(timeout=PATIENCE_S)
    assert (job.returncode, said) == (1, "stopped\n")
    assert not lives(pid)


def test_jobs_end_with_the_server_and_run_cold(waiting: Workflow) -> None:
    job = waiting.job()
    assert job.stdout is not None
    pid = int(job.stdout.readline())
    os.kill(waiting.pid(), signal.SIGKILL)
    said, _ = job.communicate(timeout=PATIENCE_S)
    assert job.returncode == 7
    assert said.splitlines()[-1] == "cold stage drift"
    wait_for(lambda: not lives(pid))
    late = waiting.job()
    assert late.communicate(timeout=PATIENCE_S)[0] == "cold stage drift\n"
    assert late.returncode == 7


def test_jobs_end_with_the_workflow(waiting: Workflow) -> None:
    job = waiting.job()
    assert job.stdout is not None
    pid = int(job.stdout.readline())
    waiting.process.kill()
    wait_for(lambda: not lives(pid))
    job.communicate(timeout=PATIENCE_S)


def test_a_job_killed_by_a_signal_says_so(waiting: Workflow) -> None:
    job = waiting.job()
    assert job.stdout is not None
    os.kill(int(job.stdout.readline()), signal.SIGKILL)
    job.communicate(timeout=PATIENCE_S)
    assert job.returncode == -signal.SIGKILL


def test_inside_a_slurm_job_commands_run_cold(waiting: Workflow) -> None:
    job = waiting.job(SLURM_JOB_ID="12")
    assert job.communicate(timeout=PATIENCE_S)[0] == "cold stage drift\n"


def test_none_is_started_where_it_is_not_wanted(monkeypatch, tmp_path: Path) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    for name in ("SLURM_JOB_ID", warm.OFF):
        with monkeypatch.context() as patch:
            patch.setenv(name, "1")
            assert warm.start() is None
    assert list(tmp_path.iterdir()) == []


def test_what_dead_workflows_left_is_swept(tmp_path: Path) -> None:
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    for pid in (dead.pid, os.getpid()):
        (tmp_path / f"fogreduce-{os.getuid()}-{pid}-abc").mkdir()
    (tmp_path / f"fogreduce-{os.getuid()}-mine").mkdir()
    warm.sweep(tmp_path)
    assert sorted(path.name.rpartition("-")[0].split("-", 2)[-1] for path in tmp_path.iterdir()) == sorted(
        [str(os.getpid()), str(os.getuid())]
    )
