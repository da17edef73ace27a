"""Verify a bag of more than 2 GB: each byte read once, memory flat; its speed beside the hash is printed."""

import hashlib
import json
import random
import shutil
import subprocess
import sys
import time

import pytest
from archived_lab import CAMPAIGN
from small_unit import call

from fogreduce.provenance.code import reduction_parts

_BYTES = 2_200_000_000
_CODE = """
import json, sys, time
from pathlib import Path
from fogreduce.archive.verify import verify
def read():
    return int(Path("/proc/self/io").read_text().split("rchar: ")[1].split()[0])
import h5py, fogreduce.metadata.folder
before, began = read(), time.perf_counter()
found = verify(Path(sys.argv[1]))
print(json.dumps({
    "seconds": time.perf_counter() - began,
    "read": read() - before,
    "bytes": found.bytes,
    "faults": len(found.faults),
    "peak": int(Path("/proc/self/status").read_text().split("VmHWM:")[1].split()[0]) * 1024,
}))
"""


def measured(bag):
    """Verify in a process of its own."""
    done = subprocess.run([sys.executable, "-c", _CODE, str(bag)], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)


def one_pass(bag):
    """Seconds of one hashlib.sha256 pass over the same files."""
    began = time.perf_counter()
    for path in sorted(bag.rglob("*")):
        if path.is_file():
            with path.open("rb") as file:
                hashlib.file_digest(file, "sha256")
    return time.perf_counter() - began


@pytest.mark.slow
def test_a_large_bag(archived, tmp_path):
    campaigns = tmp_path / "campaigns"
    shutil.copytree(archived.campaigns, campaigns)
    block = random.Random(1).randbytes(1 << 20)
    with (campaigns / CAMPAIGN / "large.bin").open("wb") as file:
        for k in range(_BYTES // len(block) + 1):
            file.write(k.to_bytes(8, "little"))
            file.write(block)
    arguments = [campaigns if a == archived.campaigns else a for a in archived.arguments(tmp_path / "bags")]
    assert call(*arguments)[0] == 0
    shutil.rmtree(campaigns)
    bag = tmp_path / "bags" / CAMPAIGN
    # Taken in turn, the best of each: the machine has other things to do.
    passes, verified = [], []
    for _ in range(3):
        passes.append(one_pass(bag))
        verified.append(measured(bag))
    shutil.rmtree(bag)
    small = measured(archived.bag)
    best = min(item["seconds"] for item in verified)
    print(f"one pass {min(passes):.2f} s, verify {best:.2f} s, {verified[0]}, small {small}")
    assert verified[0]["faults"] == 0
    assert verified[0]["bytes"] > 2_000_000_000
    # Each byte once; and the directories of the datasets, run.yaml and the records again, some kB each.
    assert verified[0]["read"] < 1.001 * verified[0]["bytes"]
    assert verified[0]["peak"] - small["peak"] < 16 << 20


def test_each_byte_is_read_once(archived):
    found = measured(archived.bag)
    assert found["faults"] == 0
    tags = sum(path.stat().st_size for path in archived.bag.glob("*.txt"))
    # The code is read again, since its digest goes by what it says.
    code = sum(
        (archived.bag / "data" / "software" / "fogreduce" / part).stat().st_size for part in reduction_parts()
    )
    # Budgets are many variables of a few numbers: HDF5's directories of them are nearly the whole file.
    budgets = sum(path.stat().st_size for path in archived.bag.rglob("budget.nc"))
    # Beside that and the hashing pass: HDF5's directories of ten datasets, run.yaml, the record.
    assert found["read"] - found["bytes"] - tags - code - budgets < 300_000
