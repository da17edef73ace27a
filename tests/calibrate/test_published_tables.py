"""The published Tables 1 to 3 (H, C, B of the unit): a campaign simulated from them gives them back."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
import yaml

from fogreduce.calibrate.coefficients import Coefficients
from fogreduce.calibrate.derive import derive
from fogreduce.cli.main import main
from fogreduce.metadata.folder import load_calibration
from fogreduce.physics.frames import rotation
from fogreduce.physics.redundancy import projection


@pytest.fixture(scope="module")
def campaign(repository: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The bundled runs about three axes at 32 Hz, with noise, simulated from the published record."""
    folder = tmp_path_factory.mktemp("tables")
    for run in (repository / "campaigns" / "three-axes" / "runs").iterdir():
        text = (run / "run.yaml").read_text().replace("sample_rate_hz: 128", "sample_rate_hz: 32")
        text = re.sub(r"^temperature.*\n", "", text, flags=re.MULTILINE)
        (folder / "plan" / "runs" / run.name).mkdir(parents=True)
        (folder / "plan" / "runs" / run.name / "run.yaml").write_text(text)
    words = ["simulate", str(folder / "plan"), "--calibrations", str(repository / "calibrations")]
    assert main([*words, "--out", str(folder / "made"), "--seed", "3"]) == 0
    return folder / "made"


def test_a_derivation_from_a_wrong_record_gives_back_the_published_one(
    campaign: Path, repository: Path, tmp_path: Path
) -> None:
    """The record that it starts from: scale factors 0.2 % off, biases 20 deg/h, axes turned by 3 mrad."""
    shutil.copytree(repository / "calibrations", tmp_path / "calibrations")
    path = tmp_path / "calibrations" / "TETRA-01" / "2012a.yaml"
    wrong = yaml.safe_load(path.read_text())
    turned = np.array(wrong["H"]).T @ rotation(np.array([0.6, 0.0, 0.8]), 3e-3)
    wrong["H"] = turned.T.tolist()
    wrong["scale_factor_V_per_deg_s"] = [1.002 * c for c in wrong["scale_factor_V_per_deg_s"]]
    wrong["bias_V"] = [b + 20 / 3600 * 0.08 for b in wrong["bias_V"]]
    path.write_text(yaml.safe_dump(wrong))
    found = derive(campaign, tmp_path / "calibrations")
    assert not found.undetermined
    published, _ = load_calibration(repository / "calibrations", "TETRA-01@2012a")
    truth, parameters = Coefficients.of(published), found.parameters
    errors = parameters.standard_errors
    scale = found.readings[0].facts.scale_factor * parameters.scale_ratio
    tipped = np.einsum("nij,nj->ni", parameters.across, parameters.axes - truth.axes)
    pulls = np.column_stack(
        (
            (parameters.bias_deg_h - truth.bias_deg_h) / errors[:, 0],
            (scale / truth.scale_factor - 1) / errors[:, 1],
            tipped / errors[:, 2:],
        )
    )
    # Sixteen values, the table rate in common to the scale factors: 3.5 in one of 130 good campaigns.
    assert np.abs(pulls).max() < 3.5
    assert errors[:, 1].max() < 2e-5
    assert errors[:, 2:].max() < 1e-5
    assert errors[:, 0].max() < 0.1
    # H, by the axes' lengths as the record has them, to what its elements are then uncertain by.
    lengths = np.linalg.norm(np.linalg.pinv(np.array(published.H)), axis=1)
    assert projection(parameters.axes * lengths[:, None]) == pytest.approx(np.array(published.H), abs=5e-5)
