"""What a killed process left behind is swept when the same file is written again, and nothing else is."""

import os
import subprocess
import sys
from pathlib import Path

from fogreduce.datasets.atomic import write_text


def test_leavings_of_dead_processes_are_swept(tmp_path: Path) -> None:
    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    target = tmp_path / "drift[1].csv"
    left = tmp_path / f".{target.name}.{dead.pid}.tmp"
    left.write_text("half")
    folder = tmp_path / f".{target.name}.99999999999.tmp"
    (folder / "inner").mkdir(parents=True)
    kept = [f".{target.name}.{os.getppid()}.tmp", f".other.{dead.pid}.tmp", f".{target.name}.word.tmp"]
    for name in kept:
        (tmp_path / name).write_text("another's")
    write_text(target, "whole\n")
    assert target.read_text() == "whole\n"
    assert {path.name for path in tmp_path.iterdir()} == {target.name, *kept}
