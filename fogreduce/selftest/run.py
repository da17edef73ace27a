"""All checks, and their page: expected beside obtained."""

from __future__ import annotations

import json
import platform
import tempfile
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import scipy

import fogreduce
from fogreduce.datasets.atomic import write_text
from fogreduce.pages.render import page
from fogreduce.provenance.code import code_digest
from fogreduce.selftest import allan, geometry, gum, paper
from fogreduce.selftest.check import Check

SCHEMA = "fogreduce/selftest/1"
PAGE, RECORD = "selftest.html", "selftest.json"
_DIGITS = 10
_PARTS = (
    allan.nist,
    allan.freedom,
    geometry.geometry,
    gum.impedance,
    gum.straight_line,
    paper.integrated,
)


def checks() -> list[Check]:
    """Compute every number; the paper's run takes some seconds."""
    found: list[Check] = []
    for part in _PARTS:
        found += part()
    with tempfile.TemporaryDirectory() as folder:
        found += paper.reconstructed(Path(folder))
    return found


def software() -> dict[str, str]:
    """What computed them: versions, and a digest of the package's code."""
    return {
        "fogreduce": fogreduce.__version__,
        "code_sha256": code_digest(),
        "python": platform.python_version(),
        "numpy": np.__version__,
        "scipy": scipy.__version__,
    }


def document(found: list[Check]) -> dict[str, Any]:
    """The checks as plain data."""
    rows = [asdict(one) | {"good": one.good} for one in found]
    failed = sum(not one.good for one in found)
    return {"schema": SCHEMA, "software": software(), "checks": len(rows), "failed": failed, "results": rows}


def write(found: list[Check], folder: Path) -> list[Path]:
    """Write selftest.json and the page."""
    said = document(found)
    groups: dict[str, list[dict[str, str | bool]]] = {}
    for one in found:
        row: dict[str, str | bool] = {
            "what": one.what,
            "source": one.source,
            "expected": f"{one.expected:.{_DIGITS}g}",
            "obtained": f"{one.obtained:.{_DIGITS}g}",
            "difference": f"{one.obtained - one.expected:.1e}",
            "tolerance": f"{one.tolerance:.1e}",
            "because": one.because,
            "unit": one.unit,
            "good": one.good,
        }
        groups.setdefault(one.group, []).append(row)
    title = "Published numbers, computed by this software"
    html = page("selftest.html", title, {"said": said, "groups": groups})
    write_text(folder / RECORD, json.dumps(said, indent=1, allow_nan=False) + "\n")
    write_text(folder / PAGE, html)
    return [folder / RECORD, folder / PAGE]
