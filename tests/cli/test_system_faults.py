"""A full disk, a file too large, no permission: through the installed command, bound by files' modes."""

import ctypes
import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest

COMMAND = str(Path(sys.executable).with_name("fogreduce"))
CAPABILITIES = (
    1,
    2,
)  # CAP_DAC_OVERRIDE, CAP_DAC_READ_SEARCH: root's right to read and write what modes forbid
PR_CAPBSET_DROP = 24
IS_ROOT = os.geteuid() == 0


def run(arguments, before=None) -> tuple[int, str]:
    """Exit status and standard error of the command; on standard output a run's summary alone."""
    done = subprocess.run(
        [COMMAND, *map(str, arguments)], capture_output=True, text=True, timeout=60, preexec_fn=before
    )
    assert len(done.stdout.splitlines()) <= (done.returncode == 0)
    assert "Traceback" not in done.stderr
    return done.returncode, done.stderr


def files(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*") if path.is_file()]


def bound_by_modes() -> None:
    """For the child: even root is held to the modes of files once the command is started."""
    for capability in CAPABILITIES:
        if IS_ROOT and ctypes.CDLL(None).prctl(PR_CAPBSET_DROP, capability, 0, 0, 0):
            os._exit(77)


def smallest_files(limit: int):
    """For the child: no file may grow beyond `limit` bytes; the attempt is an error, not a signal."""

    def before() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    return before


@pytest.mark.parametrize("parameters", ["{}", '{"storage": {"chunk_records": 100, "compression": "gzip"}}'])
@pytest.mark.parametrize("limit", [1 << 10, 20 << 10])
def test_file_too_large(small_lab, limit, parameters):
    """Limits on the size of a file at which the first and at which a later dataset stops."""
    status, said = run(small_lab.reduce("--parameters", parameters), smallest_files(limit))
    assert status == 2
    assert said.startswith(f"{small_lab.out}/datasets/")
    assert said.endswith(
        ".nc: found File too large; expected a limit on the size of files that lets it be written\n"
    )
    assert said.count("\n") == 1
    assert files(small_lab.out) == []


@pytest.fixture
def small_disk(tmp_path):
    """A file system of 100 kB, where the tests may mount one."""
    place = tmp_path / "disk"
    place.mkdir()
    options = ["mount", "-t", "tmpfs", "-o", "size=100k", "tmpfs", str(place)]
    if not IS_ROOT or subprocess.run(options, capture_output=True).returncode:
        pytest.skip("no right to mount a small disk")
    yield place
    subprocess.run(["umount", str(place)], check=True)


@pytest.mark.parametrize("parameters", ["{}", '{"storage": {"chunk_records": 100}}'])
def test_full_disk(small_lab, small_disk, parameters):
    small_lab.out = small_disk / "out"
    status, said = run(small_lab.reduce("--parameters", parameters))
    assert status == 2
    assert said.startswith(f"{small_lab.out}/datasets/")
    assert said.endswith(".nc: found No space left on device; expected room on the disk\n")
    assert said.count("\n") == 1
    assert files(small_disk) == []


def test_full_disk_keeps_what_was_there(small_lab, small_disk):
    """A second reduction that finds the disk full leaves the first one's tables and datasets as they were."""
    small_lab.write_run({"table.profile": [{"rate_deg_s": 10.0, "duration_s": 60.0}]})
    assert run(small_lab.reduce())[0] == 0
    small_disk_out = small_disk / "out"
    small_disk_out.mkdir()
    kept = small_disk_out / "tables" / "drift.csv"
    kept.parent.mkdir()
    kept.write_text("kept\n")
    small_lab.out = small_disk_out
    assert run(small_lab.reduce())[0] == 2
    assert files(small_disk) == [kept]
    assert kept.read_text() == "kept\n"


class TestNoPermission:
    """Files and folders of mode 0; the command is bound by modes, whoever runs the tests."""

    def refused(self, arguments) -> str:
        status, said = run(arguments, bound_by_modes)
        if status == 77:
            pytest.skip("no right to give up a right")
        assert status == 2
        return said

    def test_capture(self, small_lab):
        small_lab.capture.chmod(0)
        assert self.refused(small_lab.reduce()) == (
            f"{small_lab.yaml}: capture.file: found capture.fogcap, which may not be read; "
            "expected a file in the run's own folder\n"
        )
        assert not small_lab.out.exists()

    def test_run_yaml(self, small_lab):
        small_lab.yaml.chmod(0)
        expected = f"{small_lab.yaml}: found no permission to read it; expected a readable file\n"
        assert self.refused(small_lab.reduce()) == expected

    def test_run_folder(self, small_lab):
        small_lab.run.chmod(0)
        try:
            expected = f"{small_lab.yaml}: found no permission to read it; expected a readable file\n"
            assert self.refused(small_lab.reduce()) == expected
        finally:
            small_lab.run.chmod(0o755)

    def test_calibration(self, small_lab):
        small_lab.record.chmod(0)
        expected = f"{small_lab.record}: found no permission to read it; expected a readable file\n"
        assert self.refused(small_lab.reduce()) == expected

    def test_results(self, small_lab):
        small_lab.out.mkdir(mode=0o555)
        expected = (
            f"{small_lab.out}/datasets: found Permission denied; expected permission to read or write it\n"
        )
        assert self.refused(small_lab.reduce()) == expected

    def test_dataset_of_the_stage_before(self, small_lab):
        assert run(small_lab.manifest())[0] == 0
        assert run(small_lab.stage("ingest", run=True))[0] == 0
        path = small_lab.out / "datasets" / "ingest.nc"
        path.chmod(0)
        expected = f"{path}: found Permission denied; expected the dataset of stage ingest\n"
        assert self.refused(small_lab.stage("calibrate")) == expected


def test_a_directory_under_a_tables_name(small_lab):
    (small_lab.out / "tables" / "drift.csv" / "x").mkdir(parents=True)
    status, said = run(small_lab.reduce())
    assert status == 2
    assert said == f"{small_lab.out}/tables/drift.csv: found Is a directory; expected a file\n"
    assert not list(small_lab.out.rglob("*.tmp"))


@pytest.mark.parametrize(
    ("arguments", "last_line"),
    [
        (["reduce"], "error: the following arguments are required: RUN, --out"),
        (["stage", "smooth", "--out", "x"], "error: argument stage: invalid choice: 'smooth'"),
        (["redcue"], "error: argument COMMAND: invalid choice: 'redcue'"),
        ([], "error: the following arguments are required: COMMAND"),
    ],
)
def test_usage(arguments, last_line):
    status, said = run(arguments)
    assert status == 2
    assert last_line in said.splitlines()[-1]


def test_no_traceback_from_the_installed_command(small_lab):
    """One fault of each stage of the way in, as a user would meet it."""
    small_lab.write_capture(b"\0" * 64)
    status, said = run(small_lab.reduce())
    assert (status, said.count("\n")) == (2, 1)
    small_lab.write_run({"unit": None})
    assert run(small_lab.reduce())[0] == 2
    assert run(small_lab.stage("fit"))[0] == 2
    assert files(small_lab.out) == []
