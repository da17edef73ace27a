"""Makes the pictures of docs/ again: `python docs/make/pictures.py` from the repository's root.

`published-drift.png` needs a reduced published run; its results folder is given as the first argument.
"""

from __future__ import annotations

import sys
from pathlib import Path

import frames
import gyro_axes
import numpy as np
import published_drift

from fogreduce.figures.results import Results
from fogreduce.figures.save import save
from fogreduce.metadata.folder import load_calibration
from fogreduce.plotting.style import style

ROOT = Path(__file__).parents[2]
PICTURES = ROOT / "docs" / "figures"
CALIBRATION = "TETRA-01@2012a"


def main(arguments: list[str]) -> None:
    """Draw and save."""
    record, _ = load_calibration(ROOT / "calibrations", CALIBRATION)
    with style():
        save(frames.draw(), PICTURES / "frames.png", "png")
        save(gyro_axes.draw(np.array(record.H), CALIBRATION), PICTURES / "gyro-axes.png", "png")
        if arguments:
            figure = published_drift.draw(Results.read(Path(arguments[0])))
            save(figure, PICTURES / "published-drift.png", "png")


if __name__ == "__main__":
    main(sys.argv[1:])
