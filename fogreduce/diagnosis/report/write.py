"""A diagnosis on disk: diagnosis.json, simulator.yaml, the page and its figures, each whole or not at all."""

from __future__ import annotations

import json
from pathlib import Path

from fogreduce.datasets.atomic import write_text
from fogreduce.diagnosis.diagnose import Diagnosis
from fogreduce.diagnosis.effects_file import effects_text, plain
from fogreduce.diagnosis.report import next_run
from fogreduce.diagnosis.report.figures import figures
from fogreduce.diagnosis.report.html import both
from fogreduce.diagnosis.report.page import page
from fogreduce.pages.svg import SLIM

DIAGNOSIS, SIMULATOR, PAGE, FIGURES = "diagnosis.json", "simulator.yaml", "index.html", "figures"
#: The folder that the workflow gives a diagnosis, beside the pages of campaign and runs.
RESULTS = "_diagnosis"


def write(diagnosis: Diagnosis, out: Path, label: str | None = None) -> None:
    """Write all of it into a folder, which need not exist; diagnosis.json comes last.

    A run that an earlier diagnosis proposed there is taken away.
    """
    drawn, slim, proposed = figures(diagnosis), figures(diagnosis, SLIM), next_run.files(diagnosis)
    for name, text in drawn.items():
        write_text(out / FIGURES / name, text)
    for name in (next_run.RUN_FILE, next_run.TEMPERATURE_FILE):
        if name in proposed:
            write_text(out / name, proposed[name])
        else:
            (out / name).unlink(missing_ok=True)
    shown = {name: both(text, slim[name]) for name, text in drawn.items()}
    write_text(out / PAGE, page(diagnosis, shown, proposed, label, out.name == RESULTS))
    write_text(out / SIMULATOR, effects_text(diagnosis.effects))
    document = json.dumps(plain(diagnosis.document), indent=1, allow_nan=False, ensure_ascii=False)
    write_text(out / DIAGNOSIS, document + "\n")
