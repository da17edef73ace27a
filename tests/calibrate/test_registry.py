"""Records seen together: succession, faults, and how much a coefficient changed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import yaml

from fogreduce.calibrate.coefficients import Coefficients, changes
from fogreduce.calibrate.registry import faults_between, history, read_registry, superseded_by


def record(bench: Any, version: str, **changed: Any) -> None:
    """A record like the bench's first, under a version of its own."""
    data = yaml.safe_load((bench.calibrations / "UNIT" / "a.yaml").read_text())
    data |= {"version": version, "valid_from": "2012-01-01T00:00:00Z", **changed}
    (bench.calibrations / "UNIT" / f"{version}.yaml").write_text(yaml.safe_dump(data))


def test_history_goes_back_along_what_each_record_supersedes(bench) -> None:
    record(bench, "b", supersedes="UNIT@a")
    record(bench, "c", supersedes="UNIT@b", valid_from="2013-01-01T00:00:00Z")
    entries, faults = read_registry(bench.calibrations)
    assert not faults
    assert [entry.record_id for entry in history(entries, "UNIT@c")] == ["UNIT@c", "UNIT@b", "UNIT@a"]
    assert superseded_by(entries, "UNIT@a") == ["UNIT@b"]
    assert faults_between(entries) == []


def test_each_change_is_in_the_unit_of_its_name(bench) -> None:
    """1 % of scale factor of gyro 1, 10 microvolts of bias of gyro 2, gyro 3's axis turned by 1 mrad."""
    first = yaml.safe_load((bench.calibrations / "UNIT" / "a.yaml").read_text())
    axes = np.linalg.pinv(np.array(first["H"]))
    axis = axes[2] / np.linalg.norm(axes[2])
    sideways = np.cross(axis, [0.0, 0.0, 1.0])
    axes[2] = np.linalg.norm(axes[2]) * (axis + 1e-3 * sideways / np.linalg.norm(sideways))
    scale = list(first["scale_factor_V_per_deg_s"])
    scale[0] *= 1.01
    bias = list(first["bias_V"])
    bias[1] += 1e-5
    record(bench, "b", H=np.linalg.pinv(axes).tolist(), scale_factor_V_per_deg_s=scale, bias_V=bias)
    entries, _ = read_registry(bench.calibrations)
    one, other = (Coefficients.of(entry.record) for entry in entries)
    found = {(change.gyro, change.name): change for change in changes(one, other)}
    assert found[0, "scale factor"].value == pytest.approx(1e4, rel=1e-3)
    assert found[0, "scale factor"].std == pytest.approx(200 * np.sqrt(2))
    assert found[1, "bias"].value == pytest.approx(1e-5 / 0.09 * 3600, rel=2e-3)
    tipped = np.hypot(found[2, "axis, first"].value, found[2, "axis, second"].value)
    assert tipped == pytest.approx(1.0, rel=1e-3)
    assert found[3, "scale factor"].value == pytest.approx(0.0, abs=1e-3)


COVARIANCE = {
    "parameters": ["gyro1.scale_factor_rel", "gyro2.scale_factor_rel"],
    "axis_directions": [[1.0, 0.0, 0.0] for _ in range(8)],
}


@pytest.mark.parametrize(
    ("changed", "expected"),
    [
        ({"supersedes": "UNIT@z"}, "supersedes: found UNIT@z, which is not there"),
        ({"supersedes": "OTHER@a"}, "expected a record of UNIT"),
        ({"supersedes": "UNIT@a", "valid_from": "2009-01-01T00:00:00Z"}, "valid_from: found 2009-01-01"),
        ({"supersedes": "UNIT@b"}, "supersedes: found a ring"),
        ({"covariance": {**COVARIANCE, "matrix": [[4e-8, 5e-8], [5e-8, 4e-8]]}}, "negative eigenvalue"),
        ({"covariance": {**COVARIANCE, "matrix": [[4e-8, 1e-8], [0.0, 4e-8]]}}, "not symmetric"),
        (
            {"covariance": {**COVARIANCE, "matrix": [[1e-8, 0.0], [0.0, 4e-8]]}},
            "scale_factor_rel[0]: found 0.0002; expected 0.0001, as the covariance has it",
        ),
    ],
)
def test_a_fault_names_file_key_and_reason(bench, changed, expected) -> None:
    record(bench, "b", **changed)
    entries, unread = read_registry(bench.calibrations)
    assert not unread, unread
    faults = [str(fault) for fault in faults_between(entries)]
    assert len(faults) == 1
    assert expected in faults[0]
    assert "UNIT/b.yaml" in faults[0]
