"""A diagnosis from a cold start: eight runs of 300 s, one of 100 minutes; many in one process."""

from __future__ import annotations

import shutil
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

from measure import (
    CALIBRATIONS,
    COMMAND,
    REPOSITORY,
    Measured,
    machine,
    parser,
    published_run,
    run,
    spread,
    workplace,
)

from fogreduce.metadata.yaml12 import dump_yaml

MANY = 5
_STEP = {"deg_h": 3.0, "time_s": 120.0}
EFFECTS: dict[str, list[dict[str, object]]] = {
    "nothing wrong": [],
    "one effect": [
        {"effect": "bias_ramp", "channels": ["gyro2"], "runs": ["*"], "parameters": {"deg_h_per_h": 8.0}}
    ],
    "two effects": [
        {"effect": "bias_step", "channels": ["gyro3"], "runs": ["3-y-plus"], "parameters": _STEP},
        {"effect": "table_rate_error", "channels": ["table"], "runs": ["*"], "parameters": {"ppm": 300.0}},
    ],
}
#: What a command does up to diagnosis.json, without page and figures.
ONLY_JSON = """
import json, os, sys
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "__all__")
from pathlib import Path
from fogreduce.diagnosis.diagnose import diagnose, plain
found = diagnose(Path(sys.argv[1]), Path(sys.argv[2]))
Path(sys.argv[3]).write_text(json.dumps(plain(found.document)))
"""


def eight_runs(work: Path, name: str, effects: Sequence[Mapping[str, object]]) -> Path:
    """Captures with effects in them for the bundled campaign about three axes, eight runs of 300 s."""
    made = work / "eight" / name.replace(" ", "-")
    if not made.exists():
        made.parent.mkdir(exist_ok=True)
        file = work / "effects.yaml"
        file.write_text(dump_yaml({"schema": "fogreduce/effects/1", "effects": list(effects)}))
        source = REPOSITORY / "campaigns" / "three-axes"
        words = ["simulate", source, "--calibrations", CALIBRATIONS, "--out", made, "--effects", file]
        run([COMMAND, *words, "--seed", 1, "--draw-uncertainties"])
    return made


def diagnosed(out: Path, *campaigns: Path) -> Measured:
    """Diagnose campaigns into a folder that does not exist, whole process, page and figures in it."""
    shutil.rmtree(out, ignore_errors=True)
    return run([COMMAND, "diagnose", *campaigns, "--calibrations", CALIBRATIONS, "--out", out])


def told(title: str, found: Sequence[Measured]) -> None:
    """Wall and processor time and memory of a series."""
    print(f"\n{title}")
    print(f"  wall [s]      {spread([one.wall_s for one in found], 2)}")
    print(f"  processor [s] {spread([one.cpu_s for one in found], 2)}")
    print(f"  peak memory [MB] {spread([one.peak_mb for one in found], 0)}")


def main() -> None:
    """Each campaign cold, up to diagnosis.json and with the page; then copies of one, in one process."""
    arguments = parser(__doc__ or "", 5).parse_args()
    often = range(arguments.repetitions)
    with workplace(arguments) as work:
        print(machine())
        campaigns = {
            f"eight runs of 300 s, {name}": eight_runs(work, name, effects)
            for name, effects in EFFECTS.items()
        }
        campaigns["the published run, 100 minutes"] = published_run(work).parents[1]
        for name, campaign in campaigns.items():
            only = [sys.executable, "-c", ONLY_JSON, campaign, CALIBRATIONS, work / "only.json"]
            told(f"{name}: to diagnosis.json", [run(only) for _ in often])
            told(f"{name}: with page and figures", [diagnosed(work / "out", campaign) for _ in often])
        one = campaigns["eight runs of 300 s, one effect"]
        copies = [work / "many" / f"copy-{k}" for k in range(MANY)]
        for copy in copies:
            shutil.copytree(one, copy, dirs_exist_ok=True)
        found = [diagnosed(work / "out", *copies) for _ in often]
        told(
            f"{MANY} such campaigns in one process, for each of them",
            [Measured(item.wall_s / MANY, item.cpu_s / MANY, item.peak_mb) for item in found],
        )


if __name__ == "__main__":
    main()
