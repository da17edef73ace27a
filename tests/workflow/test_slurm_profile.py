"""The profile for Slurm, as far as it can be checked without Slurm; test_slurm.py runs it."""

import re
import subprocess
from pathlib import Path

import yaml

ROOT = Path(__file__).parents[2]


def test_the_rules_of_a_run_and_no_others_are_grouped() -> None:
    rules = {
        name: body
        for path in (ROOT / "workflow" / "rules").glob("*.smk")
        for name, body in re.findall(r"^rule (\w+):\n((?:    .*\n|\n)+)", path.read_text(), re.MULTILINE)
    }
    of_a_run = {name for name, body in rules.items() if 'run_file("logs/' in body}
    assert {"manifest", "fit", "figures"} <= of_a_run
    profile = yaml.safe_load((ROOT / "profiles" / "slurm" / "config.yaml").read_text())
    assert profile["groups"] == dict.fromkeys(profile["groups"], "run")
    assert set(profile["groups"]) == of_a_run


def test_a_number_of_batches_that_cannot_be_is_refused(tmp_path: Path) -> None:
    for words in ([], ["none"], ["0"], ["-3"]):
        done = subprocess.run(
            [ROOT / "profiles/slurm/batches.sh", *words],
            cwd=tmp_path,
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 2
        found = words[0] if words else ""
        assert done.stderr.splitlines() == [
            f"batches.sh: found '{found}' for the number of batches; expected a whole number from 1"
        ]
