"""A small, faultless campaign on disk, written as a laboratory would write it."""

from pathlib import Path

import pytest

RUN = """\
schema: fogreduce/run/1
run_id: r1
unit: TETRA-01
started_at: 2014-05-12T13:00:00Z
site: {latitude_deg: -23.21132308}
table:
  axis: x
  profile:
    - {rate_deg_s: 0.06, duration_s: 6000}
orientation: {x: up, z: north}
frame_signs: [1, 1, 1]
capture:
  file: capture.fogcap
  format: fogcap-1
  sample_rate_hz: 128
  volts_per_count: 1e-07
  polarity: [1, -1, 1, 1]
calibration: TETRA-01@2012a
temperature: temperature.csv
"""

CALIBRATION = """\
schema: fogreduce/calibration/1
unit: TETRA-01
version: 2012a
valid_from: 2012-06-01T00:00:00Z
valid_until: 2015-06-01T00:00:00Z
procedure: "certificate 7"
H: [[0.29, 0.29, 0.29, 0.5], [0.0, 0.71, -0.7, 0.0], [0.81, -0.41, -0.41, 0.0]]
scale_factor_V_per_deg_s: [0.075, 0.09, 0.092, 0.075]
bias_V: [1e-4, 6e-4, 2e-4, -4e-4]
uncertainty:
  scale_factor_rel: [2e-5, 2e-5, 2e-5, 2e-5]
"""

CAMPAIGN = """\
schema: fogreduce/campaign/1
title: one run
calibration: TETRA-01@2012a
captures_from: {simulate: {seed: 3}}
label: reconstruction
"""

CURVES = """\
schema: fogreduce/curves/1
a_V: [3e-3, -3e-3]
b_V: [2e-4, 3e-4]
c_rad_s: [1e-3, 1e-3]
d_rad: [4.7, 3.6]
e_V_s: [-8e-10, 1e-8]
sigma_V: [3e-5, 2e-5]
missing_fraction: 1e-4
unstable:
  - {start_s: 5600, end_s: 5800, gyros: [1, 2], noise_factor: 2.0}
"""


class Lab:
    """The folder: ``calibrations/TETRA-01/2012a.yaml`` and ``c1`` with the run ``r1``."""

    def __init__(self, root: Path) -> None:
        self.calibrations = root / "calibrations"
        self.campaign = root / "c1"
        self.run = self.campaign / "runs" / "r1"
        self.files = {
            "run": self.run / "run.yaml",
            "calibration": self.calibrations / "TETRA-01" / "2012a.yaml",
            "campaign": self.campaign / "campaign.yaml",
            "curves": self.campaign / "curves.yaml",
        }
        texts = {"run": RUN, "calibration": CALIBRATION, "campaign": CAMPAIGN, "curves": CURVES}
        for kind, text in texts.items():
            self.files[kind].parent.mkdir(parents=True, exist_ok=True)
            self.files[kind].write_text(text)
        (self.run / "capture.fogcap").write_bytes(b"")
        (self.run / "temperature.csv").write_text("time_s,electronics_degC,sensor_degC\n0,20,20\n")

    def edit(self, kind: str, old: str, new: str) -> None:
        """Replace a piece of one of the files, which must be there exactly once."""
        text = self.files[kind].read_text()
        assert text.count(old) == 1, old
        self.files[kind].write_text(text.replace(old, new))


@pytest.fixture
def lab(tmp_path: Path) -> Lab:
    return Lab(tmp_path)
