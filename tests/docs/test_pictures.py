"""The pictures of the documentation say what they are to show."""

from __future__ import annotations

import frames
import gyro_axes
import numpy as np
import yaml


def test_pictures_of_the_docs(repository):
    record = yaml.safe_load((repository / "calibrations" / "TETRA-01" / "2012a.yaml").read_text())
    projection = np.array(record["H"], float)
    said = {text.get_text() for axes in gyro_axes.draw(projection, "TETRA-01").axes for text in axes.texts}
    # cos of the angle from x is the first column of the pseudo-inverse: 54.74 deg but for half a degree
    angles_deg = np.degrees(np.arccos(np.linalg.pinv(projection)[:, 0]))
    assert {f"gyro{k + 1}: {angle:.2f} deg" for k, angle in enumerate(angles_deg)} <= said
    names = {text.get_text() for axes in frames.draw().axes for text in axes.texts}
    assert {"east", "north", "up", "x", "y", "z", "alpha", "latitude"} <= names
