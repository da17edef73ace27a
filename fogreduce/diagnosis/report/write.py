"""A diagnosis on disk: diagnosis.json, simulator.yaml, the page and its figures, each whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path

from fogreduce.datasets.atomic import write_text
from fogreduce.diagnosis.diagnose import Diagnosis, plain
from fogreduce.diagnosis.report.page import figures, page
from fogreduce.metadata.yaml12 import dump_yaml

EFFECTS_SCHEMA = "fogreduce/effects/1"
DIAGNOSIS, SIMULATOR, PAGE, FIGURES = "diagnosis.json", "simulator.yaml", "index.html", "figures"


def write(diagnosis: Diagnosis, out: Path, label: str | None = None) -> None:
    """Write all of it into a folder, which need not exist; diagnosis.json comes last."""
    drawn = figures(diagnosis)
    for name, text in drawn.items():
        write_text(out / FIGURES / name, text)
    write_text(out / PAGE, page(diagnosis, drawn, label))
    effects = {"schema": EFFECTS_SCHEMA, "effects": plain(diagnosis.effects)}
    write_text(out / SIMULATOR, dump_yaml(effects))
    document = json.dumps(plain(diagnosis.document), indent=1, allow_nan=False, ensure_ascii=False)
    write_text(out / DIAGNOSIS, document + "\n")
