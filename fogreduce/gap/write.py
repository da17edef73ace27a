"""A diagnosis on disk: diagnosis.json and simulator.yaml, each whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path

from fogreduce.datasets.atomic import write_text
from fogreduce.gap.diagnose import Diagnosis, _plain
from fogreduce.metadata.yaml12 import dump_yaml

EFFECTS_SCHEMA = "fogreduce/effects/1"


def write(diagnosis: Diagnosis, out: Path) -> None:
    """Write both files into a folder, which need not exist."""
    effects = {"schema": EFFECTS_SCHEMA, "effects": _plain(diagnosis.effects)}
    write_text(out / "simulator.yaml", dump_yaml(effects))
    text = json.dumps(_plain(diagnosis.document), indent=1, allow_nan=False, ensure_ascii=False)
    write_text(out / "diagnosis.json", text + "\n")
