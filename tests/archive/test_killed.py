"""Killed at any instant, `archive` leaves no bag that verifies but is not whole."""

import os
import random
import signal
import subprocess
import sys
import time

import pytest
from archived_lab import CAMPAIGN

from fogreduce.archive.verify import verify
from fogreduce.errors import BadInput

_CODE = "import sys; from fogreduce.cli.main import main; sys.exit(main(sys.argv[1:]))"


def start(archived, out):
    command = [sys.executable, "-c", _CODE, *map(str, archived.arguments(out))]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def sound(folder):
    """The digest of a folder that verifies; None for one that does not."""
    try:
        found = verify(folder)
    except BadInput:
        return None
    return None if found.faults else found.digest


def kill_at_random(archived, out, times, seed):
    """Kill `archive` so many times; how many of them left a half-written bag behind, under another name."""
    began = time.monotonic()
    assert start(archived, out / "whole").wait() == 0
    takes = time.monotonic() - began
    draw = random.Random(seed)
    halves = 0
    for k in range(times):
        target = out / f"killed-{k}"
        process = start(archived, target)
        time.sleep(draw.uniform(0.0, takes))
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        there = list(target.iterdir()) if target.is_dir() else []
        for folder in there:
            digest = sound(folder)
            # Under its own name only whole; and whatever verifies, under whatever name, is whole.
            assert digest == archived.digest if folder.name == CAMPAIGN else digest in (None, archived.digest)
            halves += digest is None
    return halves


def test_killed_at_a_few_instants(archived, tmp_path):
    kill_at_random(archived, tmp_path, 5, seed=1)


@pytest.mark.slow
def test_killed_at_fifty_instants(archived, tmp_path):
    assert kill_at_random(archived, tmp_path, 50, seed=2) >= 5


@pytest.mark.parametrize("last", ["data/ro-crate-metadata.json", "tagmanifest-sha256.txt"])
def test_killed_right_before_a_file_that_counts(archived, tmp_path, last):
    """The instants that chance would seldom meet: before the last payload file, before the last file."""
    code = f"""
import os, pathlib, signal, sys
from fogreduce.archive import bag
write = bag.write_synced
def writing(path, content):
    if path.as_posix().endswith({last!r}):
        os.kill(os.getpid(), signal.SIGKILL)
    write(path, content)
bag.write_synced = writing
from fogreduce.cli.main import main
main(sys.argv[1:])
"""
    command = [sys.executable, "-c", code, *map(str, archived.arguments(tmp_path))]
    assert subprocess.run(command, check=False).returncode == -signal.SIGKILL
    (left,) = tmp_path.iterdir()
    assert left.name.startswith(".")
    assert sound(left) is None
    assert archived.archive(tmp_path) == archived.digest
    assert [path.name for path in tmp_path.iterdir()] == [CAMPAIGN]
