"""The workflow on a Slurm cluster of one node, started here from Debian's packages and stopped again."""

from __future__ import annotations

import importlib.util
import os
import shutil
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import pytest
from small_campaign import ASIDE, BIN, ROOT, write_captures

DAEMONS = ("munged", "slurmctld", "slurmd")

CONF = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={here}/munge.socket
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
SlurmctldPort={ports[0]}
SlurmdPort={ports[1]}
StateSaveLocation={here}/state
SlurmdSpoolDir={here}/spool
SlurmctldPidFile={here}/slurmctld.pid
SlurmdPidFile={here}/slurmd.pid
SlurmctldLogFile={here}/slurmctld.log
SlurmdLogFile={here}/slurmd.log
NodeName={host} NodeAddr=127.0.0.1 CPUs={cpus} RealMemory=4000
PartitionName=main Nodes=ALL Default=YES State=UP
"""


def missing() -> str:
    """Why Slurm cannot be started here, or nothing."""
    absent = [name for name in (*DAEMONS, "sbatch", "srun") if shutil.which(name) is None]
    if absent:
        return f"no {', '.join(absent)} here: apt-get install -y --no-install-recommends slurm-wlm munge"
    return "" if os.geteuid() == 0 else "Slurm's daemons are started as root"


pytestmark = [pytest.mark.slow, pytest.mark.skipif(bool(missing()), reason=missing())]


def free_ports(n: int) -> list[int]:
    sockets = [socket.create_server(("127.0.0.1", 0)) for _ in range(n)]
    ports = [one.getsockname()[1] for one in sockets]
    for one in sockets:
        one.close()
    return ports


def wait_for(what: str, seconds: float, done: object) -> None:
    """Until `done()`; the test fails after so many seconds."""
    end = time.monotonic() + seconds
    while not done():  # type: ignore[operator]
        assert time.monotonic() < end, f"{what}: not within {seconds} s"
        time.sleep(0.5)


def alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except FileNotFoundError:
        return False


class Cluster:
    """Slurm in a folder, its key, sockets, state and logs too; `environment` is what its users need."""

    def __init__(self, here: Path) -> None:
        self.here = here
        self.environment = {
            **os.environ,
            "PATH": f"{here / 'bin'}:{BIN}:{os.environ['PATH']}",
            "PYTHONPATH": os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")]),
            "OPENBLAS_NUM_THREADS": "1",
            "SLURM_CONF": str(here / "slurm.conf"),
        }

    def start(self) -> None:
        for name in ("state", "spool", "bin"):
            (self.here / name).mkdir()
        # munged's socket must be open to all.
        self.here.chmod(0o755)
        # The plugin clears SLURM_* before it calls srun, which then looks in /etc: no place for a test.
        srun = self.here / "bin" / "srun"
        srun.write_text(f'#!/bin/sh\nSLURM_CONF={self.here}/slurm.conf exec {shutil.which("srun")} "$@"\n')
        srun.chmod(0o755)
        (self.here / "slurm.conf").write_text(
            CONF.format(
                host=socket.gethostname(), here=self.here, ports=free_ports(2), cpus=os.cpu_count() or 1
            )
        )
        key = self.here / "munge.key"
        key.touch(mode=0o600)
        key.write_bytes(os.urandom(1024))
        files = {"key-file": key} | {
            f"{name}-file": self.here / f"munged.{name}" for name in ("pid", "log", "seed")
        }
        self._run(
            "munged",
            f"--socket={self.here}/munge.socket",
            *(f"--{name}={path}" for name, path in files.items()),
        )
        self._run("slurmctld")
        self._run("slurmd")
        wait_for("a node that takes jobs", 60, lambda: "idle" in self._run("sinfo", "-h", "-o", "%t"))

    def _run(self, *words: str) -> str:
        done = subprocess.run(
            words, env=self.environment, capture_output=True, text=True, timeout=60, check=False
        )
        assert done.returncode == 0, (words, done.stdout, done.stderr)
        return done.stdout

    def queue(self) -> str:
        return self._run("squeue", "-h")

    def stop(self) -> None:
        """End all jobs and daemons; none of them may stay."""
        subprocess.run(["scancel", "--user=root"], env=self.environment, check=False)
        pids = [
            int((self.here / f"{name}.pid").read_text())
            for name in reversed(DAEMONS)
            if (self.here / f"{name}.pid").exists()
        ]
        for pid in pids:
            os.kill(pid, 15)
        wait_for("the end of Slurm's daemons", 60, lambda: not any(map(alive, pids)))


@pytest.fixture(scope="module")
def cluster() -> Iterator[Cluster]:
    # Not a folder of pytest's, all of which are closed to other users.
    with tempfile.TemporaryDirectory(prefix="slurm-") as here:
        cluster = Cluster(Path(here))
        try:
            cluster.start()
            yield cluster
        finally:
            cluster.stop()


@pytest.fixture(scope="module")
def captures(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A campaign `lab` of three short runs."""
    return write_captures(tmp_path_factory.mktemp("captures"), ("a", "b", "c"))


