"""Too little memory, a full disk for other commands than reduce, a clock that is set back."""

import itertools
import resource
import time

import pytest
from small_lab import header, records
from test_system_faults import files, run, small_disk  # noqa: F401  the fixture of a small file system

from fogreduce.cli.main import main

NO_MEMORY = "found no more memory; expected a higher limit on memory (ulimit -v, or the job's own)\n"
#: Said by the library of linear algebra, which ends the process itself.
OPENBLAS = "OpenBLAS error: Memory allocation still failed after 10 retries, giving up.\n"


@pytest.mark.parametrize("megabytes", [20, 60, 100, 200])
def test_memory_limit(small_lab, megabytes):
    """One line wherever it runs out: in the loader of libraries, in a thread's start, in an array; no file.

    How much is enough depends on the machine: what is not refused is whole.
    """
    small_lab.write_run({"table.profile": [{"rate_deg_s": 0.01, "duration_s": 12_500.0}]})
    small_lab.write_capture(header(), records(200_000).tobytes())
    limit = megabytes << 20
    status, said = run(small_lab.reduce(), lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
    if status == 0:
        assert said == ""
        assert (small_lab.out / "manifest.json").is_file()
        return
    assert status == 1
    assert said.endswith((NO_MEMORY, OPENBLAS))
    assert said.count("\n") == 1
    assert files(small_lab.out) == []


def test_simulate_on_a_full_disk(small_lab, small_disk):  # noqa: F811
    small_lab.write_run({"table.profile": [{"rate_deg_s": 10.0, "duration_s": 600.0}]})
    out = small_disk / "made"
    places = ["--calibrations", small_lab.calibrations, "--out", out]
    status, said = run(["simulate", small_lab.campaign, *places])
    assert status == 2
    assert said.endswith(": found No space left on device; expected room on the disk\n")
    assert said.count("\n") == 1
    assert files(small_disk) == []


def test_a_stage_on_a_full_disk_keeps_the_stage_before(small_lab, small_disk):  # noqa: F811
    """What was there stays as it was; what has no room leaves nothing."""
    small_lab.out = small_disk / "out"
    assert run(small_lab.manifest())[0] == 0
    assert run(small_lab.stage("ingest", run=True))[0] == 0
    kept = {path: path.read_bytes() for path in files(small_disk)}
    (small_disk / "filler").write_bytes(b"x" * 20_000)
    status, said = run(small_lab.stage("calibrate"))
    assert status == 2
    assert said == (
        f"{small_lab.out}/datasets/calibrate.nc: found No space left on device; expected room on the disk\n"
    )
    (small_disk / "filler").unlink()
    assert {path: path.read_bytes() for path in files(small_disk)} == kept


def test_a_clock_set_back(small_lab, monkeypatch, capsys):
    """A clock that runs backwards by an hour at each look: nothing is refused, the tables are the same."""
    assert main(small_lab.reduce()) == 0
    tables = {path.name: path.read_bytes() for path in (small_lab.out / "tables").iterdir()}
    clock = itertools.count(time.time(), -3600.0)
    monkeypatch.setattr(time, "time", lambda: next(clock))
    assert main(small_lab.reduce()) == 0
    assert {path.name: path.read_bytes() for path in (small_lab.out / "tables").iterdir()} == tables
    assert main(["checksums", str(small_lab.out)]) == 0
    # The laboratory's readings are made up, and so do not follow its command: that alone is said.
    assert all(line.startswith("red flag:") for line in capsys.readouterr().err.splitlines())
