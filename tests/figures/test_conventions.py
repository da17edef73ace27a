"""The numbers of docs/conventions.md are those of the physics."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml

from fogreduce.constants import SECONDS_PER_HOUR
from fogreduce.physics.alignment import gyro_axes
from fogreduce.physics.earth_rate import EarthPart
from fogreduce.physics.frames import AXES, unit_from_enu

ROOT = Path(__file__).parents[2]


def table(first_column: str) -> list[dict[str, str]]:
    """The page's table whose first column has this name."""
    lines = (ROOT / "docs" / "conventions.md").read_text(encoding="utf-8").splitlines()
    (start,) = [k for k, line in enumerate(lines) if line.startswith(f"| {first_column} |")]
    names, rows = [cell.strip() for cell in lines[start].strip("|").split("|")], []
    for line in lines[start + 2 :]:
        if not line.startswith("|"):
            break
        rows.append(dict(zip(names, (cell.strip() for cell in line.strip("|").split("|")), strict=True)))
    return rows


@pytest.mark.parametrize("row", table("latitude_deg"), ids=lambda row: row["why"])
def test_hand_cases(row):
    orientation = dict(part.split() for part in row["orientation"].split(", "))
    earth = EarthPart.of(
        np.eye(3)[AXES.index(row["axis"])],
        unit_from_enu(orientation, float(row["azimuth_deg"])),
        float(row["latitude_deg"]),
        np.array(row["frame_signs"].split(), float),
    )
    found = SECONDS_PER_HOUR * earth.at(np.radians([float(row["alpha_deg"])]))[:, 0]
    np.testing.assert_allclose(found, [float(row[axis]) for axis in AXES], atol=5.1e-4)  # three decimals


def test_gyro_axes():
    record = yaml.safe_load((ROOT / "calibrations" / "TETRA-01" / "2012a.yaml").read_text())
    axes = gyro_axes(np.array(record["H"], float))
    rows = table("gyro")
    assert len(rows) == len(axes)
    for row, (x, y, z) in zip(rows, axes, strict=True):
        angle, around = list(row.values())[1:]
        assert np.degrees(np.arctan2(np.hypot(y, z), x)) == pytest.approx(float(angle), abs=6e-4)
        if around != "—":
            assert np.degrees(np.arctan2(z, y)) == pytest.approx(float(around), abs=6e-4)


def test_pictures_are_there():
    text = (ROOT / "docs" / "conventions.md").read_text(encoding="utf-8")
    for name in ("frames.png", "gyro-axes.png"):
        assert f"figures/{name}" in text
        assert (ROOT / "docs" / "figures" / name).is_file()