def words(campaigns: Path) -> list[str | Path]:
    """What snakemake is told besides how to run."""
    return [
        *("--snakefile", ROOT / "Snakefile"),
        *("--config", f"campaigns_dir={campaigns}", f"calibrations_dir={ROOT / 'calibrations'}"),
    ]


def local(place: Path, campaigns: Path) -> Path:
    """The results of the plain command."""
    place.mkdir()
    subprocess.run(
        [BIN / "snakemake", "--cores", "2", *words(campaigns)], cwd=place, capture_output=True, check=False
    )
    return place / "results"


def contents(results: Path) -> dict[str, bytes]:
    """Every file of the results by its name, logs and timings aside."""
    return {
        str(path.relative_to(results)): path.read_bytes()
        for path in sorted(results.rglob("*"))
        if path.is_file() and not ASIDE & set(path.relative_to(results).parts)
    }


@pytest.mark.skipif(
    importlib.util.find_spec("snakemake_executor_plugin_slurm") is None,
    reason="no snakemake-executor-plugin-slurm here: pip install 'fogreduce[slurm]'",
)
def test_the_profile_gives_what_a_local_run_gives(cluster: Cluster, captures: Path, tmp_path: Path) -> None:
    shutil.copytree(captures, tmp_path / "campaigns")
    shutil.rmtree(tmp_path / "campaigns/lab/runs/c")
    place = tmp_path / "cluster"
    place.mkdir()
    done = subprocess.run(
        [
            *(BIN / "snakemake", "--profile", ROOT / "profiles" / "slurm"),
            # This Slurm keeps no accounts, which sacct would read.
            *("--slurm-status-command", "squeue", "--slurm-init-seconds-before-status-checks", "2"),
            *("--seconds-between-status-checks", "2"),
            *words(tmp_path / "campaigns"),
        ],
        cwd=place,
        env=cluster.environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    submitted = [line for line in done.stderr.splitlines() if "has been submitted with SLURM jobid" in line]
    assert sum("group_run_" in line for line in submitted) == 2, "a Slurm job for each run"
    assert len(submitted) < 8, "and some for what spans runs"
    there, here = contents(place / "results"), contents(local(tmp_path / "local", tmp_path / "campaigns"))
    assert "lab/b/datasets/project.nc" in there
    assert there == here
    assert cluster.queue() == ""


def test_batches_give_what_a_local_run_gives_and_a_broken_run_costs_only_itself(
    cluster: Cluster, captures: Path, tmp_path: Path
) -> None:
    shutil.copytree(captures, tmp_path / "campaigns")
    capture = tmp_path / "campaigns/lab/runs/b/capture.fogcap"
    capture.write_bytes(b"NOT A CAPTURE" + capture.read_bytes()[13:])
    place = tmp_path / "cluster"
    place.mkdir()
    done = subprocess.run(
        [ROOT / "profiles/slurm/batches.sh", "2", *words(tmp_path / "campaigns")],
        cwd=place,
        env={**cluster.environment, "CPUS": "1", "MEM": "1000"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip().isdecimal(), "the job to wait for"
    wait_for("an empty queue", 600, lambda: cluster.queue() == "")
    there, here = contents(place / "results"), contents(local(tmp_path / "local", tmp_path / "campaigns"))
    assert {"lab/a/outputs.json", "lab/c/outputs.json"} <= set(there)
    assert there == here
    (line,) = [
        line
        for line in (place / ".snakemake/slurm_logs/rest.log").read_text().splitlines()
        if line.startswith("  lab/b: ")
    ]
    assert "byte 0" in line
