"""A diagnosis does not depend on the unit in which gyros are read.

The same unit read in volts and in another raw unit, a power of two times as large: every double is then
scaled exactly, so that the two diagnoses are equal to the last bit, but for sizes in the raw unit.
"""

from __future__ import annotations

import re
from pathlib import Path

from bench_lab import RECORD, diagnosed, lab, simulated

from fogreduce.cli.main import main
from fogreduce.metadata.yaml12 import dump_yaml, load_yaml

FACTOR = 2.0**-6  # rad/s per V
RATE_HZ = 64.0


def read_in_radians(root: Path) -> None:
    """The laboratory's unit, its gyros giving angle increments in rad."""
    lab(root, rate_hz=RATE_HZ)
    record = {**RECORD, "uncertainty": {**RECORD["uncertainty"]}}
    for of, key, new in (
        (record, "scale_factor_V_per_deg_s", "scale_factor_rad_s_per_deg_s"),
        (record, "bias_V", "bias_rad_s"),
        (record["uncertainty"], "bias_V", "bias_rad_s"),
    ):
        of[new] = [value * FACTOR for value in of.pop(key)]
    (root / "cal" / "U" / "1.yaml").write_text(dump_yaml(record))
    for path in sorted((root / "plan" / "runs").glob("*/run.yaml")):
        run = load_yaml(path)
        step = run["capture"].pop("volts_per_count")
        run["capture"] |= {"raw_unit": "rad", "least_count": step * FACTOR / RATE_HZ}
        path.write_text(dump_yaml(run))


def clipped(root: Path, at: float) -> dict:
    entry = {"effect": "saturation", "channels": ["gyro3"], "runs": ["*"], "parameters": {"volts": at}}
    return diagnosed(root, simulated(root, [entry]))


def test_clipping_of_increments_is_that_of_volts(tmp_path: Path) -> None:
    read_in_radians(tmp_path / "rad")
    lab(tmp_path / "volts", rate_hz=RATE_HZ)
    ours, theirs = clipped(tmp_path / "rad", 0.1 * FACTOR), clipped(tmp_path / "volts", 0.1)
    assert (ours.pop("raw_unit"), theirs.pop("raw_unit")) == ("rad/s", "V")
    assert [cause["effect"] for cause in ours["causes"]] == ["saturation"]
    stated = ours["causes"][0]["parameters"]["volts"]
    for key in ("value", "std"):
        stated[key] /= FACTOR
    assert ours == theirs
    page = (tmp_path / "rad" / "out-bench" / "index.html").read_text()
    assert re.search(r"0\.001562 ± \S+ rad/s", page)  # 0.1 V / 2^6, known to 3 %


def test_the_smallest_error_of_a_converter_is_in_the_raw_unit(tmp_path: Path) -> None:
    read_in_radians(tmp_path)
    arguments = ["diagnose", str(tmp_path / "plan"), "--calibrations", str(tmp_path / "cal"), "--detectable"]
    arguments += ["--only-runs", "r0"]
    assert main([*arguments, "--out", str(tmp_path / "out")]) == 0
    rows = (tmp_path / "out" / "detectable.csv").read_text().splitlines()
    units = {row.split(",")[4] for row in rows if row.startswith(("adc_nonlinearity", "saturation"))}
    assert units == {"rad/s"}
