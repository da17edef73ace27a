"""Figures as files: whole or not at all, and the same bytes from the same data."""

from __future__ import annotations

import gc
import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from fogreduce.datasets.atomic import whole_file, write_text
from fogreduce.figures import FORMATS
from fogreduce.figures.catalogue import Plan
from fogreduce.plotting.style import Identity, style
from fogreduce.progress import Progress, silent

INDEX = "index.json"

_NO_METADATA: dict[str, dict[str, None]] = {
    "png": {"Software": None},
    "svg": {"Creator": None, "Date": None, "Format": None, "Type": None},
}


def save(figure: Figure, path: Path, file_format: str) -> None:
    """Write a figure; neither date nor software stands in the file."""
    metadata = _NO_METADATA[file_format]
    with whole_file(path) as temporary:
        if file_format == "png":
            canvas: Any = FigureCanvasAgg(figure)
            canvas.print_png(temporary, metadata=metadata, pil_kwargs={"compress_level": 3})
        else:
            canvas = FigureCanvasSVG(figure)
            canvas.print_svg(temporary, metadata=metadata)


def save_all(
    plan: Plan,
    identity: Identity,
    folder: Path,
    formats: Sequence[str],
    progress: Progress = silent,
) -> list[Path]:
    """Draw and write every figure of a plan, and `index.json`, which says what there is and what is not.

    Figures that an earlier call left in the folder and this one does not draw are removed.
    """
    before = _listed(folder)
    written: list[Path] = []
    with style(), _no_collector():
        for done, (stem, draw) in enumerate(plan.drawn.items(), start=1):
            figure = draw()
            for file_format in formats:
                written.append(folder / f"{stem}.{file_format}")
                save(figure, written[-1], file_format)
            progress(done)
    names = [path.name for path in written]
    for name in before - set(names):
        (folder / name).unlink(missing_ok=True)
    index = {"version_id": identity.version_id, "figures": names, "left_out": plan.left_out}
    write_text(folder / INDEX, json.dumps(index, indent=1) + "\n")
    return written


@contextmanager
def _no_collector() -> Iterator[None]:
    """Without the garbage collector, which takes a fifth of the time: a run's figures are few."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def _listed(folder: Path) -> set[str]:
    """Plain names of figures that an index in the folder lists."""
    try:
        names = json.loads((folder / INDEX).read_text(encoding="utf-8"))["figures"]
    except (OSError, ValueError, KeyError, TypeError):
        return set()
    return {name for name in names if Path(name).name == name and name.endswith(FORMATS)}
