"""What an older version, or another run, left in the folder into which a run is reduced.

A new manifest makes untrue what stands for the old: figures, page, overview and checksums are removed, and
made again by their own commands. Datasets, reports and tables are written over; ``versions/`` stays.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from fogreduce.errors import BadInput
from fogreduce.provenance.manifest_file import MANIFEST, read_record

_FIGURES = "figures/index.json"
#: What is made of a finished reduction, the checksums first: without them nothing is archived.
_MADE_OF_IT = ("outputs.json", "index.html", "reports/overview.json")


def refuse_another_run(folder: Path, manifest: Mapping[str, Any]) -> None:
    """BadInput where a folder holds the results of another run than the manifest's."""
    there, here = _run_of(_read(folder / MANIFEST)), _run_of(manifest)
    if there is not None and there != here:
        expected = f"an empty folder, or results of {here}"
        raise BadInput.at(folder, "", found=f"results of {there}", expected=expected)


def remove_outdated(folder: Path, version_id: str) -> None:
    """Remove what is made of a finished reduction, unless the folder's manifest is of this version."""
    if _read(folder / MANIFEST).get("version_id") == version_id:
        return
    for name in _MADE_OF_IT:
        (folder / name).unlink(missing_ok=True)
    names = _read(folder / _FIGURES).get("figures")
    for name in names if isinstance(names, list) else ():
        if isinstance(name, str) and Path(name).name == name:
            (folder / "figures" / name).unlink(missing_ok=True)
    (folder / _FIGURES).unlink(missing_ok=True)
    figures = folder / "figures"
    if figures.is_dir() and not any(figures.iterdir()):
        figures.rmdir()


def _run_of(manifest: Mapping[str, Any]) -> str | None:
    campaign, run_id = manifest.get("campaign"), manifest.get("run_id")
    return f"{campaign}/{run_id}" if isinstance(campaign, str) and isinstance(run_id, str) else None


def _read(path: Path) -> dict[str, Any]:
    """A JSON object; an empty one where there is none, or none that can be read."""
    try:
        return read_record(path, "a JSON object")
    except BadInput:
        return {}
